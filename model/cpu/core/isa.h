// The instructions of ARMv5TE as the ARM926EJ-S executes them, one row each, ARM and Thumb. The
// decoder, the disassembler, INSTRUCTIONS.md and the random programs of the tests are derived from
// these rows.
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

/// How the immediate of a record is formed from field `i` (kList: from the register list `l`).
enum class Immediate : std::uint8_t {
  kNone,
  kUnsigned,  ///< shifted left by `scale`
  kSigned,    ///< sign extended, then shifted
  kRotated,   ///< 8 bits rotated right by twice the value of field `r`
  kList       ///< register list, with the bits of `also`
};

/// What all rows of one form have in common. Operands are named by letters of the pattern; a letter
/// that the pattern of a row lacks is ignored for that row.
struct IsaKind {
  InsnClass insn_class;
  const char* reads;       ///< registers read as operands or address
  const char* stored;      ///< registers read one clock later: store data, accumulators; l: the
                           ///< first of the list
  const char* writes;      ///< registers written, except the base of a write-back
  const char* defined_if;  ///< otherwise UNPREDICTABLE; clauses "a != b", "W: a != b" (only if
                           ///< field W is 1)
  const char* cycles;      ///< issue clocks when everything hits; "then": further clocks until the
                           ///< result is usable
  const char* source;      ///< source of `cycles`
  Operand operand = Operand::kImm;
  Immediate immediate = Immediate::kNone;
  std::uint16_t flags = 0;
};

/// One instruction. The pattern is read from the top bit down. 0 and 1 are fixed bits, `-` should
/// be zero and `+` should be one (both are ignored), and letters are fields:
///   c condition  S sets flags  n d m s registers  e Rd / 2  a shift distance  t type of shift
///   r i immediate  l register list  P U W indexing  f PSR fields  x y halves of SMULxy
///   h halfword bit of BLX  k number for software  p o q C D M L of coprocessor instructions
/// In ARM state, n is bits 19:16 and d is bits 15:12, as in the record, so that the result of a
/// multiply is n.
struct IsaRow {
  const char* name;
  const char* pattern;
  const char* syntax;  ///< text of the disassembler (disassemble.h)
  Op op;
  const IsaKind& kind;
  std::uint16_t flags = 0;    ///< in addition to those of the kind
  const char* implied = "";   ///< operands without a field of their own: "n=13 d=n"
  std::uint8_t scale = 0;
  std::uint16_t also = 0;     ///< registers that are always in the list
  /// A Thumb pattern has four groups of four bits, an ARM pattern eight.
  constexpr bool thumb() const {
    unsigned n = 0;
    while (pattern[n]) ++n;
    return n < 20;
  }
};

/// All rows. If a word matches two rows, the first one applies: it is a special case of the later
/// one.
std::span<const IsaRow> isa_rows();

inline constexpr int kNoRow = -1;
/// The row of an instruction word (or of a Thumb halfword), or kNoRow for an undefined instruction.
int isa_row(std::uint32_t word, bool thumb);

/// A part of a field: `width` bits of the word from bit `from` on. The first part is the most
/// significant.
struct IsaPiece {
  char letter;
  std::uint8_t from, width;
};
std::span<const IsaPiece> isa_pieces(int row);
/// An operand without a field: the value of operand `from`, or `number` if `from` is 0.
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

/// The values of a word's fields by letter, including implied operands; field `e` sets `d` too.
class IsaFields {
 public:
  std::uint32_t operator[](char letter) const { return at_[letter & 63]; }
  std::uint32_t& operator[](char letter) { return at_[letter & 63]; }

 private:
  std::array<std::uint32_t, 64> at_{};
};
IsaFields isa_fields(int row, std::uint32_t word);
/// True if the row's pattern or its implied operands have this letter.
bool isa_has(int row, char letter);
/// The word with these fields. Bits that should be zero or one are so. Implied operands are
/// ignored.
std::uint32_t isa_encode(int row, const IsaFields& fields);
/// True if the architecture defines the result of the word: every clause of `defined_if` holds, and
/// all ignored bits are as they should be. False for kNoRow, which the functions above do not
/// accept.
bool isa_defined(int row, std::uint32_t word);
/// True if no word of the row is UNPREDICTABLE.
bool isa_always_defined(int row);

/// What the core does if a clause of `defined_if` is violated. Each such instruction whose
/// condition passes is counted and reported as a warning.
struct IsaReaction {
  const char* clause;   ///< as in the table, without "W: "
  const char* classes;  ///< names, separated by ", "
  const char* reaction;
};
std::span<const IsaReaction> isa_reactions();
/// The clauses of a row that concern operands which the row has.
std::vector<std::string> isa_clauses(int row);

}  // namespace fovea::cpu
