// Fills the syntax texts of the table. Their tokens are field letters in angle brackets, or:
//   shift pre offset reg mode target dflags  what follows from several fields.
#include "model/cpu/core/disassemble.h"

#include <bit>
#include <cstdio>
#include <string_view>

#include "model/cpu/core/isa.h"

namespace fovea::cpu {
namespace {

constexpr const char* kRegisters[] = {"r0", "r1", "r2", "r3", "r4", "r5", "r6", "r7",
                                      "r8", "r9", "sl", "fp", "ip", "sp", "lr", "pc"};
constexpr const char* kConditions[] = {"eq", "ne", "cs", "cc", "mi", "pl", "vs", "vc",
                                       "hi", "ls", "ge", "lt", "gt", "le", "", ""};
constexpr const char* kShifts[] = {"lsl", "lsr", "asr", "ror"};
constexpr const char* kModes[] = {"da", "ia", "db", "ib"};  // indexed by the bits P and U

std::string decimal(std::uint32_t v) { return std::to_string(static_cast<std::int32_t>(v)); }
std::string hex(const char* format, std::uint32_t v) {
  char text[24];
  std::snprintf(text, sizeof text, format, v);
  return text;
}

class Printer {
 public:
  Printer(const IsaRow& row, int at, std::uint32_t word, std::uint32_t pc)
      : row_(row), f_(isa_fields(at, word)), i_(row.thumb() ? decode_thumb(halfword(word))
                                                            : decode_arm(word)), pc_(pc) {}

  std::string text() const {
    std::string_view s = row_.syntax;
    if (row_.op == Op::kMov && !row_.thumb() && i_.operand == Operand::kShiftImm)
      s = rrx() ? "<t><S><c> <d>, <m>" : "<t><S><c> <d>, <m>, #<a>";
    if (row_.op == Op::kMov && !row_.thumb() && i_.operand == Operand::kShiftReg)
      s = "<t><S><c> <d>, <m>, <s>";
    if (row_.kind.insn_class == InsnClass::kBlock && i_.rn == 13 && f_['W'] &&
        !(i_.flags & kUserBank)) {
      const bool load = i_.op == Op::kLdm, pair = std::popcount(i_.imm) > 1;
      if (load && !f_['P'] && f_['U']) s = pair ? "pop<c> <l>" : "ldmfd<c> sp!, <l>";
      if (!load && f_['P'] && !f_['U']) s = pair ? "push<c> <l>" : "stmfd<c> sp!, <l>";
    }
    std::string out;
    while (!s.empty()) {
      const std::size_t open = s.find('<');
      out += s.substr(0, open);
      if (open == std::string_view::npos) break;
      const std::size_t close = s.find('>', open);
      out += token(s.substr(open + 1, close - open - 1));
      s.remove_prefix(close + 1);
    }
    return out;
  }

 private:
  static std::uint16_t halfword(std::uint32_t w) { return static_cast<std::uint16_t>(w); }
  bool rrx() const { return f_['t'] == 3 && f_['a'] == 0; }
  /// A distance of 0 means 32 for LSR and ASR.
  std::string distance() const {
    return std::to_string(f_['a'] == 0 && f_['t'] ? 32 : f_['a']);
  }
  std::string shift() const {
    if (i_.operand == Operand::kReg) return "";
    return rrx() ? ", rrx" : std::string(", ") + kShifts[f_['t']] + " #" + distance();
  }
  bool up() const { return i_.flags & kUp; }
  std::uint32_t offset_bytes() const { return f_['i'] << row_.scale; }
  std::string offset() const { return (up() ? "#" : "#-") + std::to_string(offset_bytes()); }

  std::string immediate() const {
    if (row_.kind.immediate != Immediate::kRotated) return decimal(i_.imm);
    // An assembler chooses the smallest rotation.
    for (unsigned r = 0; r < f_['r']; ++r)
      if (std::rotl(i_.imm, static_cast<int>(2 * r)) < 256)
        return std::to_string(f_['i']) + ", " + std::to_string(2 * f_['r']);
    return decimal(i_.imm);
  }

