// Execution of instructions. Cycle counts and interlocks: ARM DDI 0222B chapter 8.
#include "model/cpu/core/conditions.h"
#include "model/cpu/core/handlers.h"

namespace fovea::cpu {

void Core::run() {
  regs_.unpack_flags();
  struct Live {
    RegisterFile& registers;
    explicit Live(RegisterFile& r) : registers(r) { registers.flags_live = true; }
    ~Live() {
      registers.pack_flags();
      registers.flags_live = false;
    }
  } live(regs_);
  std::uint32_t inspected_pc = 1;  // pc of a boundary that observers have already inspected
  for (;;) {
    if (ledger_.cycle >= interface_.stop_cycle || interface_.attention) {
      if (stop_requested_) return;
      regs_.pack_flags();
      step_attention();
      if (held_) return;
      if (stop_requested_) interface_.stop_cycle = 0;  // execute one more instruction
    }
    if (!boundary_observers_.empty() && regs_.pc != inspected_pc) [[unlikely]] {
      regs_.pack_flags();  // observers expect the flags in the CPSR
      boundary_observers_.each([](BoundaryObserver* o) { o->at_boundary(); });
      regs_.unpack_flags();
      if (stop_requested_) return;
    }
    inspected_pc = 1;
    const Instruction* i = fetch();
    if (!i) {
      enter_exception();
      continue;
    }
    if (fetch_.used_bus) {  // an interrupt that arrived meanwhile is taken first
      fetch_.used_bus = false;
      if ((ledger_.cycle >= interface_.stop_cycle || interface_.attention) && !stop_requested_) {
        inspected_pc = regs_.pc;
        continue;
      }
    }
    chain_.va = regs_.pc & ~31u;
    chain_.first = reinterpret_cast<std::intptr_t>(i);
    const bool chain = fetch_.line_va == chain_.va && ledger_.cycle >= scoreboard_.latest &&
                       ledger_.cycle >= fetch_.fill.last && failure_.exceptions == 0 &&
                       !fetch_.lagging() && boundary_observers_.empty();
    if (chain) {
      chain_.stop = interface_.stop_cycle;
      if (profile_) [[unlikely]] start_counted(i);
      i = i->handler(*this, i, ledger_.cycle);
      while (i) i = i->handler(*this, i, chain_.cycle);
    } else {
      count_alone(*i, [&] { execute_alone(*i); });
    }
    if (fetch_.lagging()) [[unlikely]] end_old_fetch();
  }
}

/// Completes an exception that was not raised by an instruction.
void Core::enter_exception() {
  regs_.pc = next_pc_;
  if (ledger_.profile) ledger_.profile->end(regs_.pc);
  branched_ = aborted_ = false;
  if (fetch_.lagging()) end_old_fetch();
}

/// Called after an instruction while fetches still use older settings.
void Core::end_old_fetch() {
  if (fetch_.instruction_done(regs_.pc, regs_.thumb())) forget_translations();
}

/// For a profile: a chain begins with record i.
void Core::start_counted(const Instruction* i) {
  // The tallies must be collected before they overflow.
  constexpr std::uint64_t kLongest = std::uint64_t{1} << 30;
  if (ledger_.cycle - collected_ >= kLongest) {
    collected_ = ledger_.cycle;
    fetch_.collect_tallies();
  }
  chain_.stop = std::min(chain_.stop, ledger_.cycle + kLongest);
  starts_at(i);
}

/// For a profile: execute_one() in a chain, where the flow ends in front of the record.
void Core::execute_one_counted(const Instruction& i) {
  ends_before(&i);
  const std::uint32_t pc = regs_.pc;
  profile_->begin();
  execute_one(i);
  profile_->end(pc);
}

ClockProfile& Core::start_profile() {
  own_profile_ = std::make_unique<ClockProfile>(regs_.pc, ledger_.counts);
  profile_ = ledger_.profile = own_profile_.get();
  fetch_.keep_tallies(*profile_);
  if (ledger_.cycle) profile_->stacks.start(ledger_.cycle, regs_.pc);
  return *profile_;
}

void Core::finish_profile(const Counts& end) {
  ClockProfile& p = *own_profile_;
  // In the midst of a chain, in a store that waits for room in the write buffer.
  if (bus_.waits_for_room())
    if (const Instruction* const i = log_.last_record()) ends_before(i);
  const std::uint64_t asleep =
      end.idle > ledger_.counts.idle ? end.idle - ledger_.counts.idle : 0;
  if (asleep)
    p.sleep_out(ledger_.cycle, ledger_.cycle + asleep,
                [this](Picoseconds t) { return interface_.clock.edge_after(t); });
  enter_section(p.section());
  p.stacks.count(ledger_.cycle + asleep, false);
  p.mask.count(false, awake(), regs_.pc);
}

void Core::follow_call(const Instruction* i, std::uint64_t cycle, std::uint32_t target) {
  ledger_.profile->stacks.call(cycle, chain_.va + i->at, target & ~1u, regs_.r[14] & ~1u,
                               regs_.r[13]);
}
/// `mov lr, pc` before a branch makes a call of it.
void Core::follow_jump(const Instruction* i, std::uint64_t cycle, std::uint32_t target) {
  const std::uint32_t next = chain_.va + i->at + ((i->flags & kThumbInsn) ? 2u : 4u);
  if ((regs_.r[14] & ~1u) == next) return follow_call(i, cycle, target);
  ledger_.profile->stacks.jump(cycle, target & ~1u, regs_.r[13]);
}
void Core::follow_tail_call(std::uint64_t cycle, std::uint32_t target) {
  ledger_.profile->stacks.tail_call(cycle, target);
}
void Core::follow_pop(const Instruction* i, std::uint64_t cycle, std::uint32_t target,
                      std::uint32_t base) {
  ledger_.profile->stacks.jump(cycle, target & ~1u, regs_.r[13]);
  if (i->rn == 13) ledger_.profile->stacks.reached(base);
}
/// A branch of an instruction that is executed on its own.
void Core::follow_branch(std::uint32_t target) {
  CallStacks& stacks = ledger_.profile->stacks;
  const std::uint32_t next = regs_.pc + (regs_.thumb() ? 2u : 4u);
  if (std::exchange(exception_return_, false))
    stacks.exception_return(ledger_.cycle, target, regs_.r[13]);
  else if ((regs_.r[14] & ~1u) == next || (regs_.r[14] & ~1u) == regs_.pc + 4)
    stacks.call(ledger_.cycle, regs_.pc, target, regs_.r[14] & ~1u, regs_.r[13]);
  else
    stacks.jump(ledger_.cycle, target & ~1u, regs_.r[13]);
}

void Core::take_marks(Picoseconds boundary) {
  while (window_.due(boundary)) window_.take(ledger_.counts, ledger_.cycle);
  while (ledger_.profile && ledger_.profile->due(boundary))
    if (const auto section = ledger_.profile->take_mark()) enter_section(*section);
}

/// The tallies that are counted up to here belong to the section that ends.
void Core::enter_section(std::size_t section) {
  const bool within = ledger_.profile->open();  // a sleep is divided within its instruction
  ledger_.profile->end(regs_.pc);
  fetch_.collect_tallies();
  collected_ = ledger_.cycle;
  const bool counted = ledger_.profile->counts_stacks();
  ledger_.profile->enter(section);
  const bool counts = ledger_.profile->counts_stacks();
  ledger_.profile->stacks.enter(ledger_.cycle, counts, section);
  // A stretch may begin in one of the sections that count and end in the next.
  if (counts != counted) ledger_.profile->mask.count(counts, awake(), regs_.pc);
  if (within) ledger_.profile->begin();
}

/// An instruction whose beginning or end may depend on earlier instructions.
void Core::execute_alone(const Instruction& i) {
  if (i.cond != kAlways && !condition_holds(i.cond, regs_.packed())) {
    spend(1);
    ++ledger_.counts.instructions;
    regs_.pc += (i.flags & kThumbInsn) ? 2u : 4u;
    return;
  }
  if (ledger_.cycle < scoreboard_.latest)
    ledger_.stall_to(scoreboard_.operands_ready(i, ledger_.cycle), Cause::kInterlock);
  set_pc_ahead(i);
  chain_.stop = 0;
  const std::uint64_t exceptions = ledger_.counts.exceptions;
  i.body(*this, &i, ledger_.cycle);
  if (ledger_.counts.exceptions == exceptions) failure_.exceptions = 0;
  if (branched_) {
    branched_ = false;
    fetch_.branched = true;
  }
}

/// An instruction without a fast handler, or whose access is not a plain hit. State is settled.
void Core::execute_one(const Instruction& i) {
  next_pc_ = regs_.pc + ((i.flags & kThumbInsn) ? 2u : 4u);
  set_pc_ahead(i);
  regs_.pack_flags();
  execute(i);
  regs_.unpack_flags();
  if (aborted_) {
    aborted_ = false;
  } else {
    ++ledger_.counts.instructions;
    failure_.exceptions = 0;
  }
  if (branched_) {
    branched_ = false;
    fetch_.branched = true;
  }
  regs_.pc = next_pc_;
}

/// Takes an interrupt that is visible at the time of a boundary and not masked.
/// @return true: the core is at its vector now, which is another boundary
bool Core::take_interrupt(Picoseconds at) {
  const bool fiq = !(regs_.cpsr & kFiqMask) && fiq_.at(at);
  if (!fiq && !(!(regs_.cpsr & kIrqMask) && irq_.at(at))) return false;
  take(fiq ? Exception::kFiq : Exception::kIrq, regs_.pc + 4);
  enter_exception();
  if (ledger_.profile) ledger_.profile->interrupted(fiq, ledger_.cycle);
  failure_.exceptions = 0;
  return true;
}

/// A reset, or an interrupt that is not masked, is raised but may not be visible yet.
bool Core::interrupt_pending() const {
  return reset_.level || (!(regs_.cpsr & kFiqMask) && fiq_.level) || (!(regs_.cpsr & kIrqMask) && irq_.level);
}

/// Handles an instruction boundary at which the horizon is reached, an interrupt line or mask has
/// changed, or the measurement window begins or ends.
void Core::step_attention() {
  for (;;) {
    interface_.attention = false;
    interface_.await_clock();
    // Changes at an edge are visible after it, including a change of the clock.
    ledger_.stall_to(interface_.clock_floor, Cause::kBusSync);
    const Picoseconds t = time(ledger_.cycle);
    take_marks(t);
    if (reset_.at(t)) {
      held_ = true;
      return;
    }
    if (take_interrupt(t)) continue;
    const std::uint64_t stop = interface_.first_clock_after_horizon();
    if (ledger_.cycle >= stop) {
      if (wait_for_others(t) == Boundary::kRepeat) continue;
      return;
    }
    // Check the next boundary again if an interrupt is raised but not visible yet, or a mark is not
    // reached yet.
    interface_.stop_cycle =
        interrupt_pending() || marks_pending() ? ledger_.cycle + 1 : stop;
    return;
  }
}

/// Lets all others act up to the boundary at time t. At t itself they may still act: the core
/// executes one instruction, then it checks again.
Core::Boundary Core::wait_for_others(Picoseconds t) {
  bus_.run_buffers(ledger_.cycle);
  interface_.port.sleep_until(t);
  const bool clock_changed = time(ledger_.cycle) != t || !interface_.clock.running();
  if (clock_changed) return Boundary::kRepeat;
  if (!interface_.attention && !marks_pending()) {
    const Picoseconds horizon = interface_.port.horizon();
    interface_.stop_cycle = horizon <= t || interrupt_pending()
                                ? ledger_.cycle + 1
                                : interface_.first_clock_after(horizon);
    return Boundary::kExecute;
  }
  take_marks(t);
  const bool fiq = !(regs_.cpsr & kFiqMask) && fiq_.at(t);
  if (fiq || reset_.at(t) || (!(regs_.cpsr & kIrqMask) && irq_.at(t))) return Boundary::kRepeat;
  interface_.attention = false;
  interface_.stop_cycle = ledger_.cycle + 1;
  return Boundary::kExecute;
}

void Core::forget_for_a_test() {
  forget_translations();
  fetch_.forget_lines();
  data_.lines().forget();
  bus_.forget();
  interface_.stop_cycle = 0;
}

/// True if the chain that was left for one instruction can continue with `next`.
bool Core::chain_goes_on(const Instruction* next) const {
  const std::uint64_t cycle = ledger_.cycle;
  return cycle < chain_.stop && cycle < interface_.stop_cycle && !interface_.attention &&
         regs_.pc == chain_.va + next->at && fetch_.line_va == chain_.va &&
         fetch_.line_thumb == (regs_.cpsr & kThumbState) && fetch_.current->valid &&
         cycle >= fetch_.fill.last && failure_.exceptions == 0;
}

void Core::interwork(std::uint32_t target) {
  const bool keeps_state = system_.control & kArmV4Loads;
  if (!keeps_state) regs_.cpsr = (regs_.cpsr & ~kThumbState) | (target & 1u ? kThumbState : 0);
  branch_to(target & (regs_.thumb() ? ~1u : ~3u));
}

void Core::execute(const Instruction& i) {
  if (is_data_processing(i.op)) return data_processing(i);
  switch (i.op) {
    case Op::kLdr: case Op::kLdrb: case Op::kStr: case Op::kStrb: case Op::kLdrh:
    case Op::kLdrsb: case Op::kLdrsh: case Op::kStrh: case Op::kLdrd: case Op::kStrd:
      return load_store(i);
    case Op::kLdm: return load_multiple(i);
    case Op::kStm: return store_multiple(i);
    default:
      return execute_rare(i);
  }
}

void Core::execute_rare(const Instruction& i) {
  switch (i.op) {
    case Op::kSmulxy: case Op::kSmlaxy: case Op::kSmulwy: case Op::kSmlawy: case Op::kSmlalxy:
    case Op::kQadd: case Op::kQsub: case Op::kQdadd: case Op::kQdsub:
      return dsp(i);
    case Op::kSwp: case Op::kSwpb: return swap(i);
    case Op::kPld: spend(1); return;
    case Op::kBlxImm:
      regs_.r[14] = regs_.pc + 4;
      regs_.cpsr |= 0x20u;
      branch_to(regs_.r[15] + i.imm);
      spend(3);
      return;
    case Op::kThumbBlSuffix: {  // the suffix that switches to ARM state
      const std::uint32_t target = regs_.r[14] + i.imm;
      regs_.r[14] = (regs_.pc + 2) | 1u;
      regs_.cpsr &= ~0x20u;
      branch_to(target & ~3u);
      spend(3);
      return;
    }
    case Op::kMrs: case Op::kMsr: return status(i);
    case Op::kSwi: {
      const std::uint32_t number = (i.flags & kThumbInsn) ? i.raw & 0xFFu : i.raw & 0xFFFFFFu;
      if (swi_handlers_.any([&](SwiHandler& handles) { return handles(*this, number); })) {
        spend(3);
        return;
      }
      take(Exception::kSwi, next_pc_);
      aborted_ = false;
      return;
    }
    case Op::kBkpt:
      mmu_.fault(Access::kFetch, Fault::kBreakpoint, 0, regs_.pc);
      prefetch_abort();
      return;
    case Op::kMcr: case Op::kMrc:
      coprocessor_move(i);
      data_.forget_hints();  // lines may be clean or gone
      return;
    default: return undefined();
  }
}

}  // namespace fovea::cpu
