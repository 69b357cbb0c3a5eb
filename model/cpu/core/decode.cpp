// From instruction words to records, by the table of instructions. A Thumb instruction becomes the
// record of its ARM equivalent.
#include <bit>

#include "model/cpu/core/instruction.h"
#include "model/cpu/core/isa.h"

namespace fovea::cpu {
namespace {

/// Registers of the operands named by `letters`.
std::uint16_t registers(const char* letters, int row, const IsaFields& f, const Instruction& i) {
  std::uint32_t out = 0;
  for (; *letters; ++letters) {
    if (*letters == 'l') {
      // Only the first register of a store can be waited for: the others are read later.
      if (i.imm) out |= 1u << std::countr_zero(i.imm);
    } else if (isa_has(row, *letters)) {
      out |= 1u << f[*letters];
      if (isa_has(row, 'e') && *letters == 'd') out |= 2u << f['d'];
    }
  }
  return static_cast<std::uint16_t>(out);
}

std::uint32_t immediate(const IsaRow& row, int at, const IsaFields& f) {
  switch (row.kind.immediate) {
    case Immediate::kUnsigned: return f['i'] << row.scale;
    case Immediate::kRotated: return std::rotr(f['i'], static_cast<int>(2 * f['r']));
    case Immediate::kList: return f['l'] | row.also;
    case Immediate::kSigned: {
      const int unused = row.thumb() ? (isa_has(at, 'c') ? 24 : 21) : 8;
      const auto v = static_cast<std::int32_t>(f['i'] << unused) >> unused;
      return (static_cast<std::uint32_t>(v) << row.scale) + 2 * f['h'];
    }
    default: return 0;
  }
}

Instruction decode(std::uint32_t w, bool thumb) {
  Instruction i;
  i.raw = w;
  if (!thumb && w >> 28 != 15) i.cond = static_cast<std::uint8_t>(w >> 28);
  if (thumb) i.flags = kThumbInsn;
  const int at = isa_row(w, thumb);
  if (at == kNoRow) return i;
  const IsaRow& row = isa_rows()[static_cast<std::size_t>(at)];
  const IsaFields f = isa_fields(at, w);
  const auto byte = [&f](char letter) { return static_cast<std::uint8_t>(f[letter]); };
  i.op = row.op;
  if (thumb && isa_has(at, 'c')) i.cond = byte('c');
  i.rd = byte('d');
  i.rn = byte('n');
  i.rm = byte('m');
  // The place of the third register also holds a coprocessor's number and the mask of MSR.
  i.rs = static_cast<std::uint8_t>(f['s'] | f['p'] | f['f']);
  i.shift = byte('t');
  i.amount = byte('a');
  i.imm = immediate(row, at, f);
  i.operand = row.kind.operand;
  if (i.operand == Operand::kShiftImm && i.amount == 0 && i.shift == 0) i.operand = Operand::kReg;
  std::uint32_t flags = i.flags | row.flags | row.kind.flags;
  constexpr std::pair<char, std::uint16_t> kFlagFields[] = {
      {'S', kSetFlags}, {'P', kPre}, {'U', kUp}, {'W', kWriteBack}, {'x', kTop1}, {'y', kTop2}};
  for (const auto& [letter, flag] : kFlagFields)
    if (f[letter]) flags |= flag;
  if (i.op <= Op::kMvn && f['r']) flags |= kImmCarry;
  i.sources = registers(row.kind.reads, at, f, i);
  i.stored = registers(row.kind.stored, at, f, i);
  if ((i.sources | i.stored) & 0x8000u) flags |= kReadsPc;
  if (i.op == Op::kStm && (i.imm & 0x8000u)) flags |= kReadsPc;
  // A Thumb LDMIA with the base in the list has no write-back.
  if (thumb && i.op == Op::kLdm && i.imm >> i.rn & 1u) flags &= ~std::uint32_t{kWriteBack};
  i.flags = static_cast<std::uint16_t>(flags);
  return i;
}

}  // namespace

Instruction decode_arm(std::uint32_t word) { return decode(word, false); }
Instruction decode_thumb(std::uint16_t half) { return decode(half, true); }

}  // namespace fovea::cpu