  /// objdump omits the default mode, except for a store with `!` or `^`.
  std::string mode() const {
    const std::uint32_t k = 2 * f_['P'] + f_['U'];
    const bool usual = i_.op == Op::kLdm || !(f_['W'] || (i_.flags & kUserBank));
    return k == 1 && usual ? "" : kModes[k];
  }

  std::string list() const {
    std::string out = "{";
    for (unsigned r = 0; r < 16; ++r)
      if (i_.imm >> r & 1u) out += (out.size() > 1 ? ", " : "") + std::string(kRegisters[r]);
    return out + "}";
  }

  std::string token(std::string_view t) const {
    if (t == "shift") return shift();
    if (t == "reg") return std::string(up() ? "" : "-") + kRegisters[i_.rm] + shift();
    if (t == "offset") return offset();
    if (t == "pre") return up() && !offset_bytes() && !f_['W'] ? "" : ", " + offset();
    if (t == "mode") return mode();
    if (t == "target") return hex("0x%x", pc_ + (row_.thumb() ? 4 : 8) + i_.imm);
    if (t == "dflags") return f_['d'] == 15 ? "APSR_nzcv" : kRegisters[f_['d']];
    const char letter = t[0];
    const std::uint32_t v = f_[letter];
    switch (letter) {
      case 'c': return kConditions[v];
      case 'S': return v ? "s" : "";
      case 'W': return i_.flags & kWriteBack ? "!" : "";
      case 'L': return v ? "l" : "";
      case 'x':
      case 'y': return v ? "t" : "b";
      case 't': return rrx() && i_.operand == Operand::kShiftImm ? "rrx" : kShifts[v];
      case 'a': return distance();
      case 'i': return immediate();
      case 'l': return list();
      case 'f': {
        std::string out;
        constexpr std::pair<unsigned, char> kFields[] = {{3, 'f'}, {2, 's'}, {1, 'x'}, {0, 'c'}};
        for (const auto& [bit, name] : kFields)
          if (v >> bit & 1u) out += name;
        return out;
      }
      case 'C':
      case 'D':
      case 'M': return "cr" + std::to_string(v);
      case 'k':
      case 'o':
      case 'p':
      case 'q': return std::to_string(v);
      default: return kRegisters[v];
    }
  }

  const IsaRow& row_;
  const IsaFields f_;
  const Instruction i_;
  const std::uint32_t pc_;
};

std::string thumb_pair(std::uint32_t word, std::uint32_t pc) {
  const Instruction first = decode_thumb(static_cast<std::uint16_t>(word)),
                    second = decode_thumb(static_cast<std::uint16_t>(word >> 16));
  const bool exchange = second.flags & kSpsr;
  const std::uint32_t target = pc + 4 + first.imm + second.imm;
  return (exchange ? "blx " : "bl ") + hex("0x%x", exchange ? target & ~3u : target);
}

}  // namespace

std::string disassemble(std::uint32_t word, bool thumb, std::uint32_t pc) {
  const auto op_of = [](std::uint32_t half) {
    return decode_thumb(static_cast<std::uint16_t>(half)).op;
  };
  if (thumb && op_of(word) == Op::kThumbBlPrefix && op_of(word >> 16) == Op::kThumbBlSuffix)
    return thumb_pair(word, pc);
  if (thumb) word &= 0xFFFFu;
  const int at = isa_row(word, thumb);
  const std::string data = thumb ? hex(".short 0x%04x", word) : hex(".word 0x%08x", word);
  if (at == kNoRow) return data;
  const IsaRow& row = isa_rows()[static_cast<std::size_t>(at)];
  if (row.op == Op::kThumbBlPrefix || row.op == Op::kThumbBlSuffix) return data;
  return Printer(row, at, word, pc).text();
}

}  // namespace fovea::cpu
