// Reads the words of the source through a cache of four ways, clock by clock: tags are looked up along the stream of
// addresses, ahead of the data; lines come in the order in which they were asked for.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "model/engine/core/ring.h"

namespace fovea::engine {

/// An access on its way from the tags to the data. What is looked up in a clock can be taken from the next one on:
/// data come before tags in a clock's order.
struct CacheAccess {
  std::uint16_t word = 0;            ///< its place in the cache, in words
  std::uint8_t which = 0;            ///< of the pair's words
  bool miss = false, final = false;  ///< brings a line; the last one of its pair
};

/// Sizes that the RTL has as parameters.
struct Geometry {
  unsigned log_lines = 8;  ///< 2^n lines of 32 bytes, 0 to 12; four or fewer are one set
  unsigned prefetch = 8;   ///< lines under way at most, 1 to 8
};

class SourceCache {
 public:
  static constexpr unsigned kLineWords = 8, kAhead = 32, kLines = 8, kWays = 4;

  explicit SourceCache(Geometry g)
      : ways_(std::min(kWays, 1u << g.log_lines)),
        log_sets_(g.log_lines - static_cast<unsigned>(std::countr_zero(ways_))),
        prefetch_(g.prefetch),
        tags_(1u << log_sets_),
        next_(1u << log_sets_),
        data_(kLineWords << g.log_lines) {
    static_assert(kLineWords << 12 <= 1u << 16, "CacheAccess::word");
    clear();
  }
  void clear() {
    Tags none;
    none.fill(kNothing);
    std::ranges::fill(tags_, none);
    std::ranges::fill(next_, std::uint8_t{0});
    latest_ = kNothing;
    lines_.clear();
    waiting_.clear();
    promised_ = 0;
  }

  /// @name Tags
  ///@{
  /// Looks a word of the source up: where it is, or which line it will replace, and whether it is missing (`miss`).
  void look_up(CacheAccess& access, std::uint32_t word) {
    const std::uint32_t line = word / kLineWords;
    std::uint32_t words = latest_words_;
    // Most accesses are to the line of the one before, which is there: only a later one replaces it.
    if (line != latest_) {
      const unsigned set = set_of(line);
      const Tags& tags = tags_[set];
      unsigned way = 0;
      while (way < kWays && tags[way] != line) ++way;
      access.miss = way == kWays;
      words = (set * ways_ + (access.miss ? next_[set] : way)) * kLineWords;
      if (!access.miss) remember(line, words);
    }
    access.word = static_cast<std::uint16_t>(words + word % kLineWords);
  }
  bool may_ask() const { return promised_ != prefetch_; }
  bool room() const { return waiting_.size() < kAhead; }
  /// The line of a miss is asked for.
  void replace(const CacheAccess& miss, std::uint32_t line) {
    const unsigned set = set_of(line);
    std::uint8_t& next = next_[set];
    tags_[set][next] = line;
    remember(line, miss.word / kLineWords * kLineWords);
    next = static_cast<std::uint8_t>((next + 1) % ways_);
    ++promised_;
  }
  void push(const CacheAccess& access) { waiting_.push(access); }
  ///@}

  /// @name Data
  ///@{
  /// The access whose turn it is; null: none.
  const CacheAccess* next() const { return waiting_.empty() ? nullptr : &waiting_.front(); }
  /// It needs a line of which nothing is known.
  bool wants_line() const { return lines_.empty() && !waiting_.empty() && waiting_.front().miss; }
  bool line_there(std::uint64_t clock) const { return !lines_.empty() && lines_.front().there <= clock; }
  bool no_line() const { return lines_.empty(); }
  std::uint64_t line_at() const { return lines_.front().there; }
  /// Takes next(). @return its word
  std::uint32_t pop() {
    const CacheAccess& a = waiting_.front();
    if (a.miss) {
      std::memcpy(&data_[a.word / kLineWords * kLineWords], lines_.front().words.data(), 4 * kLineWords);
      lines_.pop();
      --promised_;
    }
    waiting_.pop();
    return data_[a.word];
  }
  /// A line that can be taken from clock `there` on.
  void arrive(std::span<const std::uint8_t> bytes, std::uint64_t there) {
    Line& line = lines_.push();
    std::memcpy(line.words.data(), bytes.data(), sizeof line.words);
    line.there = there;
  }
  ///@}

 private:
  struct Line {
    std::array<std::uint32_t, kLineWords> words;
    std::uint64_t there;
  };
  static constexpr std::uint32_t kNothing = ~0u;  // no line's number
  /// Numbers of a set's lines; behind `ways_` nothing.
  using Tags = std::array<std::uint32_t, kWays>;
  void remember(std::uint32_t line, std::uint32_t words) {
    latest_ = line;
    latest_words_ = words;
  }
  /// Neighbours in a row and in a column of the source are in different sets.
  unsigned set_of(std::uint32_t line) const { return (line ^ line >> log_sets_) & ((1u << log_sets_) - 1); }
  unsigned ways_, log_sets_, prefetch_;
  std::vector<Tags> tags_;
  std::vector<std::uint8_t> next_;      // of each set, the way that is replaced next
  std::vector<std::uint32_t> data_;
  std::uint32_t latest_ = kNothing;     // line that was looked up last and is there,
  std::uint32_t latest_words_ = 0;      // and its place
  Ring<Line, kLines> lines_;
  Ring<CacheAccess, kAhead> waiting_;
  unsigned promised_ = 0;
};

}  // namespace fovea::engine
