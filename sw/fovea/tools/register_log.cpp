#include "sw/fovea/tools/register_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <re2/re2.h>

#include <algorithm>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::app {
RegisterLog::RegisterLog(std::vector<RegisterBlock> blocks, Sources sources)
    : blocks_(std::move(blocks)), sources_(std::move(sources)) {}

RegisterLog::~RegisterLog() { stop(); }

void RegisterLog::start(const RegisterLogRequest& request) {
  FOVEA_CHECK(request.kept > 0, "a ring has room for one access at least");
  // RE2 takes time proportional to the length of the name, whatever the pattern, and refuses
  // patterns that need more than its limit of memory.
  auto pattern = std::make_unique<re2::RE2>(request.pattern, re2::RE2::Quiet);
  if (!pattern->ok())
    throw UserError(
        fmt::format("'{}' is not a regular expression ({}); it is looked for in "
                    "BLOCK.REGISTER, as in '^timer[01]\\.|PSC'",
                    one_line(request.pattern), one_line(pattern->error())));
  std::swap(pattern, pattern_);
  try {
    check_matches(request.pattern);
  } catch (const UserError&) {
    std::swap(pattern, pattern_);
    throw;
  }
  stop();
  matches_.clear();
  ring_.clear();
  kept_ = request.kept;
  oldest_ = 0;
  count_ = 0;
  for (const auto& b : blocks_)
    if (b.observe) observing_.push_back(b.observe(*this));
  running_ = true;
}

/// @throws UserError if there is nothing that the pattern could find
void RegisterLog::check_matches(const std::string& pattern) const {
  std::vector<std::string> names;
  for (const auto& b : blocks_) {
    names.push_back(b.name);
    if (re2::RE2::PartialMatch(b.name + ".", *pattern_)) return;
    for (const Reg* reg : b.registers->regs())
      if (re2::RE2::PartialMatch(b.name + "." + reg->name(), *pattern_)) return;
  }
  std::ranges::sort(names);
  throw UserError(fmt::format("'{}' matches no register; names are BLOCK.REGISTER, and the blocks are {}",
                              one_line(pattern), fmt::join(names, ", ")));
}

void RegisterLog::stop() {
  observing_.clear();
  running_ = false;
}

void RegisterLog::keep(std::size_t most) {
  std::rotate(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(oldest_), ring_.end());
  oldest_ = 0;
  if (ring_.size() > most)
    ring_.erase(ring_.begin(), ring_.end() - static_cast<std::ptrdiff_t>(most));
  kept_ = most;
}

const std::string& RegisterLog::block_name(const RegBank* bank) const {
  const auto found = std::find_if(blocks_.begin(), blocks_.end(),
                                  [&](const RegisterBlock& b) { return b.registers == bank; });
  FOVEA_CHECK(found != blocks_.end(), "an access to a block that is not observed");
  return found->name;
}

/// Offsets without a register match by the name of their block alone.
bool RegisterLog::wanted(const RegisterAccess& access) {
  const Reg* const reg = access.reg;
  if (!reg) return re2::RE2::PartialMatch(block_name(access.bank) + ".", *pattern_);
  const auto [place, fresh] = matches_.try_emplace(reg, false);
  if (fresh)
    place->second = re2::RE2::PartialMatch(block_name(access.bank) + "." + reg->name(), *pattern_);
  return place->second;
}

void RegisterLog::accessed(const RegisterAccess& access) {
  if (!wanted(access)) return;
  const Master master = sources_.master();
  const Record r{sources_.now(), is_core(master) ? sources_.pc() : 0, master, access};
  ++count_;
  if (!ring_.empty())
    if (Record& before = newest(); before.pc == r.pc && before.master == master && before.access == access) {
      ++before.times;
      before.last = r.at;
      return;
    }
  if (ring_.size() < kept_) {
    ring_.push_back(r);
  } else {
    ring_[oldest_] = r;
    oldest_ = (oldest_ + 1) % kept_;
  }
}

