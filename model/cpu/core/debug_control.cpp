#include "model/cpu/core/debug_control.h"

#include <algorithm>
#include <bit>

namespace fovea::cpu {
namespace {

bool holds(unsigned cond, std::uint32_t cpsr) {
  const bool n = cpsr >> 31 & 1u, z = cpsr >> 30 & 1u, c = cpsr >> 29 & 1u, v = cpsr >> 28 & 1u;
  switch (cond >> 1) {
    case 0: return z != (cond & 1u);
    case 1: return c != (cond & 1u);
    case 2: return n != (cond & 1u);
    case 3: return v != (cond & 1u);
    case 4: return (c && !z) != (cond & 1u);
    case 5: return (n == v) != (cond & 1u);
    case 6: return (!z && n == v) != (cond & 1u);
    default: return !(cond & 1u);
  }
}

/// What an instruction is about to touch.
struct Touch {
  std::uint32_t va = 0, bytes = 0;
  bool reads = false, writes = false;
};

}  // namespace

/// The flags are kept outside the CPSR while the core runs; debuggers expect them in it.
void Core::control_boundary() {
  pack_flags();
  debugger_->boundary();
  unpack_flags();
}

void CoreControl::update() {
  const bool active = halt_ || step_ || follow_ || stop_after_ != kNever || !breakpoints_.empty() ||
                      !watches_.empty();
  core_.debugger_ = active ? this : nullptr;
  if (active) core_.attention_ = true;  // end a chain that is under way
}

void CoreControl::set_watch(std::uint32_t va, std::uint32_t bytes, Watch kind) {
  // Setting a watchpoint twice has no effect, as the protocol of GDB requires.
  if (std::any_of(watches_.begin(), watches_.end(), [&](const Range& r) {
        return r.va == va && r.bytes == bytes && r.kind == kind;
      }))
    return;
  watches_.push_back({va, bytes, kind});
  update();
}

void CoreControl::clear_watch(std::uint32_t va, std::uint32_t bytes, Watch kind) {
  const auto found = std::find(watches_.begin(), watches_.end(), Range{va, bytes, kind});
  if (found != watches_.end()) watches_.erase(found);
  update();
}

void CoreControl::step(std::uint32_t from, std::uint32_t to) {
  step_ = true;
  step_from_ = from;
  step_to_ = to;
  update();
}

void CoreControl::clear() {
  breakpoints_.clear();
  watches_.clear();
  touching_.clear();
  touched_.clear();
  halt_ = step_ = follow_ = false;
  stop_after_ = kNever;
  update();
}

/// The boundary is not after the next event of any other agent, so only the core's own buffers and
/// the bus can act here.
void CoreControl::settle_bus() {
  core_.run_buffers(core_.cycle_);
  core_.port_.sleep_until(core_.time(core_.cycle_));
}

void CoreControl::disturb() {
  core_.attention_ = true;
  core_.stop_cycle_ = 0;
}

/// A debugger attributes an address to all its watchpoints that contain it.
void CoreControl::drop_ranges_with(std::uint32_t address, std::vector<Touched>& list) {
  std::erase_if(list, [&](const Touched& t) { return address - t.range.va < t.range.bytes; });
}

/// Finds out whether the ranges have been touched: an interrupt or an abort may have come instead.
void CoreControl::note_touched() {
  touched_.clear();
  if (core_.counts().instructions == touching_count_ + 1) touched_.swap(touching_);
  touching_.clear();
}

void CoreControl::boundary() {
  if (follow_) settle_bus();
  note_touched();
  std::optional<Stop> stop = find_stop(core_.pc_);
  while (stop) {
    const std::uint32_t pc = core_.pc_;
    halt_ = step_ = false;
    if (stop->reason == Stop::Reason::kTime) stop_after_ = kNever;
    update();
    if (on_stop) on_stop(*stop);
    stop = find_next_stop(*stop, pc);
  }
}

std::optional<CoreControl::Stop> CoreControl::find_stop(std::uint32_t pc) {
  if (breakpoints_.contains(pc)) return Stop{Stop::Reason::kBreakpoint};
  if (step_ && (pc < step_from_ || pc >= step_to_)) return Stop{Stop::Reason::kStep};
  if (halt_) return Stop{Stop::Reason::kRequest};
  if (stop_after_ != kNever && core_.time(core_.cycle_) > stop_after_)
    return Stop{Stop::Reason::kTime};
  return report_touched(pc);
}

/// Called before the core continues: what else has to be reported at this boundary. `pc` is where
/// the core stopped.
std::optional<CoreControl::Stop> CoreControl::find_next_stop(const Stop& last, std::uint32_t pc) {
  if (core_.stop_requested_) return std::nullopt;
  if (last.past && step_) return Stop{Stop::Reason::kStep};
  while (!touched_.empty()) {
    const Touched t = touched_.front();
    touched_.erase(touched_.begin());
    if (std::find(watches_.begin(), watches_.end(), t.range) == watches_.end()) continue;
    drop_ranges_with(t.address, touched_);
    return Stop{Stop::Reason::kWatch, t.range.kind, t.address, true};
  }
  if (stop_after_ != kNever && core_.time(core_.cycle_) > stop_after_)
    return Stop{Stop::Reason::kTime};
  const bool reported = last.reason == Stop::Reason::kWatch && !last.past && core_.pc_ == pc;
  if (reported) return std::nullopt;
  touching_.clear();
  return report_touched(core_.pc_);
}

std::optional<CoreControl::Stop> CoreControl::report_touched(std::uint32_t pc) {
  if (watches_.empty()) return std::nullopt;
  touching_ = watched(pc);
  touching_count_ = core_.counts().instructions;
  if (touching_.empty()) return std::nullopt;
  const Touched first = touching_.front();
  drop_ranges_with(first.address, touching_);
  return Stop{Stop::Reason::kWatch, first.range.kind, first.address};
}

/// A watchpoint stops before the access, like the core's own breakpoint unit.
std::vector<CoreControl::Touched> CoreControl::watched(std::uint32_t pc) const {
  std::vector<Touched> out;
  const auto decoded = debug_.instruction(pc);
  if (!decoded || decoded->op < Op::kLdr || decoded->op > Op::kSwpb) return out;
  const Instruction& i = *decoded;
  if (!holds(i.cond, core_.cpsr())) return out;
  const bool thumb = i.flags & kThumbInsn;
  const std::uint32_t seen_pc = (pc + (thumb ? 4u : 8u)) & ((i.flags & kAlignPc) ? ~3u : ~0u);
  const std::uint32_t base = i.rn == 15 ? seen_pc : core_.reg(i.rn);
  Touch t;
  switch (i.op) {
    case Op::kLdm:
    case Op::kStm: {
      t.bytes = 4 * static_cast<std::uint32_t>(std::popcount(i.imm));
      const bool pre = i.flags & kPre;
      t.va = (i.flags & kUp) ? base + (pre ? 4 : 0) : base - t.bytes + (pre ? 0 : 4);
      t.va &= ~3u;
      break;
    }
    case Op::kSwp:
    case Op::kSwpb:
      t.bytes = i.op == Op::kSwp ? 4 : 1;
      t.va = base & ~(t.bytes - 1);
      t.reads = t.writes = true;
      break;
    default: {
      const std::uint32_t by = core_.offset(i);
      t.va = !(i.flags & kPre) ? base : (i.flags & kUp) ? base + by : base - by;
      switch (i.op) {
        case Op::kLdrb: case Op::kStrb: case Op::kLdrsb: t.bytes = 1; break;
        case Op::kLdrh: case Op::kStrh: case Op::kLdrsh: t.bytes = 2; break;
        case Op::kLdrd: case Op::kStrd: t.bytes = 8; break;
        default: t.bytes = 4; break;
      }
      t.va &= ~(std::min(t.bytes, 4u) - 1);  // the low bits of an unaligned address only rotate the
                                             // value
    }
  }
  switch (i.op) {
    case Op::kStr: case Op::kStrb: case Op::kStrh: case Op::kStrd: case Op::kStm:
      t.writes = true;
      break;
    default: t.reads = true; break;
  }
  for (const Range& w : watches_) {
    if (w.kind == Watch::kWrite ? !t.writes : w.kind == Watch::kRead ? !t.reads : false) continue;
    const std::uint64_t from = std::max(t.va, w.va);
    const std::uint64_t to = std::min(std::uint64_t{t.va} + t.bytes, std::uint64_t{w.va} + w.bytes);
    if (from < to) out.push_back({w, static_cast<std::uint32_t>(from)});
  }
  return out;
}

}  // namespace fovea::cpu
