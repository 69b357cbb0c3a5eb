// A decoded instruction: ARM and Thumb in one form.
#pragma once
#include <cstdint>

namespace fovea::cpu {

enum class Op : std::uint8_t {
  // Data processing, in encoding order.
  kAnd, kEor, kSub, kRsb, kAdd, kAdc, kSbc, kRsc, kTst, kTeq, kCmp, kCmn, kOrr, kMov, kBic, kMvn,
  kMul, kMla, kUmull, kUmlal, kSmull, kSmlal,
  kSmulxy, kSmlaxy, kSmulwy, kSmlawy, kSmlalxy,
  kQadd, kQsub, kQdadd, kQdsub, kClz,
  kLdr, kLdrb, kStr, kStrb, kLdrh, kLdrsb, kLdrsh, kStrh, kLdrd, kStrd,
  kLdm, kStm, kSwp, kSwpb, kPld,
  kB, kBl, kBxReg, kBlxReg, kBlxImm, kThumbBlPrefix, kThumbBlSuffix,
  kMrs, kMsr, kSwi, kBkpt, kMcr, kMrc, kCoprocessor, kUndefined,
};

/// How the second operand or the offset is formed.
enum class Operand : std::uint8_t { kImm, kReg, kShiftImm, kShiftReg };

enum InsnFlags : std::uint16_t {
  kSetFlags = 1 << 0,
  kPre = 1 << 1,        // memory: pre-indexed
  kUp = 1 << 2,
  kWriteBack = 1 << 3,
  kUserBank = 1 << 4,   // LDRT/STRT, LDM^/STM^
  kReadsPc = 1 << 5,    // r15 must hold the pipeline value
  kThumbInsn = 1 << 6,
  kSpsr = 1 << 7,       // MRS/MSR of SPSR
  kTop1 = 1 << 8,       // x of SMULxy
  kTop2 = 1 << 9,       // y
  kAlignPc = 1 << 10,   // Thumb literal: pc & ~3
  kImmCarry = 1 << 11,  // rotated immediate gives the carry
  kUnpredictable = 1 << 12,
};

class Core;
struct Instruction;
/// Executes a record that starts at a core clock and goes on with the next one. @return the record
/// to go on with (build without tail calls), nullptr: the core's state is settled, run() decides
using Handler = const Instruction* (*)(Core&, const Instruction*, std::uint64_t cycle);

/// The decoder fills all but handler, body and at; Core::prepare() fills those, and rewrites
/// offsets and shift amounts into the form that the handlers expect.
struct Instruction {
  Handler handler = nullptr;  // condition and interlock where there are any, then body
  Handler body = nullptr;     // nullptr: not entered yet
  Op op = Op::kUndefined;
  std::uint8_t cond = 14;
  Operand operand = Operand::kImm;
  std::uint8_t shift = 0;   // 0 LSL 1 LSR 2 ASR 3 ROR
  std::uint8_t rd = 0, rn = 0, rm = 0, rs = 0;
  std::uint16_t flags = 0;
  std::uint16_t sources = 0;  // registers read as operands or address
  std::uint16_t stored = 0;   // registers read as store data or accumulator (port C)
  std::uint8_t amount = 0;    // immediate shift
  std::uint8_t at = 0;        // offset in its line
  std::uint32_t imm = 0;      // immediate, offset, register list, branch offset
  std::uint32_t raw = 0;
};
static_assert(sizeof(Instruction) == 40);

Instruction decode_arm(std::uint32_t word);
Instruction decode_thumb(std::uint16_t half);

}  // namespace fovea::cpu
