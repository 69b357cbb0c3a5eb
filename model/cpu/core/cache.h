// A virtually tagged, 4-way set-associative cache that holds its data.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace fovea::cpu {

class Cache {
 public:
  static constexpr unsigned kWays = 4, kLineBytes = 32;
  explicit Cache(std::uint64_t size)
      : sets_(static_cast<unsigned>(size / (kWays * kLineBytes))),
        lines_(sets_ * kWays),
        data_(static_cast<std::size_t>(size)) {}
  struct Line {
    std::uint32_t tag = 1;   // MVA of the line; 1: invalid
    std::uint32_t pa = 0;    // physical address of the line, for write-backs
    std::uint8_t dirty = 0;  // one bit for each half of the line
    bool write_back = false;
    std::uint8_t watched = 0;  // by how many observers, at most 31; its accesses are announced, so it has no hints
  };
  unsigned sets() const { return sets_; }
  unsigned lines() const { return sets_ * kWays; }
  unsigned set_of(std::uint32_t mva) const { return (mva >> 5) & (sets_ - 1); }
  /// Index of the line that holds this MVA (its five low bits are ignored), or -1.
  [[gnu::always_inline]] int find(std::uint32_t mva) const {
    const std::uint32_t line = mva & ~31u;
    // The tag is the whole MVA, so a line with this tag is the right one, whichever address left
    // the hint.
    std::uint16_t& hint = hints_[(mva >> 5) % kHints];
    if (lines_[hint].tag == line) return hint;
    const unsigned base = set_of(mva) * kWays;
    for (unsigned w = 0; w < kWays; ++w)
      if (lines_[base + w].tag == line) {
        hint = static_cast<std::uint16_t>(base + w);
        return static_cast<int>(base + w);
      }
    return -1;
  }
  /// Forgets which lines were found last.
  void forget() { hints_ = {}; }
  Line& line(unsigned i) { return lines_[i]; }
  const Line& line(unsigned i) const { return lines_[i]; }
  std::uint8_t* data(unsigned i) { return data_.data() + std::size_t{i} * kLineBytes; }
  const std::uint8_t* data(unsigned i) const { return data_.data() + std::size_t{i} * kLineBytes; }
  void invalidate(unsigned i) {
    lines_[i].tag = 1;
    lines_[i].dirty = 0;
    lines_[i].watched = 0;
  }
  void invalidate_all() {
    for (unsigned i = 0; i < lines(); ++i) invalidate(i);
  }
  /// Index of the line to replace in a set: an invalid one first, otherwise by the replacement
  /// counter. Ways whose bit is set in `locked` (lockdown format C) are skipped. The policy is
  /// round robin or a 16-bit Galois LFSR (assumed: the chip's random generator is not documented).
  unsigned victim(unsigned set, bool round_robin, std::uint32_t locked) {
    for (unsigned w = 0; w < kWays; ++w)
      if (lines_[set * kWays + w].tag == 1 && !(locked >> w & 1u)) return set * kWays + w;
    for (unsigned tries = 0; tries < 64; ++tries) {
      unsigned w;
      if (round_robin) {
        w = counter_++ & 3u;
      } else {
        lfsr_ = static_cast<std::uint16_t>((lfsr_ >> 1) ^ ((lfsr_ & 1u) ? 0xB400u : 0u));
        w = lfsr_ & 3u;
      }
      if (!(locked >> w & 1u)) return set * kWays + w;
    }
    return set * kWays + 3;
  }

 private:
  unsigned sets_;
  std::vector<Line> lines_;
  std::vector<std::uint8_t> data_;
  unsigned counter_ = 0;
  std::uint16_t lfsr_ = 0xACE1;
  static constexpr unsigned kHints = 64;
  mutable std::array<std::uint16_t, kHints> hints_{};  // index of the line found last, by address
};

/// A line fill under way. The core continues when the first word is there, and each further word
/// can be used as it arrives.
struct LineFill {
  std::uint32_t line = 1;      // MVA of the line that is being filled; 1: none
  std::uint32_t critical = 0;  // number of the word that arrives first
  std::uint32_t pa = 0;
  std::uint64_t first = 0, last = 0;  // clocks of the first and the last word
  /// Clock at which the word of an address arrives; `mva` is in the line.
  std::uint64_t word(std::uint32_t mva) const {
    const std::uint32_t order = ((mva >> 2) - critical) & 7u;
    return first + (last - first) * order / 7;
  }
};

}  // namespace fovea::cpu
