// Parses the patterns of the table once, and finds the row of an instruction word.
#include <bit>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/check.h"
#include "model/cpu/core/isa.h"

namespace fovea::cpu {
namespace {

/// A parsed clause: "a != b", "a = b", "a not in l", "a first in l" (if in the list at all), or "a
/// or b > number", with an optional prefix "W:".
struct Clause {
  enum class Relation { kDiffers, kEquals, kNotIn, kFirst, kAbove } relation = Relation::kDiffers;
  bool guarded = false;
  char a = 0, b = 0;           ///< b is 0 if the operand is a number
  std::uint32_t number = 0;    ///< the number, or a number added to b
};

struct Form {
  IsaBits bits;
  std::vector<IsaPiece> pieces;
  std::vector<IsaImplied> implied;
  std::vector<Clause> clauses;
  std::vector<std::string> texts;  // texts of the clauses
  std::uint64_t letters = 0;
};

std::uint64_t letter_bit(char c) { return std::uint64_t{1} << (c & 63); }

std::vector<std::string> split(std::string_view text, std::string_view by) {
  std::vector<std::string> out;
  while (!text.empty()) {
    const std::size_t at = text.find(by);
    if (at != 0) out.emplace_back(text.substr(0, at));
    if (at == std::string_view::npos) break;
    text.remove_prefix(at + by.size());
  }
  return out;
}

std::uint32_t number_of(const std::string& s) {
  FOVEA_CHECK(!s.empty() && s.find_first_not_of("0123456789") == std::string::npos,
              "table of instructions: number expected, not " + s);
  return static_cast<std::uint32_t>(std::stoul(s));
}

Clause parse_clause(const std::string& text) {
  Clause c;
  std::vector<std::string> w = split(text, " ");
  if (!w.empty() && w[0] == "W:") {
    c.guarded = true;
    w.erase(w.begin());
  }
  const bool above = w.size() == 5 && w[1] == "or" && w[3] == ">";
  const bool not_in = w.size() == 4 && w[1] == "not" && w[2] == "in" && w[3] == "l";
  const bool first = w.size() == 4 && w[1] == "first" && w[2] == "in" && w[3] == "l";
  FOVEA_CHECK(above || not_in || first || (w.size() == 3 && (w[1] == "!=" || w[1] == "=")),
              "table of instructions: cannot read " + text);
  c.a = w[0][0];
  if (above) {
    c.relation = Clause::Relation::kAbove;
    c.b = w[2][0];
    c.number = number_of(w[4]);
  } else if (not_in) {
    c.relation = Clause::Relation::kNotIn;
  } else if (first) {
    c.relation = Clause::Relation::kFirst;
  } else {
    c.relation = w[1] == "=" ? Clause::Relation::kEquals : Clause::Relation::kDiffers;
    if (w[2] == "d+1") {
      c.b = 'd';
      c.number = 1;
    } else if (w[2][0] >= 'a') {
      c.b = w[2][0];
    } else {
      c.number = number_of(w[2]);
    }
  }
  return c;
}

Form parse(const IsaRow& row) {
  Form f;
  std::string bits;
  for (const char* p = row.pattern; *p; ++p)
    if (*p != ' ') bits += *p;
  FOVEA_CHECK(bits.size() == (row.thumb() ? 16u : 32u),
              std::string("table of instructions: length of pattern of ") + row.name);
  for (std::size_t k = 0; k < bits.size(); ++k) {
    const auto at = static_cast<std::uint8_t>(bits.size() - 1 - k);
    const std::uint32_t bit = 1u << at;
    const char c = bits[k];
    if (c == '0' || c == '1') {
      f.bits.mask |= bit;
      if (c == '1') f.bits.value |= bit;
    } else if (c == '-') {
      f.bits.zeros |= bit;
    } else if (c == '+') {
      f.bits.ones |= bit;
    } else if (!f.pieces.empty() && f.pieces.back().letter == c && f.pieces.back().from == at + 1) {
      f.pieces.back().from = at;
      ++f.pieces.back().width;
    } else {
      f.pieces.push_back({c, at, 1});
    }
  }
  for (const IsaPiece& p : f.pieces) f.letters |= letter_bit(p.letter);
  if (f.letters & letter_bit('e')) f.letters |= letter_bit('d');
  for (const std::string& s : split(row.implied, " ")) {
    FOVEA_CHECK(s.size() > 2 && s[1] == '=', "table of instructions: cannot read " + s);
    const bool letter = s[2] >= 'a';
    f.implied.push_back({s[0], letter ? s[2] : '\0', letter ? 0 : number_of(s.substr(2))});
    f.letters |= letter_bit(s[0]);
  }
  for (const std::string& s : split(row.kind.defined_if, ", ")) {
    const Clause c = parse_clause(s);
    // Skip clauses about operands that the row does not have.
    if (!(f.letters & letter_bit(c.a)) || (c.b && !(f.letters & letter_bit(c.b)))) continue;
    f.clauses.push_back(c);
    f.texts.push_back(s);
  }
  return f;
}

/// Lists of candidate rows, indexed by the most significant bits for this purpose: 27:20 and 7:4 of
/// an ARM word (with and without a condition), 15:6 of a Thumb halfword.
class Lookup {
 public:
  Lookup() {
    std::vector<std::uint16_t> thumb, conditional, never;  // rows; the last are ARM words with 1111 in front
    for (const IsaRow& r : isa_rows()) {
      forms.push_back(parse(r));
      auto& rows = r.thumb() ? thumb : forms.back().bits.mask >> 28 == 15 ? never : conditional;
      rows.push_back(static_cast<std::uint16_t>(forms.size() - 1));
    }
    for (std::uint32_t key = 0; key < 1024; ++key) list(thumb, key << 6, 0xFFC0u);
    for (const auto* rows : {&conditional, &never})
      for (std::uint32_t key = 0; key < 4096; ++key)
        list(*rows, (key >> 4 & 0xFFu) << 20 | (key & 15u) << 4, 0x0FF000F0u);
    first.push_back(static_cast<std::uint32_t>(candidates.size()));
  }
  int find(std::uint32_t w, bool thumb) const {
    const std::uint32_t key =
        thumb ? (w & 0xFFFFu) >> 6
              : 1024 + (w >> 28 == 15 ? 4096 : 0) + ((w >> 16 & 0xFF0u) | (w >> 4 & 15u));
    for (std::uint32_t k = first[key]; k < first[key + 1]; ++k) {
      const IsaBits& b = forms[candidates[k]].bits;
      if ((w & b.mask) == b.value) return candidates[k];
    }
    return kNoRow;
  }
  std::vector<Form> forms;

