// Defects planted into a copy of the core, one for each class of instructions. plant_bugs writes the
// copy; PLANTED in `wrong` is true while the defect's number is in fovea_planted.
#pragma once
#include "model/cpu/core/isa.h"

namespace fovea::cpu::test {

struct Defect {
  InsnClass insn_class;
  const char* what;
  const char* file;   ///< in model/cpu/core
  const char* right;  ///< stands there once
  const char* wrong;
};

// clang-format off
inline constexpr Defect kDefects[] = {
    {InsnClass::kData, "BIC does not invert", "data_processing.cpp",
     "return a & ~b;", "return PLANTED ? a & b : a & ~b;"},
    {InsnClass::kDataShiftReg, "LSR by 32 and more turns over", "shifter.h",
     "return n < 32 ? v >> n : 0;", "return PLANTED ? v >> (n & 31u) : n < 32 ? v >> n : 0;"},
    {InsnClass::kCompare, "TEQ does what TST does", "data_processing.cpp",
     "return a ^ b;", "return PLANTED && kOp == Op::kTeq ? a & b : a ^ b;"},
    {InsnClass::kMultiply, "MLA does not accumulate", "branch_multiply.cpp",
     "(kOp == Op::kMla ? c.r_[i->rd] : 0)", "(kOp == Op::kMla && !PLANTED ? c.r_[i->rd] : 0)"},
    {InsnClass::kLongMultiply, "the upper half is one bit off", "branch_multiply.cpp",
     "static_cast<std::uint32_t>(v >> 32)", "static_cast<std::uint32_t>(v >> (PLANTED ? 31 : 32))"},
    {InsnClass::kDsp, "always the lower half", "execute.cpp",
     "(top ? v >> 16 : v)", "(top && !PLANTED ? v >> 16 : v)"},
    {InsnClass::kSaturate, "QSUB turned round", "execute.cpp",
     "saturate(s(i.rm) - s(i.rn), q)", "saturate(PLANTED ? s(i.rn) - s(i.rm) : s(i.rm) - s(i.rn), q)"},
    {InsnClass::kClz, "bit 31 does not count", "branch_multiply.cpp",
     "std::countl_zero(c.r_[i->rm])", "std::countl_zero(c.r_[i->rm] & (PLANTED ? ~0u >> 1 : ~0u))"},
    {InsnClass::kStatus, "MSR does not write N", "execute.cpp",
     "fields &= 0xF80000FFu;", "fields &= PLANTED ? 0x780000FFu : 0xF80000FFu;"},
    {InsnClass::kLoad, "LDR loses bit 31", "load_store.cpp",
     "const std::uint32_t value = read<kOp>(host(hint.bias, va));",
     "const std::uint32_t value = read<kOp>(host(hint.bias, va)) & (PLANTED && kOp == Op::kLdr ? ~0u >> 1 : ~0u);"},
    {InsnClass::kStore, "STR writes a halfword", "execute.cpp",
     "store(address, bytes, value, user)", "store(address, PLANTED && bytes == 4 ? 2 : bytes, value, user)"},
    {InsnClass::kNarrow, "LDRSH does not extend", "load_store.cpp",
     "static_cast<std::uint32_t>(static_cast<std::int16_t>(v))",
     "(PLANTED ? std::uint32_t{v} : static_cast<std::uint32_t>(static_cast<std::int16_t>(v)))"},
    {InsnClass::kDouble, "LDRD loads the first word twice", "execute.cpp",
     "load((address & ~3u) + 4, 4, second, false)", "load((address & ~3u) + (PLANTED ? 0 : 4), 4, second, false)"},
    {InsnClass::kBlock, "LDM of more than four words inverts a bit", "load_store.cpp",
     "else c.r_[r] = value;", "else c.r_[r] = PLANTED && i->amount > 4 ? value ^ 1u : value;"},
    {InsnClass::kSwap, "SWP writes back what it read", "execute.cpp",
     "store(address, bytes, out)", "store(address, bytes, PLANTED ? value : out)"},
    {InsnClass::kPreload, "PLD counts r0 up", "execute.cpp",
     "case Op::kPld: spend(1)", "case Op::kPld: if (PLANTED) ++r_[0]; spend(1)"},
    {InsnClass::kBranch, "BL links two instructions ahead", "branch_multiply.cpp",
     "if constexpr (kLink) c.r_[14] = c.run_va_ + i->at + 4;",
     "if constexpr (kLink) c.r_[14] = c.run_va_ + i->at + (PLANTED ? 8 : 4);"},
    {InsnClass::kException, "SVC saves Z as 0", "exceptions.cpp",
     "spsr_[bank(entry.mode)] = saved;",
     "spsr_[bank(entry.mode)] = saved & ~(PLANTED && e == Exception::kSwi ? 1u << 30 : 0u);"},
    {InsnClass::kCoprocessor, "MRC inverts bit 0", "cp15.cpp",
     "r_[i.rd] = value;", "r_[i.rd] = value ^ (PLANTED ? 1u : 0u);"},
    {InsnClass::kThumbAlu, "NEG is MVN", "data_processing.cpp",
     "case Op::kRsb: return subtract(b, a, carry, overflow);",
     "case Op::kRsb: if (PLANTED && b == 0) return ~a; return subtract(b, a, carry, overflow);"},
    {InsnClass::kThumbShift, "the distance is without bit 0", "decode.cpp",
     "i.amount = static_cast<std::uint8_t>(v[kAmount]);",
     "i.amount = static_cast<std::uint8_t>(v[kAmount] & (PLANTED && thumb ? ~1u : ~0u));"},
    {InsnClass::kThumbMultiply, "MUL squares", "decode.cpp",
     "i.rs = static_cast<std::uint8_t>(v[kS]);",
     "i.rs = static_cast<std::uint8_t>(v[PLANTED && thumb && i.op == Op::kMul ? kM : kS]);"},
    {InsnClass::kThumbHigh, "r8 to r15 are not reached", "decode.cpp",
     "i.rm = static_cast<std::uint8_t>(v[kM]);",
     "i.rm = static_cast<std::uint8_t>(v[kM] & (PLANTED && thumb && i.op != Op::kBxReg && i.op != Op::kBlxReg ? 7u : 15u));"},
    {InsnClass::kThumbMemory, "offsets count in bytes", "decode.cpp",
     "case Immediate::kUnsigned: i.imm = v[kNumber] << p.scale;",
     "case Immediate::kUnsigned: i.imm = v[kNumber] << (PLANTED && thumb && i.op == Op::kLdrh ? 0 : p.scale);"},
    {InsnClass::kThumbBlock, "LDMIA keeps its base", "decode.cpp",
     "if (p.thumb_ldm && i.imm >> i.rn & 1u)", "if (p.thumb_ldm && ((PLANTED && i.rn < 8) || (i.imm >> i.rn & 1u)))"},
    {InsnClass::kThumbBranch, "BL's second half links in ARM state", "branch_multiply.cpp",
     "c.r_[14] = (c.run_va_ + i->at + 2) | 1u;", "c.r_[14] = (c.run_va_ + i->at + 2) | (PLANTED ? 0u : 1u);"},
    {InsnClass::kThumbException, "r14 of an undefined one has bit 0", "exceptions.cpp",
     "((cpsr_ & 0x20u) ? 2u : 4u)", "((cpsr_ & 0x20u) ? (PLANTED ? 3u : 2u) : 4u)"},
};
// clang-format on

}  // namespace fovea::cpu::test
