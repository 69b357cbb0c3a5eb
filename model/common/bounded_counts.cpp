#include "model/common/bounded_counts.h"

#include <cctype>

namespace fovea {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool is_hex(char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; }
bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Length of the number that begins at `at`, or 0 if there is none.
std::size_t number_at(std::string_view text, std::size_t at) {
  if (!is_digit(text[at]) || (at > 0 && is_word(text[at - 1]))) return 0;
  std::size_t end = at;
  if (text.substr(at).starts_with("0x")) {
    end = at + 2;
    while (end < text.size() && is_hex(text[end])) ++end;
    if (end == at + 2) return 0;
  } else {
    while (end < text.size() && is_digit(text[end])) ++end;
  }
  return end < text.size() && is_word(text[end]) ? 0 : end - at;
}

}  // namespace

std::string BoundedCounts::kind_of(std::string_view text) {
  std::string kind;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t digits = number_at(text, i);
    kind += digits ? '#' : text[i];
    i += digits ? digits : 1;
  }
  return kind;
}

BoundedCounts::Show BoundedCounts::add(unsigned group, const std::string& text) {
  const auto [position, new_kind] = kinds_.try_emplace({group, kind_of(text)});
  if (kinds_.size() > kKinds) {
    // The table is full: the alphabetically last kind is dropped. It cannot return, because every
    // kind that is kept sorts before it.
    const auto last = std::prev(kinds_.end());
    const bool itself = last == position;
    std::uint64_t& others = others_[last->first.first];
    others += last->second.others;
    for (const auto& example : last->second.examples) others += example.second;
    kinds_.erase(last);
    if (itself) {
      ++others;
      return std::exchange(more_kinds_shown_, true) ? Show::kNothing : Show::kNoMore;
    }
  }
  Kind& kind = position->second;
  bool is_new = false;
  if (const auto known = kind.examples.find(text); known != kind.examples.end()) {
    ++known->second;
  } else {
    is_new = true;
    kind.examples[text] = 1;
    if (kind.examples.size() > kExamples) {
      const auto last = std::prev(kind.examples.end());
      kind.others += last->second;
      kind.examples.erase(last);
    }
  }
  if (!is_new || kind.shown > kExamples) return Show::kNothing;
  ++kind.shown;
  return kind.shown <= kExamples ? Show::kText : Show::kLastOfKind;
}

std::vector<BoundedCounts::Line> BoundedCounts::list() const {
  static const std::string further = "warnings of further kinds";  // GCC 12 warns of a move from the text itself
  std::vector<Line> lines;
  for (const auto& [key, kind] : kinds_) {
    for (const auto& [text, count] : kind.examples) lines.push_back({key.first, text, count});
    if (kind.others > 0)
      lines.push_back({key.first, "others like: " + kind.examples.begin()->first, kind.others});
  }
  for (std::size_t group = 0; group < kGroups; ++group)
    if (others_[group] > 0)
      lines.push_back({static_cast<unsigned>(group), further, others_[group]});
  return lines;
}

}  // namespace fovea
