#include "sw/fovea/program/exec_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "model/common/check.h"
#include "model/contract/memory_map.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

constexpr std::uint32_t kInternalBytes = INTERNAL_RAM_BYTES, kDataWindow = INTERNAL_RAM_DATA_BASE;
constexpr std::uint32_t kChipSdram = DDR_BASE;
constexpr std::uint32_t kVectorBytes = 0x20;
constexpr std::uint32_t kHeapAlignment = 64;

std::uint64_t end_of(const ElfSegment& s) { return std::uint64_t{s.address} + s.memory_size; }

bool inside(const ElfSegment& s, std::uint64_t base, std::uint64_t size) {
  return s.address >= base && end_of(s) <= base + size;
}

/// The segment at the address to which the program's start-up code moves it.
ElfSegment as_run(const ElfSegment& s) {
  return {s.index, s.virtual_address, s.virtual_address, s.memory_size, {}};
}

bool in_internal_ram(const ElfSegment& s) {
  return inside(s, 0, kInternalBytes) || inside(s, kDataWindow, kInternalBytes);
}

}  // namespace

std::uint32_t parse_address(const std::string& option, const std::string& text) {
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const char* begin = text.data() + (hex ? 2 : 0);
  const char* end = text.data() + text.size();
  std::uint32_t value = 0;
  const auto [stopped, error] = std::from_chars(begin, end, value, hex ? 16 : 10);
  if (error != std::errc() || stopped != end || begin == end)
    throw UserError(fmt::format("{} '{}' is not an address; allowed: 0 to 0xffffffff", option,
                                one_line(text)));
  return value;
}

ExecProgram ExecProgram::elf(const std::filesystem::path& file) {
  ExecProgram p;
  p.name_ = file.filename().string();
  p.image_ = ElfImage::load(file);
  p.entry_ = p.image_->entry();
  p.segments_ = p.image_->segments();
  return p;
}

ExecProgram ExecProgram::flat(const std::filesystem::path& file, std::uint32_t load,
                              std::uint32_t entry) {
  constexpr std::uintmax_t kMaxBytes = 256u << 20;
  const std::string bytes = read_file(file, kMaxBytes);
  if (bytes.empty())
    throw UserError(fmt::format("program '{}' is empty", one_line(file.string())));
  if (load + std::uint64_t{bytes.size()} > std::uint64_t{1} << 32)
    throw UserError(fmt::format("--load 0x{:08x}: {} bytes run over the end of the addresses", load,
                                bytes.size()));
  ExecProgram p;
  p.name_ = file.filename().string();
  p.entry_ = entry;
  p.segments_.push_back({0, load, load, static_cast<std::uint32_t>(bytes.size()),
                         {bytes.begin(), bytes.end()}});
  return p;
}

std::optional<std::uint32_t> parse_ram_base(const std::string& text, std::uint64_t ram_size) {
  if (text == "auto") return std::nullopt;
  constexpr std::uint32_t kStep = 1u << 20;  // the windows of internal RAM are below the first
                                             // multiple
  const std::uint64_t most = (std::uint64_t{1} << 32) - ram_size;
  std::optional<std::uint32_t> base;
  try {
    base = parse_address("exec.ram_base", text);
  } catch (const UserError&) {
  }
  if (!base || *base % kStep || *base > most)
    throw UserError(
        fmt::format("key 'exec.ram_base': '{}' is not allowed; allowed: auto, or a "
                    "multiple of 0x100000 up to 0x{:08x}",
                    one_line(text), most));
  return base;
}

/// The lowest segment outside internal RAM determines the window. If all segments are loaded there (flash at 0), it is
/// the lowest of those that the program moves out of it.
std::uint32_t ExecProgram::window_base(std::uint64_t ram_size) const {
  std::optional<std::uint32_t> lowest, moved;
  for (const auto& s : segments_) {
    if (!in_internal_ram(s)) lowest = std::min(lowest.value_or(s.address), s.address);
    if (const auto run = as_run(s); run.memory_size && !in_internal_ram(run))
      moved = std::min(moved.value_or(run.address), run.address);
  }
  if (!lowest) lowest = moved;
  return lowest ? static_cast<std::uint32_t>(*lowest / ram_size * ram_size) : kChipSdram;
}

void ExecProgram::check_inside(const ExecMap& m) const {
  for (const auto& s : segments_) {
    if (inside(s, m.ram_base, m.ram_size) || (m.tcm && in_internal_ram(s))) continue;
    throw UserError(fmt::format(
        "program '{}': segment {} (0x{:08x}, {} bytes) lies outside memory; allowed: RAM from "
        "0x{:08x} to 0x{:08x}{}; 'ddr.part' sets its size, "
        "'exec.ram_base' its place",
        one_line(name_), s.index, s.address, s.memory_size, m.ram_base, m.ram_base + (m.ram_size - 1),
        m.tcm ? ", or internal RAM at 0x0 and 0x10000" : ""));
  }
}

/// What the program's segments, and the vectors at 0, take of the window: ranges by their starts.
std::vector<std::pair<std::uint64_t, std::uint64_t>> ExecProgram::used_in(const ExecMap& m) const {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> used = {
      {m.ram_base, m.ram_base + (m.ram_base == 0 ? kVectorBytes : 0)}};
  for (const auto& s : segments_)
    for (const std::uint64_t from : {s.address, s.virtual_address})
      if (from >= m.ram_base && from + s.memory_size <= m.ram_base + m.ram_size)
        used.emplace_back(from, from + s.memory_size);
  std::sort(used.begin(), used.end());
  return used;
}

ExecMap ExecProgram::map(std::uint64_t ram_size, std::optional<std::uint32_t> ram_base,
                         bool caches) const {
  ExecMap m;
  m.ram_size = ram_size;
  m.ram_base = ram_base ? *ram_base : window_base(ram_size);
  m.tcm = m.ram_base != 0;
  check_inside(m);
  auto used = used_in(m);
  // The very last address cannot be the end of a stack.
  const std::uint64_t top =
      std::min<std::uint64_t>(m.ram_base + ram_size, (std::uint64_t{1} << 32) - kHeapAlignment);
  if (caches) {
    m.table = static_cast<std::uint32_t>(m.ram_base + ram_size - ExecMap::kTableBytes);
    for (const auto& [from, to] : used)
      if (to > m.table)
        throw UserError(
            fmt::format("--caches: program '{}' needs the last {} bytes of RAM itself; "
                        "allowed: a program that leaves them free (ddr.part sets the size)",
                        one_line(name_), ExecMap::kTableBytes));
  }
  used.emplace_back(caches ? m.table : top, top);
  // Stack and heap get the largest gap.
  std::uint64_t free_from = used.front().second, best = 0;
  for (const auto& [from, to] : used) {
    const std::uint64_t aligned =
        (free_from + kHeapAlignment - 1) / kHeapAlignment * kHeapAlignment;
    const std::uint64_t end = from / 8 * 8;
    if (end > aligned && end - aligned > best) {
      best = end - aligned;
      m.free_base = static_cast<std::uint32_t>(aligned);
      m.free_end = static_cast<std::uint32_t>(end);
    }
    free_from = std::max(free_from, to);
  }
  if (best == 0)
    throw UserError(fmt::format("program '{}' leaves no memory for a stack; 'ddr.part' sets its "
                                "size", one_line(name_)));
  return m;
}

}  // namespace fovea::app
