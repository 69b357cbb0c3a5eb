// The barrel shifter (ARM DDI 0100, A5.1).
#pragma once
#include <array>
#include <bit>
#include <cstdint>

#include "model/cpu/core/instruction.h"

namespace fovea::cpu {

/// The forms of a second operand that need different computations. form_of() turns an encoded
/// distance of 0 into 32 or, for ROR, into the form kRrx.
enum class Form : std::uint8_t {
  kImm, kImmCarry, kReg, kLsl, kLsr, kAsr, kRor, kRrx, kLslReg, kLsrReg, kAsrReg, kRorReg, kCount
};

constexpr bool shifts_by_register(Form form) {
  return form == Form::kLslReg || form == Form::kLsrReg || form == Form::kAsrReg || form == Form::kRorReg;
}

/// By Instruction::shift: an immediate distance, or one in a register.
inline constexpr Form kShifts[] = {Form::kLsl, Form::kLsr, Form::kAsr, Form::kRor};
inline constexpr Form kRegisterShifts[] = {Form::kLslReg, Form::kLsrReg, Form::kAsrReg, Form::kRorReg};

/// The form of a decoded record. Also rewrites the distance of an immediate shift as described
/// above, so it must be called only once for each record.
inline Form form_of(Instruction& i) {
  switch (i.operand) {
    case Operand::kImm: return (i.flags & kImmCarry) ? Form::kImmCarry : Form::kImm;
    case Operand::kReg: return Form::kReg;
    case Operand::kShiftImm:
      if (i.shift == 3 && i.amount == 0) return Form::kRrx;
      if (i.amount == 0) i.amount = 32;
      return kShifts[i.shift];
    default: return kRegisterShifts[i.shift];
  }
}

/// Shifts by an immediate distance. `carry` is the carry flag and becomes the shifter's carry-out.
template <Form kForm>
[[gnu::always_inline]] inline std::uint32_t shifted(std::uint32_t v, unsigned n, bool& carry) {
  const bool in = carry;
  if constexpr (kForm == Form::kLsl) {  // 1 to 31
    carry = v >> (32 - n) & 1u;
    return v << n;
  } else if constexpr (kForm == Form::kLsr) {  // 1 to 32
    carry = v >> (n - 1) & 1u;
    return static_cast<std::uint32_t>(std::uint64_t{v} >> n);
  } else if constexpr (kForm == Form::kAsr) {
    carry = v >> (n - 1) & 1u;
    return static_cast<std::uint32_t>(std::int64_t{static_cast<std::int32_t>(v)} >> n);
  } else if constexpr (kForm == Form::kRor) {
    carry = v >> (n - 1) & 1u;
    return std::rotr(v, static_cast<int>(n));
  } else {  // RRX
    carry = v & 1u;
    return v >> 1 | std::uint32_t{in} << 31;
  }
}

/// Shifts by the low byte `n` of a register.
template <Form kForm>
[[gnu::always_inline]] inline std::uint32_t shifted_by_register(std::uint32_t v, unsigned n,
                                                                bool& carry) {
  if (n == 0) return v;
  if constexpr (kForm == Form::kLslReg) {
    carry = n < 32 ? v >> (32 - n) & 1u : n == 32 ? v & 1u : 0;
    return n < 32 ? v << n : 0;
  } else if constexpr (kForm == Form::kLsrReg) {
    carry = n < 32 ? v >> (n - 1) & 1u : n == 32 ? v >> 31 : 0;
    return n < 32 ? v >> n : 0;
  } else if constexpr (kForm == Form::kAsrReg) {
    carry = n < 32 ? v >> (n - 1) & 1u : v >> 31;
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(v) >> (n < 32 ? n : 31));
  } else {
    carry = v >> ((n - 1) & 31u) & 1u;
    return std::rotr(v, static_cast<int>(n & 31u));
  }
}

/// Second operand of a data-processing instruction, from the current register values.
template <Form kForm>
[[gnu::always_inline]] inline std::uint32_t second_operand(
    const Instruction& i, const std::array<std::uint32_t, 16>& r, bool& carry) {
  if constexpr (kForm == Form::kImm) {
    return i.imm;
  } else if constexpr (kForm == Form::kImmCarry) {
    carry = i.imm >> 31;
    return i.imm;
  } else if constexpr (kForm == Form::kReg) {
    return r[i.rm];
  } else if constexpr (!shifts_by_register(kForm)) {
    return shifted<kForm>(r[i.rm], i.amount, carry);
  } else {
    return shifted_by_register<kForm>(r[i.rm], r[i.rs] & 0xFFu, carry);
  }
}

}  // namespace fovea::cpu
