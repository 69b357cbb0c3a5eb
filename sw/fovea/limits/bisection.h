// The search for the edge between values that are good and values that are not.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace fovea::limits {

/// Asks about values 0 to `last`, one after the other, and finds where good ones end. It first asks
/// about both ends. Then it halves the range between the last good value and the first bad one behind
/// it (from the good end), until they are neighbours. Then it asks about `probes` values in the
/// largest gaps that are left, because a good value beyond a bad one, or a bad one before a good one,
/// would show that the edge is not the only one. A bad value that a probe finds moves the edge: the
/// answer is always an edge up to which, from the good end, no tried value was bad. If good and bad ones
/// alternate, kMore further values are asked about, unless `probes` is 0.
class Bisection {
 public:
  explicit Bisection(std::uint64_t last, unsigned probes = 2);
  static constexpr unsigned kMore = 16;

  /// The next value to try; nothing: the search is over.
  std::optional<std::uint64_t> next() const;
  /// The outcome for a value; each value once.
  void tell(std::uint64_t value, bool good);
  /// At most how many more values it will ask for, unless a probe moves the edge or shows another one.
  std::size_t at_most_left() const;

  enum class Answer {
    kUnknown,   ///< the search is not over
    kLargest,   ///< good from 0 to `good`, not at `bad` = `good` + 1
    kSmallest,  ///< good from `good` to the last one, not at `bad` = `good` - 1
    kAll,       ///< good at both ends, and wherever it was tried
    kBetween,   ///< bad at both ends, but not at `good`
    kNone,      ///< bad at both ends, and wherever it was tried
  };
  struct Outcome {
    Answer answer = Answer::kUnknown;
    std::uint64_t good = 0, bad = 0;
    /// False: some value beyond the edge, or between two bad ends, is good; `odd` is the nearest such one.
    bool monotonic = true;
    std::uint64_t odd = 0;
  };
  Outcome outcome() const;
  const std::map<std::uint64_t, bool>& tried() const { return tried_; }

 private:
  /// Neighbouring tried values, from the good end, where good turns bad.
  std::optional<std::pair<std::uint64_t, std::uint64_t>> edge() const;
  std::optional<std::uint64_t> probe() const;
  bool upwards() const;  ///< the good end is 0
  unsigned changes() const;  ///< how often good and bad follow one another among the tried values
  unsigned budget() const;   ///< probes in all
  std::uint64_t last_;
  unsigned probes_;
  unsigned probed_ = 0;
  std::map<std::uint64_t, bool> tried_;
};

}  // namespace fovea::limits