std::string RegisterLog::line(const Record& r) const {
  const RegisterAccess& a = r.access;
  const Reg* const reg = a.reg;
  const unsigned shift = 8 * (a.offset & 3u);
  const std::uint32_t lanes = (a.bytes == 4 ? ~0u : (1u << 8 * a.bytes) - 1u) << shift;
  const std::uint32_t word = (a.value << shift) & lanes;
  std::string out = fmt::format("{} ns  ", ns_text(r.at));
  if (is_core(r.master)) {
    out += fmt::format("pc 0x{:08x} ", r.pc);
    const std::string where = sources_.describe ? sources_.describe(r.pc) : "";
    if (!where.empty()) out += "(" + where + ") ";
  }
  out += fmt::format("{} {} {}.", kMasterNames[index(r.master)], a.write ? "wrote" : "read",
                     block_name(a.bank));
  out += reg ? reg->name() : fmt::format("0x{:x} (no register)", a.offset);
  if (a.bytes != 4)
    out += fmt::format(" byte {}{}", a.offset & 3u,
                       a.bytes == 2 ? fmt::format("-{}", (a.offset & 3u) + 1) : "");
  out += fmt::format(" = 0x{:0{}x}", a.value, 2 * a.bytes);
  if (a.gated) {
    out += "  clock gated";
  } else if (reg) {
    for (const Field* f : reg->fields())
      if (f->mask() & lanes)
        out += fmt::format(" {}={}", f->name(), (word & f->mask()) >> f->lsb());
    if (const std::uint32_t lost = word & reg->reserved(); a.write && lost)
      out += fmt::format("  reserved bits 0x{:08x}", lost);
  }
  if (r.times > 1) out += fmt::format("  {} times, the last at {} ns", r.times, ns_text(r.last));
  return out + "\n";
}

std::string RegisterLog::text(std::size_t most) const {
  const std::size_t n = std::min(most, ring_.size());
  std::string out;
  std::uint64_t shown = 0;
  for (std::size_t i = ring_.size() - n; i < ring_.size(); ++i) {
    const Record& r = ring_[(oldest_ + i) % ring_.size()];
    shown += r.times;
    out += line(r);
  }
  return count_ > shown ? fmt::format("({} earlier accesses are not shown)\n", count_ - shown) + out : out;
}

namespace {

class RegisterLogTool final : public Tool {
 public:
  explicit RegisterLogTool(const RegisterLog& log) : log_(log) {}
  void finish(const cpu::Counts&, ToolOutput& output) override {
    output.files.push_back({"registers.log", log_.text(), true});
  }

 private:
  const RegisterLog& log_;
};

/// The size holds also for a log that the debugger starts.
std::unique_ptr<Tool> start_log(const ToolValues& v, const ToolParts& parts) {
  const RegisterLogRequest request{v.text("--log-registers"),
                                   v.number("--log-registers-kept", RegisterLogRequest{}.kept)};
  parts.log->keep(request.kept);
  if (request.pattern.empty()) return nullptr;
  parts.log->start(request);
  return std::make_unique<RegisterLogTool>(*parts.log);
}

}  // namespace

ToolRow register_log_tool() {
  return {.what = "the register log",
          .needs = ToolNeeds::kRegisters,
          .lacks = "there are no registers",
          .options = {{"--log-registers", "REGEX",
                       "Log accesses to registers whose BLOCK.REGISTER matches this regular expression",
                       "a regular expression is needed; '.' takes all"},
                      {.name = "--log-registers-kept",
                       .type = "N",
                       .help = "Keep the last N accesses; also of a log that GDB begins",
                       .fallback = "4096",
                       .least = 1,
                       .most = kRegisterLogMost}},
          .make = start_log,
          .check = [](const ToolValues& v, bool debugger) {
            if (!v.given("--log-registers") && !debugger)
              throw UserError("--log-registers-kept: nothing is logged; allowed: with --log-registers or --gdb");
          }};
}

}  // namespace fovea::app