 private:
  /// Lists those of the rows that a word with these key bits can match.
  void list(const std::vector<std::uint16_t>& rows, std::uint32_t word, std::uint32_t key_bits) {
    first.push_back(static_cast<std::uint32_t>(candidates.size()));
    for (const std::uint16_t k : rows)
      if (((word ^ forms[k].bits.value) & forms[k].bits.mask & key_bits) == 0) candidates.push_back(k);
  }
  std::vector<std::uint32_t> first;
  std::vector<std::uint16_t> candidates;
};

const Lookup& lookup() {
  static const Lookup instance;
  return instance;
}
const Form& form(int row) { return lookup().forms[static_cast<std::size_t>(row)]; }

bool holds(const Clause& c, const IsaFields& f) {
  if (c.guarded && !f['W']) return true;
  const std::uint32_t b = (c.b ? f[c.b] : 0) + c.number;
  switch (c.relation) {
    case Clause::Relation::kDiffers: return f[c.a] != b;
    case Clause::Relation::kEquals: return f[c.a] == b;
    case Clause::Relation::kNotIn: return !(f['l'] >> f[c.a] & 1u);
    case Clause::Relation::kFirst:
      return !(f['l'] >> f[c.a] & 1u) || (f['l'] & ((1u << f[c.a]) - 1u)) == 0;
    default: return f[c.a] > c.number || f[c.b] > c.number;
  }
}

}  // namespace

int isa_row(std::uint32_t word, bool thumb) { return lookup().find(word, thumb); }
const IsaBits& isa_bits(int row) { return form(row).bits; }
std::span<const IsaPiece> isa_pieces(int row) { return form(row).pieces; }
std::span<const IsaImplied> isa_implied(int row) { return form(row).implied; }
bool isa_has(int row, char letter) { return form(row).letters & letter_bit(letter); }

IsaFields isa_fields(int row, std::uint32_t word) {
  const Form& f = form(row);
  IsaFields out;
  for (const IsaPiece& p : f.pieces)
    out[p.letter] = out[p.letter] << p.width | (word >> p.from & ((1u << p.width) - 1u));
  if (f.letters & letter_bit('e')) out['d'] = 2 * out['e'];
  for (const IsaImplied& i : f.implied) out[i.letter] = i.from ? out[i.from] : i.number;
  return out;
}

std::uint32_t isa_encode(int row, const IsaFields& fields) {
  const Form& f = form(row);
  std::uint32_t out = f.bits.value | f.bits.ones;
  IsaFields left = fields;
  for (auto p = f.pieces.rbegin(); p != f.pieces.rend(); ++p) {
    out |= (left[p->letter] & ((1u << p->width) - 1u)) << p->from;
    left[p->letter] >>= p->width;
  }
  return out;
}

bool isa_defined(int row, std::uint32_t word) {
  if (row == kNoRow) return false;
  const Form& f = form(row);
  if ((word & f.bits.zeros) || (~word & f.bits.ones)) return false;
  const IsaFields v = isa_fields(row, word);
  for (const Clause& c : f.clauses)
    if (!holds(c, v)) return false;
  return true;
}

bool isa_always_defined(int row) {
  const Form& f = form(row);
  return f.bits.zeros == 0 && f.bits.ones == 0 && f.clauses.empty();
}

std::vector<std::string> isa_clauses(int row) { return form(row).texts; }

}  // namespace fovea::cpu
