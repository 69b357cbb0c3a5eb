// Reads the words of the source through a direct-mapped cache, clock by clock: tags are looked up along the stream of
// addresses, ahead of the data; lines come in the order in which they were asked for.
#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <span>

#include "model/engine/core/ring.h"

namespace fovea::engine {

/// An access on its way from the tags to the data.
struct CacheAccess {
  std::uint64_t there = 0;           ///< clock from which on it can be taken
  std::uint32_t word = 0;            ///< word address
  std::uint8_t which = 0;            ///< of the pair's words
  bool miss = false, final = false;  ///< brings a line; the last one of its pair
};

class SourceCache {
 public:
  static constexpr unsigned kLineWords = 8, kAhead = 32, kLines = 8;
  static constexpr unsigned kPlaces = 256;  ///< lines: 8 KiB (LogLines of the RTL)

  void clear() {
    there_.fill(false);
    lines_.clear();
    waiting_.clear();
    promised_ = 0;
  }

  /// @name Tags
  ///@{
  bool hit(std::uint32_t word) const {
    return there_[place(word)] && tags_[place(word)] == word / kLineWords;
  }
  bool may_ask() const { return promised_ != kLines; }
  bool room() const { return waiting_.size() < kAhead; }
  void push(const CacheAccess& access) {
    if (access.miss) {
      there_[place(access.word)] = true;
      tags_[place(access.word)] = access.word / kLineWords;
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
    auto& line = data_[place(a.word)];
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
  static std::size_t place(std::uint32_t word) { return word / kLineWords % kPlaces; }
  std::array<bool, kPlaces> there_{};
  std::array<std::uint32_t, kPlaces> tags_{};
  std::array<Words, kPlaces> data_{};
  Ring<Line, kLines> lines_;
  Ring<CacheAccess, kAhead> waiting_;
  unsigned promised_ = 0;
};

}  // namespace fovea::engine
