// Data processing instructions: a function for each operation, operand form and S bit, so that what
// an instruction does not need (carry out, flags) costs nothing. Cycle counts: arm926.md 1.1.
#include <bit>

#include "model/cpu/core/fast_path.h"
#include "model/cpu/core/shifter.h"

namespace fovea::cpu {

template <Op kOp, Operand kOperand, bool kSet>
void Core::data_op(Core& c, const Instruction& i) {
  constexpr bool kLate = kOperand == Operand::kShiftReg;  // operands read a cycle later
  constexpr bool kLogical = kOp == Op::kAnd || kOp == Op::kEor || kOp == Op::kRsc ||
                            kOp == Op::kOrr || kOp == Op::kMov || kOp == Op::kBic ||
                            kOp == Op::kMvn;
  constexpr bool kWrites = kOp < Op::kTst || kOp > Op::kCmn;
  const bool carry_in = c.cpsr_ & kC;
  bool carry = carry_in;
  const std::uint32_t b = shifter_operand<kOperand>(i, c.r_, c.cpsr_, carry);
  const std::uint32_t a = kLate && i.rn == 15 ? c.r_[15] + 4 : c.r_[i.rn];
  std::uint32_t result = 0;
  bool overflow = c.cpsr_ & kV;
  const auto add = [&](std::uint32_t x, std::uint32_t y, std::uint32_t in) {
    const std::uint64_t sum = std::uint64_t{x} + y + in;
    result = static_cast<std::uint32_t>(sum);
    carry = sum >> 32;
    overflow = (~(x ^ y) & (x ^ result)) >> 31;
  };
  switch (kOp) {
    case Op::kAnd: case Op::kTst: result = a & b; break;
    case Op::kEor: case Op::kTeq: result = a ^ b; break;
    case Op::kSub: case Op::kCmp: add(a, ~b, 1); break;
    case Op::kRsb: add(b, ~a, 1); break;
    case Op::kAdd: case Op::kCmn: add(a, b, 0); break;
    case Op::kAdc: add(a, b, carry_in); break;
    case Op::kSbc: add(a, ~b, carry_in); break;
    case Op::kRsc: add(b, ~a, carry_in); break;
    case Op::kOrr: result = a | b; break;
    case Op::kMov: result = b; break;
    case Op::kBic: result = a & ~b; break;
    default: result = ~b; break;
  }
  if constexpr (kWrites) {
    if (i.rd == 15) [[unlikely]] {
      constexpr bool kShifted = kOperand == Operand::kShiftImm || kLate;
      c.spend(kLogical || kShifted ? 4 : 3);
      if (kSet && !(i.flags & kThumbInsn)) {
        c.set_cpsr(c.spsr_[bank(c.cpsr_)]);
        c.branch_to(result & ((c.cpsr_ & 0x20u) ? ~1u : ~3u));
        return;
      }
      c.branch_to(result & ((i.flags & kThumbInsn) ? ~1u : ~3u));
      return;
    }
  }
  if constexpr (kSet)
    c.cpsr_ = (c.cpsr_ & 0x0FFFFFFFu) | (result & kN) | (result ? 0 : kZ) | (carry ? kC : 0) |
              (overflow ? kV : 0);
  if constexpr (kWrites) c.r_[i.rd] = result;
  c.spend(kLate ? 2 : 1);
}

/// Place of a function: operation, operand form << 4, S << 6.
template <std::size_t... k>
constexpr std::array<Core::DataHandler, 128> Core::make_data_handlers(std::index_sequence<k...>) {
  return {&data_op<static_cast<Op>(k & 15u), static_cast<Operand>(k >> 4 & 3u), (k >> 6) != 0>...};
}

const std::array<Core::DataHandler, 128> Core::kDataHandlers =
    Core::make_data_handlers(std::make_index_sequence<128>{});

}  // namespace fovea::cpu
