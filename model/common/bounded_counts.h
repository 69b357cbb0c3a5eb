// Counts of warnings in bounded memory, however many different ones there are.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fovea {

/// Counts texts, apart by group. Texts that differ only in numbers (addresses, values, times) are of
/// one kind: of each kind the first kExamples in alphabetical order are kept with their counts, the
/// others only counted; of all kinds the first kKinds. What is kept does not depend on the order in
/// which the texts come, so that equal runs leave equal lists.
class BoundedCounts {
 public:
  static constexpr std::size_t kExamples = 8, kKinds = 128;

  enum class Show : std::uint8_t {
    kNothing,    ///< known already, or more than enough was shown
    kText,       ///< the text, which is new
    kLastOfKind, ///< the text; further ones of its kind are not shown
    kNoMore,     ///< that there are further kinds, none of which is shown
  };
  /// @return what to tell the user now
  Show add(unsigned group, const std::string& text);

  struct Line {
    unsigned group;
    std::string text;
    std::uint64_t count;
  };
  /// All texts that are kept, and a line for each sum of those that are not.
  std::vector<Line> list() const;
  void clear() { *this = {}; }

  /// `text` with each number replaced by '#'. Digits within a word are no number.
  static std::string kind_of(std::string_view text);

 private:
  struct Kind {
    std::map<std::string, std::uint64_t> examples;
    std::uint64_t others = 0;
    std::size_t shown = 0;
  };
  static constexpr std::size_t kGroups = 4;
  std::map<std::pair<unsigned, std::string>, Kind> kinds_;
  std::array<std::uint64_t, kGroups> others_{};  ///< of kinds that are not kept
  bool more_kinds_shown_ = false;
};

}  // namespace fovea
