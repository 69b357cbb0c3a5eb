// The barrel shifter (ARM ARM A5.1), and the names of the flags in the CPSR.
#pragma once
#include <array>
#include <bit>
#include <cstdint>

#include "model/cpu/core/instruction.h"

namespace fovea::cpu {

inline constexpr std::uint32_t kN = 1u << 31, kZ = 1u << 30, kC = 1u << 29, kV = 1u << 28,
                               kQ = 1u << 27;

/// Second operand of a data processing instruction, or the offset of a load. `carry` holds the
/// flag's value and becomes the shifter's carry out.
template <Operand kOperand>
inline std::uint32_t shifter_operand(const Instruction& i,
                                     const std::array<std::uint32_t, 16>& r, std::uint32_t cpsr,
                                     bool& carry) {
  if constexpr (kOperand == Operand::kImm) {
    if (i.flags & kImmCarry) carry = i.imm >> 31;
    return i.imm;
  } else if constexpr (kOperand == Operand::kReg) {
    return r[i.rm];
  } else if constexpr (kOperand == Operand::kShiftImm) {
    const std::uint32_t v = r[i.rm];
    const unsigned n = i.amount;
    switch (i.shift) {
      case 0:
        carry = n ? v >> (32 - n) & 1u : carry;
        return n ? v << n : v;
      case 1:
        carry = n ? v >> (n - 1) & 1u : v >> 31;
        return n ? v >> n : 0;
      case 2:
        carry = n ? v >> (n - 1) & 1u : v >> 31;
        return static_cast<std::uint32_t>(static_cast<std::int32_t>(v) >> (n ? n : 31));
      default:
        if (n == 0) {  // RRX
          carry = v & 1u;
          return v >> 1 | (cpsr & kC) << 2;
        }
        carry = v >> (n - 1) & 1u;
        return std::rotr(v, static_cast<int>(n));
    }
  } else {
    // Register-specified: the pc reads 12 ahead (one cycle later).
    const std::uint32_t v = i.rm == 15 ? r[15] + 4 : r[i.rm];
    const unsigned n = r[i.rs] & 0xFFu;
    if (n == 0) return v;
    switch (i.shift) {
      case 0:
        carry = n < 32 ? v >> (32 - n) & 1u : n == 32 ? v & 1u : 0;
        return n < 32 ? v << n : 0;
      case 1:
        carry = n < 32 ? v >> (n - 1) & 1u : n == 32 ? v >> 31 : 0;
        return n < 32 ? v >> n : 0;
      case 2:
        carry = n < 32 ? v >> (n - 1) & 1u : v >> 31;
        return static_cast<std::uint32_t>(static_cast<std::int32_t>(v) >> (n < 32 ? n : 31));
      default:
        carry = v >> ((n - 1) & 31u) & 1u;
        return std::rotr(v, static_cast<int>(n & 31u));
    }
  }
}

}  // namespace fovea::cpu
