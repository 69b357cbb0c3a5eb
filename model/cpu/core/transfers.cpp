// Loads, stores and swaps in general; load_store.cpp has handlers for the common cases that hit a
// hint. Cycle counts and interlocks: ARM DDI 0222B chapter 8.
#include <bit>

#include "model/cpu/core/core.h"

namespace fovea::cpu {
namespace {

/// An unaligned word is rotated so that the addressed byte comes first.
std::uint32_t rotated(std::uint32_t word, std::uint32_t address) {
  return std::rotr(word, static_cast<int>(8 * (address & 3u)));
}

}  // namespace

void Core::load_store(const Instruction& i) {
  const DataAddress at = data_address(i, regs_.r, regs_.cpsr & kC);
  unsigned cycles = i.operand == Operand::kShiftImm && shifted_cycle_ ? 2 : 1;
  switch (i.op) {
    case Op::kLdrd: return load_pair(i, at);
    case Op::kStrd: return store_pair(i, at);
    case Op::kStr: case Op::kStrb: case Op::kStrh: return store_register(i, at, cycles);
    default: return load_register(i, at, cycles);
  }
}

void Core::store_register(const Instruction& i, const DataAddress& at, unsigned cycles) {
  const Rights rights = (i.flags & kUserBank) ? Rights::kUser : Rights::kOfMode;
  const std::uint32_t value = i.rd == 15 ? regs_.r[15] + 4 : regs_.r[i.rd];
  if (store(at.first, at.bytes, value, rights) != Result::kOk) return data_abort(cycles);
  write_back_base(i, at);
  spend(cycles);
}

void Core::load_register(const Instruction& i, const DataAddress& at, unsigned cycles) {
  const Rights rights = (i.flags & kUserBank) ? Rights::kUser : Rights::kOfMode;
  const std::uint32_t address = at.first;
  std::uint32_t value = 0;
  if (load(address, at.bytes, value, rights) != Result::kOk) return data_abort(cycles);
  write_back_base(i, at);
  switch (i.op) {
    case Op::kLdr:
      value = rotated(value, address);
      if (i.rd == 15) [[unlikely]] {
        spend(cycles + 4);
        return interwork(value);
      }
      regs_.r[i.rd] = value;
      spend(cycles);
      return loaded(i.rd, (address & 3u) ? 2 : 1);
    case Op::kLdrsb:
      value = static_cast<std::uint32_t>(static_cast<std::int8_t>(value));
      break;
    case Op::kLdrsh:
      value = static_cast<std::uint32_t>(static_cast<std::int16_t>(value));
      break;
    default: break;
  }
  if (i.rd == 15) return spend(cycles);  // UNPREDICTABLE: the value is discarded
  regs_.r[i.rd] = value;
  spend(cycles);
  loaded(i.rd, 2);
}

void Core::load_pair(const Instruction& i, const DataAddress& at) {
  const std::uint32_t first = at.touched();
  std::uint32_t value = 0, second = 0;
  if (misaligned(at.first, 4)) return data_abort(2);
  if (load(first, 4, value, Rights::kOfMode) != Result::kOk) {
    mmu_.external_abort_at(first + 4);
    return data_abort(2);
  }
  spend(1);
  if (load(first + 4, 4, second, Rights::kOfMode) != Result::kOk) return data_abort(1);
  write_back_base(i, at);
  regs_.r[i.rd] = value;
  if (i.rd + 1u == 15) {
    spend(5);
    return interwork(second);
  }
  regs_.r[i.rd + 1u] = second;
  spend(1);
  loaded(i.rd + 1u, 1);
}

void Core::store_pair(const Instruction& i, const DataAddress& at) {
  const std::uint32_t words[2] = {regs_.r[i.rd],
                                  i.rd + 1u == 15 ? regs_.r[15] + 4 : regs_.r[i.rd + 1u]};
  const std::uint64_t begun = ledger_.counts.issue;
  if (misaligned(at.first, 4) || store_words(at.touched(), words, 2) != Result::kOk)
    return data_abort(2 - static_cast<unsigned>(ledger_.counts.issue - begun));
  write_back_base(i, at);
}

void Core::load_multiple(const Instruction& i) {
  const DataAddress at = data_address(i, regs_.r, false);
  const unsigned n = at.bytes / 4;
  if (n == 0) {  // empty list: only the base moves (isa_reactions.cpp)
    if (i.flags & kWriteBack) regs_.r[i.rn] = at.moved;
    spend(1);
    return;
  }
  if (misaligned(at.first, 4)) return data_abort(n);
  std::array<std::uint32_t, 16> values;
  for (unsigned k = 0; k < n; ++k) {
    if (load(at.touched() + 4 * k, 4, values[k], Rights::kOfMode) != Result::kOk) {
      mmu_.external_abort_at(at.touched() + 4 * (n - 1));
      return data_abort(n - k);
    }
    spend(1);
  }
  if (n == 1 && !(i.imm & 0x8000u)) spend(1);
  const bool user_bank = (i.flags & kUserBank) && !(i.imm & 0x8000u);
  const std::uint32_t mode = regs_.cpsr & kModeBits;
  // The write-back wins, unless the base is the last of several registers.
  const bool base_listed = i.imm >> i.rn & 1u;
  const bool base_last = base_listed && (i.imm >> i.rn) == 1u && n > 1;
  if (user_bank) regs_.switch_mode(static_cast<std::uint32_t>(CpuMode::kSys));
  unsigned k = 0, last = 0;
  std::uint32_t target = 0;
  for (std::uint32_t set = i.imm; set; set &= set - 1, ++k) {
    const auto r = static_cast<unsigned>(std::countr_zero(set));
    last = r;
    if (r == 15) target = values[k];
    else regs_.r[r] = values[k];
  }
  if (user_bank) regs_.switch_mode(mode);
  if ((i.flags & kWriteBack) && !(base_listed && base_last)) regs_.r[i.rn] = at.moved;
  if (!(i.imm & 0x8000u)) {
    if (n > 1) loaded(last, 1);
    return;
  }
  spend(4);
  if (!(i.flags & kUserBank)) return interwork(target);
  set_cpsr(regs_.spsr());
  exception_return_ = true;
  branch_to(target & (regs_.thumb() ? ~1u : ~3u));
}

void Core::store_multiple(const Instruction& i) {
  const DataAddress at = data_address(i, regs_.r, false);
  const unsigned n = at.bytes / 4;
  if (n == 0) {
    if (i.flags & kWriteBack) regs_.r[i.rn] = at.moved;
    spend(1);
    return;
  }
  if (misaligned(at.first, 4)) return data_abort(n);
  std::array<std::uint32_t, 16> values;
  const std::uint32_t mode = regs_.cpsr & kModeBits;
  if (i.flags & kUserBank) regs_.switch_mode(static_cast<std::uint32_t>(CpuMode::kSys));
  unsigned k = 0;
  for (std::uint32_t set = i.imm; set; set &= set - 1, ++k) {
    const auto r = static_cast<unsigned>(std::countr_zero(set));
    values[k] = r == 15 ? regs_.pc + 12 : regs_.r[r];
  }
  if (i.flags & kUserBank) regs_.switch_mode(mode);
  const std::uint64_t begun = ledger_.counts.issue;
  if (store_words(at.touched(), values.data(), n) != Result::kOk)
    return data_abort(n - static_cast<unsigned>(ledger_.counts.issue - begun));
  if (n == 1) spend(1);
  if (i.flags & kWriteBack) regs_.r[i.rn] = at.moved;
}

void Core::swap(const Instruction& i) {
  const DataAddress at = data_address(i, regs_.r, false);
  const std::uint32_t address = at.first, out = regs_.r[i.rm];
  const unsigned bytes = at.bytes;
  std::uint32_t value = 0;
  // If the write is not permitted, it aborts before the read locks the bus.
  const bool aligned = !(system_.control & kAlignmentChecked) || !(address & (bytes - 1u));
  const std::uint32_t mva = system_.modified(address) & ~(bytes - 1u);
  if (aligned && !translate(mva, Access::kStore, Rights::kOfMode)) return data_abort(2);
  swapping_ = true;
  const bool ok = load(address, bytes, value, Rights::kOfMode) == Result::kOk &&
                  store(address, bytes, out, Rights::kOfMode) == Result::kOk;
  swapping_ = false;
  if (!ok) return data_abort(2);
  if (bytes == 4) value = rotated(value, address);
  regs_.r[i.rd] = value;
  spend(2);
  if (bytes == 1 || (address & 3u)) loaded(i.rd, 1);
}

}  // namespace fovea::cpu
