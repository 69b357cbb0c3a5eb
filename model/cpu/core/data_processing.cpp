// Handlers of data-processing instructions: one for each operation, operand form and S bit, so that
// unneeded work (carry-out, flags) costs no host time. Cycle counts: ARM DDI 0222B chapter 8.
#include "model/cpu/core/handlers.h"
#include "model/cpu/core/shifter.h"

namespace fovea::cpu {
namespace {

constexpr bool logical(Op op) {
  return op == Op::kAnd || op == Op::kEor || op == Op::kTst || op == Op::kTeq || op == Op::kOrr ||
         op == Op::kMov || op == Op::kBic || op == Op::kMvn;
}
constexpr bool writes(Op op) { return op != Op::kTst && op != Op::kTeq && op != Op::kCmp && op != Op::kCmn; }

// The flags are separate results and not members of a struct with the value: compilers pack such
// members into one register, which takes longer than the addition.

/// x + y + in, with carry and overflow of the adder.
[[gnu::always_inline]] inline std::uint32_t add(std::uint32_t x, std::uint32_t y, bool in,
                                                bool& carry, bool& overflow) {
  const std::uint64_t sum = std::uint64_t{x} + y + in;
  const auto value = static_cast<std::uint32_t>(sum);
  carry = (sum >> 32) != 0;
  overflow = ((~(x ^ y) & (x ^ value)) >> 31) != 0;
  return value;
}
/// x + y, with carry and overflow.
[[gnu::always_inline]] inline std::uint32_t add(std::uint32_t x, std::uint32_t y, bool& carry,
                                                bool& overflow) {
  std::int32_t value;
  overflow = __builtin_add_overflow(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                                    &value);
  carry = static_cast<std::uint32_t>(value) < x;
  return static_cast<std::uint32_t>(value);
}
/// x - y; the carry is the complement of the borrow.
[[gnu::always_inline]] inline std::uint32_t subtract(std::uint32_t x, std::uint32_t y, bool& carry,
                                                     bool& overflow) {
  std::int32_t value;
  overflow = __builtin_sub_overflow(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                                    &value);
  carry = x >= y;
  return static_cast<std::uint32_t>(value);
}

/// @param carry in: the shifter's carry-out, which logical operations keep
template <Op kOp>
[[gnu::always_inline]] inline std::uint32_t compute(std::uint32_t a, std::uint32_t b, bool c,
                                                    bool& carry, bool& overflow) {
  switch (kOp) {
    case Op::kAnd: case Op::kTst: return a & b;
    case Op::kEor: case Op::kTeq: return a ^ b;
    case Op::kSub: case Op::kCmp: return subtract(a, b, carry, overflow);
    case Op::kRsb: return subtract(b, a, carry, overflow);
    case Op::kAdd: case Op::kCmn: return add(a, b, carry, overflow);
    case Op::kAdc: return add(a, b, c, carry, overflow);
    case Op::kSbc: return add(a, ~b, c, carry, overflow);
    case Op::kRsc: return add(b, ~a, c, carry, overflow);
    case Op::kOrr: return a | b;
    case Op::kMov: return b;
    case Op::kBic: return a & ~b;
    default: return ~b;
  }
}

constexpr unsigned kForms = static_cast<unsigned>(Form::kCount);

}  // namespace

template <Op kOp, Form kForm, bool kSet>
Core::Ops::Next Core::Ops::data(Core& c, Next i, Cycle cycle) {
  // Immediates and plain registers leave the carry of a logical operation alone.
  constexpr bool kSetsCarry = !logical(kOp) || (kForm != Form::kImm && kForm != Form::kReg);
  bool carry = c.regs_.c, overflow = false;
  const std::uint32_t b = second_operand<kForm>(*i, c.regs_.r, carry);
  const std::uint32_t value = compute<kOp>(c.regs_.r[i->rn], b, c.regs_.c, carry, overflow);
  if constexpr (kSet) {
    c.regs_.n = c.regs_.z = value;
    if constexpr (kSetsCarry) c.regs_.c = carry;
    if constexpr (!logical(kOp)) c.regs_.v = overflow;
  }
  if constexpr (writes(kOp)) c.regs_.r[i->rd] = value;
  return next(c, i + 1, cycle + (shifts_by_register(kForm) ? 2 : 1));
}

/// Handlers of one form and S bit, by operation.
template <Form kForm, bool kSet, std::size_t... op>
constexpr Core::Ops::DataRow Core::Ops::data_row(std::index_sequence<op...>) {
  return {&data<static_cast<Op>(op), kForm, kSet>...};
}
/// By form.
template <bool kSet, std::size_t... form>
constexpr std::array<Core::Ops::DataRow, sizeof...(form)> Core::Ops::data_rows(std::index_sequence<form...>) {
  return {data_row<static_cast<Form>(form), kSet>(std::make_index_sequence<kDataOps>{})...};
}

Handler Core::Ops::data_body(Instruction& i) {
  static constexpr auto kKeepsFlags = data_rows<false>(std::make_index_sequence<kForms>{});
  static constexpr auto kSetsFlags = data_rows<true>(std::make_index_sequence<kForms>{});
  if (writes(i.op) && i.rd == 15) return nullptr;
  // With a shift by register, r15 reads 12 bytes ahead, because it is read one clock later.
  if (i.operand == Operand::kShiftReg && (i.flags & kReadsPc)) return nullptr;
  const auto& rows = (i.flags & kSetFlags) ? kSetsFlags : kKeepsFlags;
  return rows[static_cast<std::size_t>(form_of(i))][static_cast<std::size_t>(i.op)];
}

/// Instructions without a handler: writes to the pc, and operands that read the pc one clock later.
/// The flags must be packed into the CPSR.
void Core::data_processing(const Instruction& decoded) {
  Instruction i = decoded;
  const bool late = i.operand == Operand::kShiftReg;
  const bool shifted_operand = late || i.operand == Operand::kShiftImm;
  auto r = regs_.r;
  if (late) r[15] += 4;
  bool carry = regs_.cpsr & kC, overflow = regs_.cpsr & kV;
  const std::uint32_t b = select(
      static_cast<unsigned>(form_of(i)),
      [](auto form) { return &second_operand<static_cast<Form>(decltype(form)::value)>; },
      std::make_index_sequence<kForms>{})(i, r, carry);
  const std::uint32_t value = select(
      static_cast<unsigned>(i.op),
      [](auto op) { return &compute<static_cast<Op>(decltype(op)::value)>; },
      std::make_index_sequence<Ops::kDataOps>{})(r[i.rn], b, (regs_.cpsr & kC) != 0, carry, overflow);
  if (writes(i.op) && i.rd == 15) {
    // For this, RSC behaves like the logical operations.
    spend(logical(i.op) || i.op == Op::kRsc || shifted_operand ? 4 : 3);
    if ((i.flags & kSetFlags) && !(i.flags & kThumbInsn)) {
      set_cpsr(regs_.spsr());
      exception_return_ = true;
      branch_to(value & ((regs_.cpsr & 0x20u) ? ~1u : ~3u));
      return;
    }
    branch_to(value & ((i.flags & kThumbInsn) ? ~1u : ~3u));
    return;
  }
  if (i.flags & kSetFlags)
    regs_.cpsr = (regs_.cpsr & 0x0FFFFFFFu) | (value & kN) | (value ? 0 : kZ) | (carry ? kC : 0) |
            (overflow ? kV : 0);
  if (writes(i.op)) regs_.r[i.rd] = value;
  spend(late ? 2 : 1);
}

}  // namespace fovea::cpu
