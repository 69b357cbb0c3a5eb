// Decodes instruction words into records with the table of instructions. A Thumb instruction
// becomes the record of its ARM equivalent.
#include <array>
#include <bit>
#include <string_view>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "model/cpu/core/instruction.h"
#include "model/cpu/core/isa.h"

namespace fovea::cpu {
namespace {

/// The numbers that make up a record.
enum Slot : std::uint8_t { kD, kN, kM, kS, kShift, kAmount, kNumber, kRotate, kCond, kSlots };

constexpr std::uint8_t kNoSlot = kSlots;
constexpr std::uint8_t slot_of(char letter) {
  switch (letter) {
    case 'd':
    case 'e': return kD;
    case 'n': return kN;
    case 'm': return kM;
    // The slot of the third register also holds a coprocessor's number and the mask of MSR.
    case 's':
    case 'p':
    case 'f': return kS;
    case 't': return kShift;
    case 'a': return kAmount;
    case 'i':
    case 'l': return kNumber;
    case 'r': return kRotate;
    case 'c': return kCond;
    default: return kNoSlot;
  }
}

/// A row prepared for decoding: what its words have in common, and where their fields are.
struct Plan {
  struct Take {
    std::uint8_t slot, from, width;
  };
  struct Flag {
    std::uint8_t from;
    std::uint16_t flag;
  };
  struct Copy {
    std::uint8_t to, from;
  };
  template <typename T, unsigned kMost>
  struct List {
    std::array<T, kMost> at{};
    unsigned count = 0;
    void add(const T& t) {
      FOVEA_CHECK(count < kMost, "table of instructions: too many fields");
      at[count++] = t;
    }
    bool empty() const { return count == 0; }
    const T* begin() const { return at.data(); }
    const T* end() const { return at.data() + count; }
  };
  Instruction base;
  std::array<std::uint32_t, kSlots> numbers{};
  List<Take, 8> takes;
  List<Flag, 6> flags;
  List<Copy, 2> copies;
  List<std::uint8_t, 3> sources, stored;
  Immediate immediate = Immediate::kNone;
  unsigned scale = 0, unused = 0;  ///< of a signed number: unused bits above it
  std::uint16_t also = 0;
  bool pair = false, stores_list = false, thumb_ldm = false;
  bool always_defined = false;
};

Plan make_plan(int at) {
  const IsaRow& row = isa_rows()[static_cast<std::size_t>(at)];
  Plan p;
  p.base.op = row.op;
  p.base.operand = row.kind.operand;
  p.base.flags = static_cast<std::uint16_t>(row.flags | row.kind.flags |
                                            (row.thumb() ? kThumbInsn : 0));
  p.numbers[kCond] = 14;
  unsigned number_bits = 0;
  for (const IsaPiece& piece : isa_pieces(at)) {
    constexpr std::pair<char, std::uint16_t> kFlags[] = {{'S', kSetFlags}, {'P', kPre}, {'U', kUp},
                                                         {'W', kWriteBack}, {'x', kTop1},
                                                         {'y', kTop2}};
    for (const auto& [letter, flag] : kFlags)
      if (piece.letter == letter) p.flags.add({piece.from, flag});
    const std::uint8_t slot = slot_of(piece.letter);
    if (slot == kNoSlot) continue;
    if (slot == kCond) p.numbers[kCond] = 0;
    if (slot == kNumber) number_bits += piece.width;
    p.takes.add({slot, piece.from, piece.width});
  }
  for (const IsaImplied& i : isa_implied(at)) {
    if (i.from) p.copies.add({slot_of(i.letter), slot_of(i.from)});
    else p.numbers[slot_of(i.letter)] = i.number;
  }
  for (const char letter : std::string_view(row.kind.reads))
    if (isa_has(at, letter)) p.sources.add(slot_of(letter));
  for (const char letter : std::string_view(row.kind.stored)) {
    if (letter == 'l') p.stores_list = true;
    else if (isa_has(at, letter)) p.stored.add(slot_of(letter));
  }
  p.immediate = row.kind.immediate;
  p.scale = row.scale;
  p.unused = 32 - number_bits;
  p.also = row.also;
  p.pair = isa_has(at, 'e');
  p.thumb_ldm = row.thumb() && row.op == Op::kLdm;
  p.always_defined = isa_always_defined(at);
  return p;
}

const Plan& plan(int row) {
  static const std::vector<Plan> plans = [] {
    std::vector<Plan> out;
    for (int k = 0; k < static_cast<int>(isa_rows().size()); ++k) out.push_back(make_plan(k));
    return out;
  }();
  return plans[static_cast<std::size_t>(row)];
}

/// Bit H of a BLX in ARM state: half of a word, added to the offset.
constexpr std::uint32_t kBlxHalf = 1u << 24;

Instruction decode(std::uint32_t w, bool thumb) {
  const int row = isa_row(w, thumb);
  if (row == kNoRow) {
    Instruction i;
    i.raw = w;
    if (thumb) i.flags = kThumbInsn;
    else if (w >> 28 != 15) i.cond = static_cast<std::uint8_t>(w >> 28);
    return i;
  }
  const Plan& p = plan(row);
  Instruction i = p.base;
  i.raw = w;
  std::array<std::uint32_t, kSlots> v = p.numbers;
  for (const Plan::Take& t : p.takes)
    v[t.slot] = v[t.slot] << t.width | (w >> t.from & ((1u << t.width) - 1u));
  for (const Plan::Copy& c : p.copies) v[c.to] = v[c.from];
  if (p.pair) v[kD] *= 2;
  i.cond = static_cast<std::uint8_t>(v[kCond]);
  i.rd = static_cast<std::uint8_t>(v[kD]);
  i.rn = static_cast<std::uint8_t>(v[kN]);
  i.rm = static_cast<std::uint8_t>(v[kM]);
  i.rs = static_cast<std::uint8_t>(v[kS]);
  i.shift = static_cast<std::uint8_t>(v[kShift]);
  i.amount = static_cast<std::uint8_t>(v[kAmount]);
  if (i.operand == Operand::kShiftImm && i.amount == 0 && i.shift == 0) i.operand = Operand::kReg;
  std::uint32_t flags = i.flags;
  for (const Plan::Flag& f : p.flags)
    if (w >> f.from & 1u) flags |= f.flag;
  switch (p.immediate) {
    case Immediate::kNone: break;
    case Immediate::kUnsigned: i.imm = v[kNumber] << p.scale; break;
    case Immediate::kRotated:
      i.imm = std::rotr(v[kNumber], static_cast<int>(2 * v[kRotate]));
      if (is_data_processing(i.op) && v[kRotate]) flags |= kImmCarry;
      break;
    case Immediate::kList:
      i.imm = v[kNumber] | p.also;
      // Only the first register of a store multiple can delay it; the others are read later.
      if (p.stores_list && i.imm) i.stored = static_cast<std::uint16_t>(i.imm & (0u - i.imm));
      if (p.stores_list && (i.imm & 0x8000u)) flags |= kReadsPc;
      // A Thumb LDMIA whose list contains the base has no write-back.
      if (p.thumb_ldm && i.imm >> i.rn & 1u) flags &= ~std::uint32_t{kWriteBack};
      break;
    case Immediate::kSigned:
      i.imm = static_cast<std::uint32_t>(static_cast<std::int32_t>(v[kNumber] << p.unused) >>
                                         p.unused) << p.scale;
      if (i.op == Op::kBlxImm && (w & kBlxHalf)) i.imm += 2;
      break;
  }
  std::uint32_t sources = 0, stored = i.stored;
  for (const std::uint8_t slot : p.sources) sources |= 1u << v[slot];
  for (const std::uint8_t slot : p.stored) stored |= 1u << v[slot];
  // The second word of STRD is read later, like those of STM.
  const std::uint32_t second = p.pair && !p.stored.empty() ? 2u << v[kD] : 0u;
  if ((sources | stored | second) & 0x8000u) flags |= kReadsPc;
  if (!p.always_defined && !isa_defined(row, w)) flags |= kUnpredictable;
  i.sources = static_cast<std::uint16_t>(sources);
  i.stored = static_cast<std::uint16_t>(stored);
  i.flags = static_cast<std::uint16_t>(flags);
  return i;
}

}  // namespace

Instruction decode_arm(std::uint32_t word) { return decode(word, false); }
Instruction decode_thumb(std::uint16_t half) { return decode(half, true); }

}  // namespace fovea::cpu
