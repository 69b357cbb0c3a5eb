#include "model/cpu/core/debug.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace fovea::cpu {
namespace {

constexpr std::uint32_t kLineMask = Cache::kLineBytes - 1;

/// Calls f(va, offset, count) for each part within one cache line, until a call returns false.
template <class F>
bool by_lines(std::uint32_t va, std::size_t bytes, F f) {
  for (std::size_t done = 0; done < bytes;) {
    const std::uint32_t at = va + static_cast<std::uint32_t>(done);
    const std::size_t n = std::min<std::size_t>(bytes - done, Cache::kLineBytes - (at & kLineMask));
    if (!f(at, done, n)) return false;
    done += n;
  }
  return true;
}

}  // namespace

/// Reads memory, including the pending bytes of the write and victim buffers.
bool CoreDebug::read_memory(std::uint32_t pa, std::span<std::uint8_t> to) {
  if (!memory_.debug_read(pa, to)) return false;
  for (std::size_t k = 0; k < to.size(); ++k)
    view_.bus.writes().find(pa + static_cast<std::uint32_t>(k), to[k]);
  return true;
}

std::optional<CoreDebug::Mapping> CoreDebug::mapping(std::uint32_t mva) {
  if (!view_.system.mmu_on()) return Mapping{mva, false};
  const auto mapped = [&](const TlbEntry& e) {
    return Mapping{e.physical(mva), e.cacheable && view_.system.data_cached()};
  };
  if (const TlbEntry* e = view_.mmu.tlb().find(mva)) return mapped(*e);
  const PageWalk walk = walk_page_tables(
      view_.system.ttbr, mva, [this](std::uint32_t address, std::uint32_t& word) {
        std::array<std::uint8_t, 4> bytes;
        if (!read_memory(address, bytes)) return false;
        std::memcpy(&word, bytes.data(), 4);
        return true;
      });
  if (walk.fault != Fault::kNone) return std::nullopt;
  return mapped(walk.entry);
}

std::optional<std::uint32_t> CoreDebug::physical(std::uint32_t va) {
  const auto p = mapping(view_.system.modified(va));
  return p ? std::optional(p->pa) : std::nullopt;
}

bool CoreDebug::read(std::uint32_t va, std::span<std::uint8_t> to) {
  return by_lines(va, to.size(), [&](std::uint32_t at, std::size_t offset, std::size_t n) {
    const std::uint32_t mva = view_.system.modified(at);
    const auto piece = to.subspan(offset, n);
    const auto p = mapping(mva);
    if (!p) return false;
    if (view_.ram.contains(p->pa)) {
      std::memcpy(piece.data(), view_.ram.at(p->pa), n);
      return true;
    }
    const Cache& lines = view_.data.lines();
    if (const int i = p->cached ? lines.find(mva) : -1; i >= 0) {
      std::memcpy(piece.data(), lines.data(static_cast<unsigned>(i)) + (mva & kLineMask), n);
      return true;
    }
    return read_memory(p->pa, piece);
  });
}

bool CoreDebug::write(std::uint32_t va, std::span<const std::uint8_t> from) {
  return by_lines(va, from.size(), [&](std::uint32_t at, std::size_t offset, std::size_t n) {
    const std::uint32_t mva = view_.system.modified(at);
    const auto piece = from.subspan(offset, n);
    const auto p = mapping(mva);
    if (!p) return false;
    if (view_.ram.contains(p->pa)) {
      core_.patch_ram(p->pa, piece);
      return true;
    }
    if (!memory_.debug_write(p->pa, piece)) return false;
    core_.patch(mva, p->pa, piece);
    return true;
  });
}

bool CoreDebug::set_spsr(std::uint32_t value) {
  const unsigned bank = RegisterFile::bank(view_.registers.cpsr);
  if (bank == 0) return false;
  core_.change_spsr(bank, value);
  return true;
}

std::span<const CoreDebug::SystemRegister> CoreDebug::system_registers() {
  using R = SystemRegisters;
  static constexpr std::array<SystemRegister, 8> kRegisters = {{
      {"control", &R::control, 0x0100},
      {"ttbr", &R::ttbr, 0x0200},
      {"dacr", &R::dacr, 0x0300},
      {"dfsr", &R::dfsr, 0x0500},
      {"ifsr", &R::ifsr, 0x0501},
      {"far", &R::far, 0x0600},
      {"fcse_pid", &R::fcse_pid, 0x0D00},
      {"context_id", &R::context_id, 0x0D01},
  }};
  return kRegisters;
}

std::span<const CoreDebug::BankedRegister> CoreDebug::banked_registers() {
  static constexpr std::array<BankedRegister, 27> kRegisters = {{
      {"r8_usr", 0, 8},    {"r9_usr", 0, 9},    {"r10_usr", 0, 10},  {"r11_usr", 0, 11},
      {"r12_usr", 0, 12},  {"sp_usr", 0, 13},   {"lr_usr", 0, 14},   {"r8_fiq", 1, 8},
      {"r9_fiq", 1, 9},    {"r10_fiq", 1, 10},  {"r11_fiq", 1, 11},  {"r12_fiq", 1, 12},
      {"sp_fiq", 1, 13},   {"lr_fiq", 1, 14},   {"spsr_fiq", 1, 16}, {"sp_irq", 2, 13},
      {"lr_irq", 2, 14},   {"spsr_irq", 2, 16}, {"sp_svc", 3, 13},   {"lr_svc", 3, 14},
      {"spsr_svc", 3, 16}, {"sp_abt", 4, 13},   {"lr_abt", 4, 14},   {"spsr_abt", 4, 16},
      {"sp_und", 5, 13},   {"lr_und", 5, 14},   {"spsr_und", 5, 16},
  }};
  return kRegisters;
}

CoreDebug::Pending CoreDebug::pending() const {
  Pending p;
  const auto later = [this](std::uint64_t cycle) -> Picoseconds {
    return cycle > core_.clock_count() ? core_.time(cycle) : 0;
  };
  p.data_fill = later(view_.data.fill.last);
  p.instruction_fill = later(view_.fetch.fill.last);
  p.operands = later(view_.scoreboard.latest);
  p.data_line = view_.data.fill.line;
  p.instruction_line = view_.fetch.fill.line;
  p.writes = view_.bus.writes().count();
  p.victim_bytes = view_.bus.writes().victim_bytes;
  p.victim = view_.bus.writes().victim_address;
  p.write_on_bus = view_.bus.write_in_flight();
  p.write_address = view_.bus.write_address();
  p.irq = view_.irq.level;
  p.fiq = view_.fiq.level;
  return p;
}

std::optional<Instruction> CoreDebug::instruction(std::uint32_t va) {
  const bool thumb = core_.cpsr() & 0x20u;
  std::array<std::uint8_t, 4> bytes{};
  const auto piece = std::span(bytes).first(thumb ? 2 : 4);
  const std::uint32_t mva = view_.system.modified(va);
  const auto p = mapping(mva);
  const Cache& lines = view_.fetch.icache();
  if (const int i = p && view_.ram.contains(p->pa) ? -1 : lines.find(mva); i >= 0)
    std::memcpy(bytes.data(), lines.data(static_cast<unsigned>(i)) + (mva & kLineMask),
                piece.size());
  else if (!read(va, piece))
    return std::nullopt;
  std::uint32_t word;
  std::memcpy(&word, bytes.data(), 4);
  return thumb ? decode_thumb(static_cast<std::uint16_t>(word)) : decode_arm(word);
}

}  // namespace fovea::cpu
