// A decoded instruction ("record"): ARM and Thumb in one form.
#pragma once
#include <cstdint>

namespace fovea::cpu {

enum class Op : std::uint8_t {
  // Data processing, in the order of the encoding.
  kAnd, kEor, kSub, kRsb, kAdd, kAdc, kSbc, kRsc, kTst, kTeq, kCmp, kCmn, kOrr, kMov, kBic, kMvn,
  kMul, kMla, kUmull, kUmlal, kSmull, kSmlal,
  kSmulxy, kSmlaxy, kSmulwy, kSmlawy, kSmlalxy,
  kQadd, kQsub, kQdadd, kQdsub, kClz,
  kLdr, kLdrb, kStr, kStrb, kLdrh, kLdrsb, kLdrsh, kStrh, kLdrd, kStrd,
  kLdm, kStm, kSwp, kSwpb, kPld,
  kB, kBl, kBxReg, kBlxReg, kBlxImm, kThumbBlPrefix, kThumbBlSuffix,
  kMrs, kMsr, kSwi, kBkpt, kMcr, kMrc, kCoprocessor, kUndefined,
};

constexpr bool is_data_processing(Op op) {
  switch (op) {
    case Op::kAnd: case Op::kEor: case Op::kSub: case Op::kRsb: case Op::kAdd: case Op::kAdc: case Op::kSbc:
    case Op::kRsc: case Op::kTst: case Op::kTeq: case Op::kCmp: case Op::kCmn: case Op::kOrr: case Op::kMov:
    case Op::kBic: case Op::kMvn:
      return true;
    default: return false;
  }
}
/// Multiplications with and without accumulation, the halfword ones included.
constexpr bool is_multiplication(Op op) {
  switch (op) {
    case Op::kMul: case Op::kMla: case Op::kUmull: case Op::kUmlal: case Op::kSmull: case Op::kSmlal:
    case Op::kSmulxy: case Op::kSmlaxy: case Op::kSmulwy: case Op::kSmlawy: case Op::kSmlalxy:
      return true;
    default: return false;
  }
}
/// What has a result and neither moves data nor changes the flow.
constexpr bool calculates(Op op) {
  return is_data_processing(op) || is_multiplication(op) || op == Op::kQadd || op == Op::kQsub || op == Op::kQdadd ||
         op == Op::kQdsub || op == Op::kClz;
}
/// Loads, stores and swaps; not PLD.
constexpr bool accesses_data(Op op) {
  switch (op) {
    case Op::kLdr: case Op::kLdrb: case Op::kStr: case Op::kStrb: case Op::kLdrh: case Op::kLdrsb: case Op::kLdrsh:
    case Op::kStrh: case Op::kLdrd: case Op::kStrd: case Op::kLdm: case Op::kStm: case Op::kSwp: case Op::kSwpb:
      return true;
    default: return false;
  }
}

/// How the second operand or the offset is formed.
enum class Operand : std::uint8_t { kImm, kReg, kShiftImm, kShiftReg };

enum InsnFlags : std::uint16_t {
  kSetFlags = 1 << 0,
  kPre = 1 << 1,        // memory: pre-indexed
  kUp = 1 << 2,
  kWriteBack = 1 << 3,
  kUserBank = 1 << 4,   // LDRT/STRT, LDM^/STM^
  kReadsPc = 1 << 5,    // r15 must hold the address of the instruction plus the pipeline's offset
  kThumbInsn = 1 << 6,
  kSpsr = 1 << 7,       // MRS/MSR of SPSR
  kTop1 = 1 << 8,       // x of SMULxy
  kTop2 = 1 << 9,       // y
  kAlignPc = 1 << 10,   // Thumb literal: the base is pc & ~3
  kImmCarry = 1 << 11,  // a rotated immediate sets the carry flag
  kUnpredictable = 1 << 12,
  kAway = 1 << 13,      // prepared records: a branch to another function, for a profile
};

class Core;
struct Instruction;
/// Executes a record that starts at a core clock and continues with the next one. @return the
/// record to continue with (builds without tail calls), or nullptr: the core's state is settled,
/// and run() decides how to continue
using Handler = const Instruction* (*)(Core&, const Instruction*, std::uint64_t cycle);

/// The decoder sets all members except handler, body and at. Core::prepare() sets these and
/// converts offsets and shift distances into the form that the handlers expect.
struct Instruction {
  Handler handler = nullptr;  // checks the condition and waits for operands if needed, then calls
                              // body
  Handler body = nullptr;     // nullptr: not prepared yet
  Op op = Op::kUndefined;
  std::uint8_t cond = 14;
  Operand operand = Operand::kImm;
  std::uint8_t shift = 0;   // 0 LSL 1 LSR 2 ASR 3 ROR
  std::uint8_t rd = 0, rn = 0, rm = 0, rs = 0;
  std::uint16_t flags = 0;
  std::uint16_t sources = 0;  // registers read as operands or address
  std::uint16_t stored = 0;   // registers read as store data or accumulator (port C)
  std::uint8_t amount = 0;    // distance of an immediate shift
  std::uint8_t at = 0;        // offset of the instruction in its line, in bytes
  std::uint32_t imm = 0;      // immediate, offset, register list, branch offset
  std::uint32_t raw = 0;
};
static_assert(sizeof(Instruction) == 40);

Instruction decode_arm(std::uint32_t word);
Instruction decode_thumb(std::uint16_t half);

}  // namespace fovea::cpu
