// Which addresses a load, store or swap uses (ARM DDI 0100, A5.2 to A5.4): the definition for execution, for the
// fast handlers of blocks and for watchpoints. Those of single registers have a specialised one, moved().
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "model/cpu/core/instruction.h"
#include "model/cpu/core/shifter.h"

namespace fovea::cpu {

constexpr bool is_store(Op op) {
  return op == Op::kStr || op == Op::kStrb || op == Op::kStrh || op == Op::kStrd || op == Op::kStm;
}
constexpr bool is_swap(Op op) { return op == Op::kSwp || op == Op::kSwpb; }
constexpr bool is_block(Op op) { return op == Op::kLdm || op == Op::kStm; }
/// Bytes of a load, store or swap of one register or a pair.
constexpr unsigned access_bytes(Op op) {
  switch (op) {
    case Op::kLdrb: case Op::kLdrsb: case Op::kStrb: case Op::kSwpb: return 1;
    case Op::kLdrh: case Op::kLdrsh: case Op::kStrh: return 2;
    case Op::kLdrd: case Op::kStrd: return 8;
    default: return 4;
  }
}

/// LDM and STM: where the words lie and where the base moves, in words relative to the base.
struct BlockShape {
  int words = 0;  ///< registers in the list
  int first = 0;  ///< the lowest word
  int moved = 0;  ///< the base after write-back
};
constexpr BlockShape block_shape(std::uint32_t list, bool up, bool pre) {
  const int n = std::popcount(list & 0xFFFFu);
  if (n == 0) return {0, 0, up ? 16 : -16};  // empty list (isa_reactions.cpp)
  return {n, up ? (pre ? 1 : 0) : (pre ? -n : 1 - n), up ? n : -n};
}

/// Offset of a load or store; no such instruction shifts by a register.
inline std::uint32_t address_offset(const Instruction& decoded,
                                    const std::array<std::uint32_t, 16>& r, bool carry) {
  if (decoded.operand == Operand::kImm) return decoded.imm;
  Instruction i = decoded;
  switch (form_of(i)) {
    case Form::kReg: return r[i.rm];
    case Form::kLsl: return shifted<Form::kLsl>(r[i.rm], i.amount, carry);
    case Form::kLsr: return shifted<Form::kLsr>(r[i.rm], i.amount, carry);
    case Form::kAsr: return shifted<Form::kAsr>(r[i.rm], i.amount, carry);
    case Form::kRor: return shifted<Form::kRor>(r[i.rm], i.amount, carry);
    default: return shifted<Form::kRrx>(r[i.rm], i.amount, carry);
  }
}

/// r15 as an instruction at `pc` reads it.
constexpr std::uint32_t pc_ahead(const Instruction& i, std::uint32_t pc) {
  return (pc + ((i.flags & kThumbInsn) ? 4u : 8u)) & ((i.flags & kAlignPc) ? ~3u : ~0u);
}

struct DataAddress {
  std::uint32_t first = 0;  ///< as computed; its low bits may not fit the width
  std::uint32_t moved = 0;  ///< the base register after write-back
  std::uint32_t bytes = 0;
  /// The first byte that is accessed: the low bits of an unaligned address only rotate the value.
  std::uint32_t touched() const { return first & ~(std::min(bytes, 4u) - 1); }
};

/// @param r the registers as the instruction reads them, with r15 ahead of it
inline DataAddress data_address(const Instruction& i, const std::array<std::uint32_t, 16>& r,
                                bool carry) {
  const std::uint32_t base = r[i.rn];
  const bool up = i.flags & kUp, pre = i.flags & kPre;
  if (is_block(i.op)) {
    const BlockShape b = block_shape(i.imm, up, pre);
    return {base + 4u * static_cast<std::uint32_t>(b.first),
            base + 4u * static_cast<std::uint32_t>(b.moved),
            4u * static_cast<std::uint32_t>(b.words)};
  }
  if (is_swap(i.op)) return {base, base, access_bytes(i.op)};
  const std::uint32_t by = address_offset(i, r, carry);
  const std::uint32_t moved = up ? base + by : base - by;
  return {pre ? moved : base, moved, access_bytes(i.op)};
}

}  // namespace fovea::cpu
