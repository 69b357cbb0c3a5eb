// Execution of instructions. Cycle counts and interlocks: ARM DDI 0222B chapter 8.
#include <bit>

#include "model/cpu/core/handlers.h"

namespace fovea::cpu {
namespace {

/// Bit cond*16 + NZCV is set if the condition holds.
constexpr std::array<std::uint16_t, 16> make_conditions() {
  std::array<std::uint16_t, 16> out{};
  for (unsigned f = 0; f < 16; ++f) {
    const bool n = f & 8, z = f & 4, c = f & 2, v = f & 1;
    const bool pass[16] = {z, !z, c, !c, n, !n, v, !v, c && !z, !c || z,
                           n == v, n != v, !z && n == v, z || n != v, true, false};
    for (unsigned k = 0; k < 16; ++k)
      if (pass[k]) out[k] = static_cast<std::uint16_t>(out[k] | (1u << f));
  }
  return out;
}
constexpr auto kConditions = make_conditions();

std::int32_t half(std::uint32_t v, bool top) {
  return static_cast<std::int16_t>(top ? v >> 16 : v);
}

std::uint32_t saturate(std::int64_t v, bool& q) {
  if (v > INT32_MAX) {
    q = true;
    return INT32_MAX;
  }
  if (v < INT32_MIN) {
    q = true;
    return 0x80000000u;
  }
  return static_cast<std::uint32_t>(v);
}

}  // namespace

void Core::run() {
  unpack_flags();
  struct Live {
    Core& core;
    explicit Live(Core& c) : core(c) { core.flags_live_ = true; }
    ~Live() {
      core.pack_flags();
      core.flags_live_ = false;
    }
  } live(*this);
  std::uint32_t inspected_pc = 1;  // pc of a boundary that the debugger has already inspected
  for (;;) {
    if (cycle_ >= stop_cycle_ || attention_) {
      if (stop_requested_) return;
      pack_flags();
      step_attention();
      if (held_) return;
      if (stop_requested_) stop_cycle_ = 0;  // execute one more instruction
    }
    if (debugger_ && pc_ != inspected_pc) [[unlikely]] {
      control_boundary();
      if (stop_requested_) return;
    }
    inspected_pc = 1;
    const Instruction* i = fetch();
    if (!i) {
      enter_exception();
      continue;
    }
    if (bus_fetch_) {  // an interrupt that arrived meanwhile is taken first
      bus_fetch_ = false;
      if ((cycle_ >= stop_cycle_ || attention_) && !stop_requested_) {
        inspected_pc = pc_;
        continue;
      }
    }
    run_va_ = pc_ & ~31u;
    run_first_ = reinterpret_cast<std::intptr_t>(i);
    const bool chain = line_va_ == run_va_ && cycle_ >= busy_until_ && cycle_ >= ifill_.last &&
                       chain_ == 0 && old_fetch_left_ == 0 && !debugger_;
    if (chain) {
      chain_stop_ = stop_cycle_;
      i = i->handler(*this, i, cycle_);
      while (i) i = i->handler(*this, i, chain_cycle_);
    } else {
      execute_alone(*i);
    }
    if (old_fetch_left_) [[unlikely]] end_old_fetch();
  }
}

/// Completes an exception that was not raised by an instruction.
void Core::enter_exception() {
  pc_ = next_pc_;
  branched_ = aborted_ = false;
  if (old_fetch_left_) end_old_fetch();
}

/// Called after an instruction: the two instructions that follow a write of the FCSE PID, or a
/// change that turns the MMU or the I-cache on or off, were fetched before it took effect, unless
/// the program branches (ARM DDI 0198D 2-34; two for the control register as well, from the length
/// of the pipeline).
void Core::end_old_fetch() {
  if (pc_ == old_fetch_pc_ && --old_fetch_left_) {
    old_fetch_pc_ += (cpsr_ & 0x20u) ? 2u : 4u;
    return;
  }
  old_fetch_left_ = 0;
  fetch_process_ = process_;
  if (fetch_control_ != control_) fetch_buffer_pa_ = 1;
  fetch_control_ = control_;
  flush_memos();
}

/// An instruction whose beginning or end may depend on earlier instructions.
void Core::execute_alone(const Instruction& i) {
  if (i.cond != 14 && !(kConditions[i.cond] >> (packed_cpsr() >> 28) & 1u)) {
    spend(1);
    ++counts_.instructions;
    pc_ += (i.flags & kThumbInsn) ? 2u : 4u;
    return;
  }
  if (cycle_ < busy_until_) stall_to(operands_ready(i, cycle_), Cause::kInterlock);
  if (i.flags & kReadsPc)
    r_[15] = (pc_ + ((i.flags & kThumbInsn) ? 4u : 8u)) & ((i.flags & kAlignPc) ? ~3u : ~0u);
  chain_stop_ = 0;
  const std::uint64_t exceptions = counts_.exceptions;
  i.body(*this, &i, cycle_);
  if (counts_.exceptions == exceptions) chain_ = 0;
  if (branched_) {
    branched_ = false;
    fetch_branched_ = true;
  }
}

/// An instruction without a fast handler, or whose access is not a plain hit. State is settled.
void Core::execute_one(const Instruction& i) {
  next_pc_ = pc_ + ((i.flags & kThumbInsn) ? 2u : 4u);
  if (i.flags & kReadsPc)
    r_[15] = (pc_ + ((i.flags & kThumbInsn) ? 4u : 8u)) & ((i.flags & kAlignPc) ? ~3u : ~0u);
  pack_flags();
  execute(i);
  unpack_flags();
  if (aborted_) {
    aborted_ = false;
  } else {
    ++counts_.instructions;
    chain_ = 0;
  }
  if (branched_) {
    branched_ = false;
    fetch_branched_ = true;
  }
  pc_ = next_pc_;
}

/// Handles an instruction boundary at which the horizon is reached, an interrupt line or mask has
/// changed, or the measurement window begins or ends.
void Core::step_attention() {
  for (;;) {
    attention_ = false;
    await_clock();
    // Changes at an edge are visible after it, including a change of the clock.
    stall_to(clock_floor_, Cause::kBusSync);
    const Picoseconds t = time(cycle_);
    while (mark_due(t)) snapshot();
    if (reset_.at(t)) {
      held_ = true;
      return;
    }
    const bool fiq_open = !(cpsr_ & 0x40u), irq_open = !(cpsr_ & 0x80u);
    if (fiq_open && fiq_.at(t)) {
      take(Exception::kFiq, pc_ + 4);
      enter_exception();
      chain_ = 0;
      continue;
    }
    if (irq_open && irq_.at(t)) {
      take(Exception::kIrq, pc_ + 4);
      enter_exception();
      chain_ = 0;
      continue;
    }
    const Picoseconds h = port_.horizon();
    const std::uint64_t stop = h == kNever ? ~std::uint64_t{0} : clock_.edge_after(h);
    if (cycle_ >= stop) {
      run_buffers(cycle_);
      port_.sleep_until(t);
      if (time(cycle_) != t || !clock_.running()) continue;  // the clock has changed meanwhile
      // At t itself others may still act: execute this instruction, then check again.
      if (!attention_ && !mark_pending_) {
        const Picoseconds again = port_.horizon();
        stop_cycle_ = again <= t ? cycle_ + 1
                      : again == kNever ? ~std::uint64_t{0} : clock_.edge_after(again);
        if ((fiq_open && fiq_.level) || (irq_open && irq_.level) || reset_.level)
          stop_cycle_ = cycle_ + 1;
        return;
      }
      const Picoseconds now = time(cycle_);
      while (mark_due(now)) snapshot();
      if ((fiq_open && fiq_.at(now)) || (irq_open && irq_.at(now)) || reset_.at(now)) continue;
      attention_ = false;
      stop_cycle_ = cycle_ + 1;
      return;
    }
    stop_cycle_ = stop;
    // An interrupt is raised but not visible yet, or a mark is not reached yet: check the next
    // boundary.
    if ((fiq_open && fiq_.level) || (irq_open && irq_.level) || reset_.level || mark_pending_)
      stop_cycle_ = cycle_ + 1;
    return;
  }
}

/// True if the chain that was left for one instruction can continue with `next`.
bool Core::chain_goes_on(const Instruction* next) const {
  return cycle_ < chain_stop_ && cycle_ < stop_cycle_ && !attention_ &&
         pc_ == run_va_ + next->at && line_va_ == run_va_ && line_thumb_ == (cpsr_ & 0x20u) &&
         current_line_->valid && cycle_ >= ifill_.last && chain_ == 0;
}

void Core::dsp(const Instruction& i) {
  bool q = false;
  if (i.op <= Op::kSmlalxy) ++counts_.multiplies;
  const auto s = [this](unsigned r) { return std::int64_t{static_cast<std::int32_t>(r_[r])}; };
  unsigned cycles = 1;
  switch (i.op) {
    case Op::kSmulxy:
      r_[i.rn] = static_cast<std::uint32_t>(half(r_[i.rm], i.flags & kTop1) *
                                            half(r_[i.rs], i.flags & kTop2));
      multiplied(i.rn, 2);
      break;
    case Op::kSmlaxy: {
      const std::int64_t v = std::int64_t{half(r_[i.rm], i.flags & kTop1)} *
                                 half(r_[i.rs], i.flags & kTop2) + s(i.rd);
      if (v != static_cast<std::int32_t>(v)) q = true;
      r_[i.rn] = static_cast<std::uint32_t>(v);
      multiplied(i.rn, 2);
      break;
    }
    case Op::kSmulwy:
      r_[i.rn] = static_cast<std::uint32_t>((s(i.rm) * half(r_[i.rs], i.flags & kTop2)) >> 16);
      multiplied(i.rn, 2);
      break;
    case Op::kSmlawy: {
      const std::int64_t v = ((s(i.rm) * half(r_[i.rs], i.flags & kTop2)) >> 16) + s(i.rd);
      if (v != static_cast<std::int32_t>(v)) q = true;
      r_[i.rn] = static_cast<std::uint32_t>(v);
      multiplied(i.rn, 2);
      break;
    }
    case Op::kSmlalxy: {
      std::uint64_t v = std::uint64_t{r_[i.rn]} << 32 | r_[i.rd];
      v += static_cast<std::uint64_t>(std::int64_t{half(r_[i.rm], i.flags & kTop1)} *
                                      half(r_[i.rs], i.flags & kTop2));
      r_[i.rd] = static_cast<std::uint32_t>(v);
      r_[i.rn] = static_cast<std::uint32_t>(v >> 32);
      cycles = 2;
      break;
    }
    case Op::kQadd: r_[i.rd] = saturate(s(i.rm) + s(i.rn), q); produce(i.rd, 2); break;
    case Op::kQsub: r_[i.rd] = saturate(s(i.rm) - s(i.rn), q); produce(i.rd, 2); break;
    case Op::kQdadd: {
      const std::uint32_t twice = saturate(2 * s(i.rn), q);
      r_[i.rd] = saturate(s(i.rm) + static_cast<std::int32_t>(twice), q);
      produce(i.rd, 2);
      break;
    }
    default: {
      const std::uint32_t twice = saturate(2 * s(i.rn), q);
      r_[i.rd] = saturate(s(i.rm) - static_cast<std::int32_t>(twice), q);
      produce(i.rd, 2);
      break;
    }
  }
  if (q) cpsr_ |= kQ;
  spend(cycles);
}

void Core::interwork(std::uint32_t target) {
  if ((target & 1u) && !(control_ >> 15 & 1u)) {
    cpsr_ |= 0x20u;
    branch_to(target & ~1u);
  } else {
    if (!(control_ >> 15 & 1u)) cpsr_ &= ~0x20u;
    branch_to(target & ((cpsr_ & 0x20u) ? ~1u : ~3u));
  }
}

/// Offset of a load or store; no such instruction shifts by a register.
std::uint32_t Core::offset(const Instruction& decoded) const {
  if (decoded.operand == Operand::kImm) return decoded.imm;
  Instruction i = decoded;
  bool carry = cpsr_ & kC;
  switch (form_of(i)) {
    case Form::kReg: return r_[i.rm];
    case Form::kLsl: return shifted<Form::kLsl>(r_[i.rm], i.amount, carry);
    case Form::kLsr: return shifted<Form::kLsr>(r_[i.rm], i.amount, carry);
    case Form::kAsr: return shifted<Form::kAsr>(r_[i.rm], i.amount, carry);
    case Form::kRor: return shifted<Form::kRor>(r_[i.rm], i.amount, carry);
    default: return shifted<Form::kRrx>(r_[i.rm], i.amount, carry);
  }
}

void Core::load_store(const Instruction& i) {
  const bool user = i.flags & kUserBank;
  const std::uint32_t by = offset(i);
  const std::uint32_t base = r_[i.rn];
  const std::uint32_t moved = (i.flags & kUp) ? base + by : base - by;
  const std::uint32_t address = (i.flags & kPre) ? moved : base;
  unsigned cycles = i.operand == Operand::kShiftImm && shifted_cycle_ ? 2 : 1;
  std::uint32_t value = 0;
  const auto write_back = [&] {
    if ((i.flags & kWriteBack) && i.rn != 15) r_[i.rn] = moved;
  };
  switch (i.op) {
    case Op::kStr:
    case Op::kStrb:
    case Op::kStrh: {
      value = i.rd == 15 ? r_[15] + 4 : r_[i.rd];
      const unsigned bytes = i.op == Op::kStr ? 4 : i.op == Op::kStrb ? 1 : 2;
      if (store(address, bytes, value, user) != Result::kOk) return data_abort(cycles);
      write_back();
      spend(cycles);
      return;
    }
    case Op::kLdr:
      if (load(address, 4, value, user) != Result::kOk) return data_abort(cycles);
      write_back();
      if (address & 3u) value = std::rotr(value, static_cast<int>(8 * (address & 3u)));
      if (i.rd == 15) [[unlikely]] {
        spend(cycles + 4);
        return interwork(value);
      }
      r_[i.rd] = value;
      spend(cycles);
      loaded(i.rd, (address & 3u) ? 2 : 1);
      return;
    case Op::kLdrb:
      if (load(address, 1, value, user) != Result::kOk) return data_abort(cycles);
      break;
    case Op::kLdrh:
      if (load(address, 2, value, user) != Result::kOk) return data_abort(cycles);
      break;
    case Op::kLdrsb:
      if (load(address, 1, value, user) != Result::kOk) return data_abort(cycles);
      value = static_cast<std::uint32_t>(static_cast<std::int8_t>(value));
      break;
    case Op::kLdrsh:
      if (load(address, 2, value, user) != Result::kOk) return data_abort(cycles);
      value = static_cast<std::uint32_t>(static_cast<std::int16_t>(value));
      break;
    case Op::kLdrd: {
      std::uint32_t second = 0;
      if (misaligned(address)) return data_abort(2);
      if (load(address & ~3u, 4, value, false) != Result::kOk) {
        external_abort_at((address & ~3u) + 4);
        return data_abort(2);
      }
      spend(1);
      if (load((address & ~3u) + 4, 4, second, false) != Result::kOk) return data_abort(1);
      write_back();
      r_[i.rd] = value;
      if (i.rd + 1u == 15) {
        spend(5);
        return interwork(second);
      }
      r_[i.rd + 1u] = second;
      spend(1);
      loaded(i.rd + 1u, 1);
      return;
    }
    default: {  // STRD
      const std::uint32_t words[2] = {r_[i.rd], i.rd + 1u == 15 ? r_[15] + 4 : r_[i.rd + 1u]};
      const std::uint64_t begun = counts_.issue;
      if (misaligned(address) || store_words(address & ~3u, words, 2, false) != Result::kOk)
        return data_abort(2 - static_cast<unsigned>(counts_.issue - begun));
      write_back();
      return;
    }
  }
  write_back();
  if (i.rd == 15) return spend(cycles);  // UNPREDICTABLE: the value is discarded
  r_[i.rd] = value;
  spend(cycles);
  loaded(i.rd, 2);
}

void Core::load_multiple(const Instruction& i) {
  const std::uint32_t base = r_[i.rn];
  const unsigned n = static_cast<unsigned>(std::popcount(i.imm));
  if (n == 0) {  // empty list: the base moves by sixteen words (isa_reactions.cpp)
    if (i.flags & kWriteBack) r_[i.rn] = (i.flags & kUp) ? base + 64 : base - 64;
    spend(1);
    return;
  }
  const std::uint32_t end = (i.flags & kUp) ? base + 4 * n : base - 4 * n;
  std::uint32_t address = (i.flags & kUp) ? ((i.flags & kPre) ? base + 4 : base)
                                          : ((i.flags & kPre) ? end : end + 4);
  if (misaligned(address)) return data_abort(n);
  std::array<std::uint32_t, 16> values;
  for (unsigned k = 0; k < n; ++k) {
    const std::uint32_t at = (address + 4 * k) & ~3u;
    if (load(at, 4, values[k]) != Result::kOk) {
      external_abort_at((address & ~3u) + 4 * (n - 1));
      return data_abort(n - k);
    }
    spend(1);
  }
  if (n == 1 && !(i.imm & 0x8000u)) spend(1);
  const bool user_bank = (i.flags & kUserBank) && !(i.imm & 0x8000u);
  const std::uint32_t mode = cpsr_ & 31u;
  // The write-back wins, unless the base is the last of several registers.
  const bool base_listed = i.imm >> i.rn & 1u;
  const bool base_last = base_listed && (i.imm >> i.rn) == 1u && n > 1;
  if (user_bank) switch_mode(static_cast<std::uint32_t>(CpuMode::kSys));
  unsigned k = 0, last = 0;
  std::uint32_t target = 0;
  for (std::uint32_t set = i.imm; set; set &= set - 1, ++k) {
    const auto r = static_cast<unsigned>(std::countr_zero(set));
    last = r;
    if (r == 15) target = values[k];
    else r_[r] = values[k];
  }
  if (user_bank) switch_mode(mode);
  if ((i.flags & kWriteBack) && !(base_listed && base_last)) r_[i.rn] = end;
  if (i.imm & 0x8000u) {
    spend(4);
    if (i.flags & kUserBank) {
      set_cpsr(spsr_[bank(cpsr_)]);
      branch_to(target & ((cpsr_ & 0x20u) ? ~1u : ~3u));
    } else {
      interwork(target);
    }
    return;
  }
  if (n > 1) loaded(last, 1);
}

void Core::store_multiple(const Instruction& i) {
  const std::uint32_t base = r_[i.rn];
  const unsigned n = static_cast<unsigned>(std::popcount(i.imm));
  if (n == 0) {
    if (i.flags & kWriteBack) r_[i.rn] = (i.flags & kUp) ? base + 64 : base - 64;
    spend(1);
    return;
  }
  const std::uint32_t end = (i.flags & kUp) ? base + 4 * n : base - 4 * n;
  const std::uint32_t address = (i.flags & kUp) ? ((i.flags & kPre) ? base + 4 : base)
                                                : ((i.flags & kPre) ? end : end + 4);
  if (misaligned(address)) return data_abort(n);
  std::array<std::uint32_t, 16> values;
  const std::uint32_t mode = cpsr_ & 31u;
  if (i.flags & kUserBank) switch_mode(static_cast<std::uint32_t>(CpuMode::kSys));
  unsigned k = 0;
  for (std::uint32_t set = i.imm; set; set &= set - 1, ++k) {
    const auto r = static_cast<unsigned>(std::countr_zero(set));
    values[k] = r == 15 ? pc_ + 12 : r_[r];
  }
  if (i.flags & kUserBank) switch_mode(mode);
  const std::uint64_t begun = counts_.issue;
  if (store_words(address & ~3u, values.data(), n, false) != Result::kOk)
    return data_abort(n - static_cast<unsigned>(counts_.issue - begun));
  if (n == 1) spend(1);
  if (i.flags & kWriteBack) r_[i.rn] = end;
}

void Core::swap(const Instruction& i) {
  const unsigned bytes = i.op == Op::kSwpb ? 1 : 4;
  const std::uint32_t address = r_[i.rn], out = r_[i.rm];
  std::uint32_t value = 0;
  // If the write is not permitted, it aborts before the read locks the bus.
  const std::uint32_t mva = modified(address) & ~(bytes - 1u);
  const bool aligned = !(control_ & 2u) || !(address & (bytes - 1u));
  if (aligned && !translate(mva, true, false, false)) return data_abort(2);
  swapping_ = true;
  const bool ok = load(address, bytes, value) == Result::kOk &&
                  store(address, bytes, out) == Result::kOk;
  swapping_ = false;
  if (!ok) return data_abort(2);
  if (bytes == 4 && (address & 3u)) value = std::rotr(value, static_cast<int>(8 * (address & 3u)));
  r_[i.rd] = value;
  spend(2);
  if (bytes == 1 || (address & 3u)) loaded(i.rd, 1);
}

void Core::status(const Instruction& i) {
  if (i.op == Op::kMrs) {
    r_[i.rd] = (i.flags & kSpsr) ? spsr_[bank(cpsr_)] : cpsr_;
    spend(2);
    return;
  }
  const std::uint32_t v = i.operand == Operand::kReg ? r_[i.rm] : i.imm;
  std::uint32_t fields = 0;
  for (unsigned f = 0; f < 4; ++f)
    if (i.rs >> f & 1u) fields |= 0xFFu << (8 * f);
  fields &= 0xF80000FFu;
  if (i.flags & kSpsr) {
    auto& s = spsr_[bank(cpsr_)];
    s = (s & ~fields) | (v & fields);
  } else {
    if (!privileged()) fields &= 0xF8000000u;
    // MSR does not change the T bit.
    set_cpsr((cpsr_ & ~fields) | (v & fields & ~0x20u) | (cpsr_ & 0x20u));
  }
  spend(i.rs == 8 && !(i.flags & kSpsr) ? 1 : 3);
}

void Core::execute(const Instruction& i) {
  if (i.op <= Op::kMvn) return data_processing(i);
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
      r_[14] = pc_ + 4;
      cpsr_ |= 0x20u;
      branch_to(r_[15] + i.imm);
      spend(3);
      return;
    case Op::kThumbBlSuffix: {  // the suffix that switches to ARM state
      const std::uint32_t target = r_[14] + i.imm;
      r_[14] = (pc_ + 2) | 1u;
      cpsr_ &= ~0x20u;
      branch_to(target & ~3u);
      spend(3);
      return;
    }
    case Op::kMrs: case Op::kMsr: return status(i);
    case Op::kSwi: {
      const std::uint32_t number = (i.flags & kThumbInsn) ? i.raw & 0xFFu : i.raw & 0xFFFFFFu;
      if (swi_hook && swi_hook(*this, number)) {
        spend(3);
        return;
      }
      take(Exception::kSwi, next_pc_);
      aborted_ = false;
      return;
    }
    case Op::kBkpt:
      fault(true, 0x2, 0, pc_);
      take(Exception::kPrefetchAbort, pc_ + 4);
      return;
    case Op::kMcr: case Op::kMrc:
      coprocessor_move(i);
      flush_hints();  // lines may be clean or gone
      return;
    default: return undefined();
  }
}

}  // namespace fovea::cpu
