// The barrel shifter (ARM ARM A5.1), and the names of the flags in the CPSR.
#pragma once
#include <array>
#include <bit>
#include <cstdint>

#include "model/cpu/core/instruction.h"

namespace fovea::cpu {

inline constexpr std::uint32_t kN = 1u << 31, kZ = 1u << 30, kC = 1u << 29, kV = 1u << 28,
                               kQ = 1u << 27;

/// The forms of a second operand that differ in what has to be computed. A distance of 32 stands as
/// 32 in the record, RRX as a form of its own (form_of()).
enum class Form : std::uint8_t {
  kImm, kImmCarry, kReg, kLsl, kLsr, kAsr, kRor, kRrx, kLslReg, kLsrReg, kAsrReg, kRorReg, kCount
};

/// Form of a decoded record; brings the distance of an immediate shift into the form above. To be
/// called once for a record.
inline Form form_of(Instruction& i) {
  switch (i.operand) {
    case Operand::kImm: return (i.flags & kImmCarry) ? Form::kImmCarry : Form::kImm;
    case Operand::kReg: return Form::kReg;
    case Operand::kShiftImm:
      if (i.shift == 3 && i.amount == 0) return Form::kRrx;
      if (i.amount == 0) i.amount = 32;
      return static_cast<Form>(static_cast<unsigned>(Form::kLsl) + i.shift);
    default: return static_cast<Form>(static_cast<unsigned>(Form::kLslReg) + i.shift);
  }
}

/// Shifts by an immediate distance. `carry` holds the flag and becomes the shifter's carry out.
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

/// Shifts by a register's low byte.
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

/// Second operand of a data processing instruction in the registers' present state.
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
  } else if constexpr (kForm < Form::kLslReg) {
    return shifted<kForm>(r[i.rm], i.amount, carry);
  } else {
    return shifted_by_register<kForm>(r[i.rm], r[i.rs] & 0xFFu, carry);
  }
}

}  // namespace fovea::cpu
