// Reads the words of the source through a cache of four ways, clock by clock: tags are looked up along the stream of
// addresses, ahead of the data; lines come in the order in which they were asked for.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

#include "model/engine/core/ring.h"

namespace fovea::engine {

/// An access on its way from the tags to the data.
struct CacheAccess {
  std::uint64_t there = 0;           ///< clock from which on it can be taken
  std::uint32_t word = 0;            ///< word address
  std::uint16_t place = 0;           ///< its line in the cache
  std::uint8_t which = 0;            ///< of the pair's words
  bool miss = false, final = false;  ///< brings a line; the last one of its pair
};

/// Sizes that the RTL has as parameters.
struct Geometry {
  unsigned log_lines = 8;  ///< 2^n lines of 32 bytes, 0 to 8; up to four of them are one set of four ways or fewer
  unsigned prefetch = 8;   ///< lines under way at most, 1 to 8
};

class SourceCache {
 public:
  static constexpr unsigned kLineWords = 8, kAhead = 32, kLines = 8, kWays = 4, kMostPlaces = 256;

  explicit SourceCache(Geometry g)
      : ways_(std::min(kWays, 1u << g.log_lines)),
        log_sets_(g.log_lines - static_cast<unsigned>(std::countr_zero(ways_))),
        prefetch_(g.prefetch) {
    clear();
  }
  void clear() {
    tags_.fill(kNothing);
    next_.fill(0);
    lines_.clear();
    waiting_.clear();
    promised_ = 0;
  }

  /// @name Tags
  ///@{
  /// Looks a word up: where it is, or which line it will replace (`place`), and whether it is missing (`miss`).
  void look_up(CacheAccess& access) const {
    const std::uint32_t line = access.word / kLineWords;
    const unsigned set = set_of(line), first = set * ways_;
    for (unsigned way = 0; way < ways_; ++way)
      if (tags_[first + way] == line) {
        access.place = static_cast<std::uint16_t>(first + way);
        access.miss = false;
        return;
      }
    access.place = static_cast<std::uint16_t>(first + next_[set]);
    access.miss = true;
  }
  bool may_ask() const { return promised_ != prefetch_; }
  bool room() const { return waiting_.size() < kAhead; }
  void push(const CacheAccess& access) {
    if (access.miss) {
      const std::uint32_t line = access.word / kLineWords;
      tags_[access.place] = line;
      std::uint8_t& next = next_[set_of(line)];
      next = static_cast<std::uint8_t>((next + 1) % ways_);
      ++promised_;
    }
    waiting_.push(access);
  }
  ///@}

  /// @name Data
  ///@{
  /// The access whose turn it is in `clock`; null: none.
  const CacheAccess* next(std::uint64_t clock) const {
    return !waiting_.empty() && waiting_.front().there <= clock ? &waiting_.front() : nullptr;
  }
  bool line_there(std::uint64_t clock) const { return !lines_.empty() && lines_.front().there <= clock; }
  bool no_line() const { return lines_.empty(); }
  std::uint64_t line_at() const { return lines_.front().there; }
  /// Takes next(). @return its word
  std::uint32_t pop() {
    const CacheAccess& a = waiting_.front();
    auto& line = data_[a.place];
    if (a.miss) {
      line = lines_.front().words;
      lines_.pop();
      --promised_;
    }
    const std::uint32_t word = line[a.word % kLineWords];
    waiting_.pop();
    return word;
  }
  /// A line that can be taken from clock `there` on.
  void arrive(std::span<const std::uint8_t> bytes, std::uint64_t there) {
    Line line{{}, there};
    std::memcpy(line.words.data(), bytes.data(), sizeof line.words);
    lines_.push(line);
  }
  ///@}

 private:
  using Words = std::array<std::uint32_t, kLineWords>;
  struct Line {
    Words words;
    std::uint64_t there;
  };
  static constexpr std::uint32_t kNothing = ~0u;  // no line's number
  /// Neighbours in a row and in a column of the source are in different sets.
  unsigned set_of(std::uint32_t line) const { return (line ^ line >> log_sets_) & ((1u << log_sets_) - 1); }
  unsigned ways_, log_sets_, prefetch_;
  std::array<std::uint32_t, kMostPlaces> tags_{};  // numbers of lines
  std::array<std::uint8_t, kMostPlaces> next_{};   // of each set, the way that is replaced next
  std::array<Words, kMostPlaces> data_{};
  Ring<Line, kLines> lines_;
  Ring<CacheAccess, kAhead> waiting_;
  unsigned promised_ = 0;
};

}  // namespace fovea::engine
