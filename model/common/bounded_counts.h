// Counts of warning texts that need a bounded amount of memory, however many different texts come.
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

/// Counts warning texts in groups. Texts that differ only in numbers (addresses, values, times) are
/// of one kind. Of each kind, the kExamples texts that come first in alphabetical order are kept
/// with their counts, and the others are only counted; the same holds for the first kKinds kinds.
/// What is kept does not depend on the order in which the texts arrive, so equal runs give equal
/// lists.
class BoundedCounts {
 public:
  static constexpr std::size_t kExamples = 8, kKinds = 128;

  enum class Show : std::uint8_t {
    kNothing,    ///< the text was shown before, or its kind has been shown often enough
    kText,       ///< the text: it is new
    kLastOfKind, ///< the text, and a note that further texts of its kind are not shown
    kNoMore,     ///< a note that there are more kinds, which are not shown
  };
  /// Counts `text` in `group` (0 to kGroups - 1).
  ///
  /// @return what the caller should show the user now
  Show add(unsigned group, const std::string& text);

  struct Line {
    unsigned group;
    std::string text;
    std::uint64_t count;
  };
  /// All texts that are kept, followed by one line for each sum of texts that are not.
  std::vector<Line> list() const;
  void clear() { *this = {}; }

  /// `text` with each number replaced by '#'. Digits inside a word (`cp15`) are not a number.
  static std::string kind_of(std::string_view text);

 private:
  struct Kind {
    std::map<std::string, std::uint64_t> examples;
    std::uint64_t others = 0;
    std::size_t shown = 0;
  };
  static constexpr std::size_t kGroups = 4;
  std::map<std::pair<unsigned, std::string>, Kind> kinds_;
  std::array<std::uint64_t, kGroups> others_{};  ///< texts of kinds that are not kept, by group
  bool more_kinds_shown_ = false;
};

}  // namespace fovea
