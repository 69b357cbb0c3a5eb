#include "model/cpu/core/debug_control.h"

#include <algorithm>
#include <array>

#include "model/cpu/core/addressing.h"
#include "model/cpu/core/conditions.h"

namespace fovea::cpu {

void CoreControl::update() {
  const bool active = halt_ || step_ || follow_ || stop_after_ != kNever || !breakpoints_.empty() ||
                      !watches_.empty();
  if (!active) return observing_.reset();
  if (!observing_) observing_ = core_.observe_boundaries(*this);
  core_.end_chain();
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

void CoreControl::at_boundary() {
  if (follow_) settle_bus();
  note_touched();
  std::optional<Stop> stop = find_stop(core_.reg(15));
  while (stop) {
    const std::uint32_t pc = core_.reg(15);
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
  if (stop_after_ != kNever && core_.boundary_time() > stop_after_)
    return Stop{Stop::Reason::kTime};
  return report_touched(pc);
}

/// Called before the core continues: what else has to be reported at this boundary. `pc` is where
/// the core stopped.
std::optional<CoreControl::Stop> CoreControl::find_next_stop(const Stop& last, std::uint32_t pc) {
  if (core_.stop_requested()) return std::nullopt;
  if (last.past && step_) return Stop{Stop::Reason::kStep};
  while (!touched_.empty()) {
    const Touched t = touched_.front();
    touched_.erase(touched_.begin());
    if (std::find(watches_.begin(), watches_.end(), t.range) == watches_.end()) continue;
    drop_ranges_with(t.address, touched_);
    return Stop{Stop::Reason::kWatch, t.range.kind, t.address, true};
  }
  if (stop_after_ != kNever && core_.boundary_time() > stop_after_)
    return Stop{Stop::Reason::kTime};
  const bool reported = last.reason == Stop::Reason::kWatch && !last.past && core_.reg(15) == pc;
  if (reported) return std::nullopt;
  touching_.clear();
  return report_touched(core_.reg(15));
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

/// The ranges that the next instruction will touch: a watchpoint stops before the access, like the
/// core's own breakpoint unit.
std::vector<CoreControl::Touched> CoreControl::watched(std::uint32_t pc) const {
  std::vector<Touched> out;
  const auto decoded = debug_.instruction(pc);
  if (!decoded || !accesses_data(decoded->op)) return out;
  const Instruction& i = *decoded;
  if (!condition_holds(i.cond, core_.cpsr())) return out;
  auto registers = core_.view().registers.r;
  registers[15] = pc_ahead(i, pc);
  const DataAddress a = data_address(i, registers, core_.cpsr() & kC);
  const bool writes = is_store(i.op) || is_swap(i.op), reads = !is_store(i.op);
  const std::uint64_t first = a.touched(), end = first + a.bytes;
  for (const Range& w : watches_) {
    if (w.kind == Watch::kWrite ? !writes : w.kind == Watch::kRead ? !reads : false) continue;
    const std::uint64_t from = std::max<std::uint64_t>(first, w.va);
    const std::uint64_t to = std::min(end, std::uint64_t{w.va} + w.bytes);
    if (from < to) out.push_back({w, static_cast<std::uint32_t>(from)});
  }
  return out;
}

}  // namespace fovea::cpu
