// The instructions of ARMv5TE as the ARM926EJ-S executes them: one row each, ARM and Thumb.
// Decoder, disassembler, INSTRUCTIONS.md and the random programs of the tests read these rows.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "model/cpu/core/instruction.h"

namespace fovea::cpu {

enum class InsnClass : std::uint8_t {
  kData, kDataShiftReg, kCompare, kMultiply, kLongMultiply, kDsp, kSaturate, kClz, kStatus,
  kLoad, kStore, kNarrow, kDouble, kBlock, kSwap, kPreload, kBranch, kException, kCoprocessor,
  kThumbAlu, kThumbShift, kThumbMultiply, kThumbHigh, kThumbMemory, kThumbBlock, kThumbBranch,
  kThumbException, kCount
};
const char* class_name(InsnClass c);

/// How the immediate of the record comes from field `i` (or the register list from `l`).
enum class Immediate : std::uint8_t {
  kNone,
  kUnsigned,  ///< shifted left by `scale`
  kSigned,    ///< sign extended, then shifted
  kRotated,   ///< 8 bits turned right by twice field `r`
  kList       ///< register list, with the bits of `also`
};

/// What all rows of one form have in common. Operands are letters of the pattern; a letter that a
/// row's pattern lacks does not count for it.
struct IsaKind {
  InsnClass insn_class;
  const char* reads;       ///< registers read as operands or address
  const char* stored;      ///< registers read late: store data, accumulators; l: first of the list
  const char* writes;      ///< results, without the written-back base
  const char* defined_if;  ///< else UNPREDICTABLE: clauses "a != b", "W: a != b" (if field W is 1)
  const char* cycles;      ///< clocks of issue, everything hit; "then": before the result is usable
  const char* source;      ///< of the cycles
  Operand operand = Operand::kImm;
  Immediate immediate = Immediate::kNone;
  std::uint16_t flags = 0;
};

/// One instruction. The pattern is read from the top bit down: 0 and 1 are fixed, `-` should be
/// zero and `+` should be one (both ignored), letters are fields:
///   c condition  S sets flags  n d m s registers  e Rd / 2  a shift distance  t kind of shift
///   r i immediate  l register list  P U W indexing  f PSR fields  x y halves of SMULxy
///   h half of BLX  k number left to software  p o q C D M L of coprocessors
/// n is bits 19:16 and d bits 15:12 in ARM state, as in the record: the result of a multiply is n.
struct IsaRow {
  const char* name;
  const char* pattern;
  const char* syntax;  ///< text of the disassembler (disassemble.h)
  Op op;
  const IsaKind& kind;
  std::uint16_t flags = 0;    ///< besides the kind's
  const char* implied = "";   ///< operands without a field: "n=13 d=n"
  std::uint8_t scale = 0;
  std::uint16_t also = 0;     ///< registers always in the list
  /// Four groups of four make a Thumb pattern, eight an ARM one.
  constexpr bool thumb() const {
    unsigned n = 0;
    while (pattern[n]) ++n;
    return n < 20;
  }
};

/// All rows. Where a word fits two, the first counts: the earlier is a special case of the later.
std::span<const IsaRow> isa_rows();

inline constexpr int kNoRow = -1;
/// Row of an instruction word (or of a Thumb halfword); kNoRow: an undefined instruction.
int isa_row(std::uint32_t word, bool thumb);

/// Some bits of a field: `width` bits from bit `from` on, below those of the piece before.
struct IsaPiece {
  char letter;
  std::uint8_t from, width;
};
std::span<const IsaPiece> isa_pieces(int row);
/// An operand without a field: another one's value, or a number if `from` is 0.
struct IsaImplied {
  char letter, from;
  std::uint32_t number;
};
std::span<const IsaImplied> isa_implied(int row);

struct IsaBits {
  std::uint32_t mask = 0, value = 0;  ///< fixed bits
  std::uint32_t zeros = 0, ones = 0;  ///< should be zero, should be one
};
const IsaBits& isa_bits(int row);

/// Values of a word's fields by their letters, implied operands included; `e` gives `d` as well.
class IsaFields {
 public:
  std::uint32_t operator[](char letter) const { return at_[letter & 63]; }
  std::uint32_t& operator[](char letter) { return at_[letter & 63]; }

 private:
  std::array<std::uint32_t, 64> at_{};
};
IsaFields isa_fields(int row, std::uint32_t word);
/// The row's pattern or implied operands have this letter.
bool isa_has(int row, char letter);
/// The pattern with these fields; bits that should be zero or one are. Ignores implied operands.
std::uint32_t isa_encode(int row, const IsaFields& fields);
/// The word's row defines its result: no clause of `defined_if` is broken, no ignored bit is wrong.
/// False for kNoRow; the functions above want a row.
bool isa_defined(int row, std::uint32_t word);
/// No word of the row is UNPREDICTABLE.
bool isa_always_defined(int row);

/// What the core does where a clause of `defined_if` is broken. Each such instruction that passes its
/// condition is counted and warned of.
struct IsaReaction {
  const char* clause;   ///< as in the table, without "W: "
  const char* classes;  ///< names, separated by ", "
  const char* reaction;
};
std::span<const IsaReaction> isa_reactions();
/// Clauses of a row whose operands it has.
std::vector<std::string> isa_clauses(int row);

}  // namespace fovea::cpu
