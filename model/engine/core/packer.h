// Combines the words of the result to bursts within 64 bytes, clock by clock; four are under way at most.
#pragma once
#include <array>
#include <bit>
#include <cstdint>

namespace fovea::engine {

class Packer {
 public:
  static constexpr unsigned kUnderWay = 4, kWords = 16;

  struct Burst {
    std::uint32_t address = 0;  ///< of the first word of the 64 bytes
    std::uint32_t mask = 0;     ///< words that are written
    std::array<std::uint32_t, kWords> words{};
    /// Clocks that its data take on the bus: 64-bit beats from the first to the last with a word.
    unsigned beats() const {
      return static_cast<unsigned>(std::bit_width(mask) - 1) / 2 -
             static_cast<unsigned>(std::countr_zero(mask)) / 2 + 1;
    }
  };

  void clear() {
    gather_.mask = 0;
    ended_ = false;
    sent_at_ = 0;
    under_way_ = 0;
  }
  /// A word is not taken although there is one, until an answer comes.
  bool waits_for_answer(bool valid, std::uint32_t dst) const {
    return under_way_ == kUnderWay && full(valid, dst);
  }
  /// One clock. @param stop no new bursts
  /// @return the word is taken
  bool clock(std::uint64_t now, bool valid, std::uint32_t word, std::uint32_t dst, bool last, bool stop) {
    moved_ = handed_over_ = false;
    if (full(valid, dst)) {
      if (now <= sent_at_ || stop || under_way_ == kUnderWay) return false;
      out_ = gather_;
      gather_.mask = 0;
      ++under_way_;
      sent_at_ = now + out_.beats();
      moved_ = handed_over_ = true;
      return false;
    }
    if (!valid) return false;
    take(word, dst, last);
    return moved_ = true;
  }
  /// A word is taken if there is one.
  bool takes(std::uint32_t dst) const { return !full(true, dst); }
  /// @pre takes(dst)
  void take(std::uint32_t word, std::uint32_t dst, bool last) {
    gather_.address = block(dst);
    gather_.words[dst % kWords] = word;
    gather_.mask |= 1u << dst % kWords;
    ended_ = last;
  }
  bool moved() const { return moved_; }
  bool handed_over() const { return handed_over_; }
  /// The clock in which the last data of the burst that is being sent are taken; 0: none was sent.
  std::uint64_t sent_at() const { return sent_at_; }
  const Burst& out() const { return out_; }
  void answered() { --under_way_; }
  unsigned under_way() const { return under_way_; }
  /// The last word of the job is in memory.
  bool finished() const { return finished_but_for_answers() && under_way_ == 0; }
  bool finished_but_for_answers() const { return ended_ && gather_.mask == 0; }

 private:
  static std::uint32_t block(std::uint32_t dst) { return dst / kWords * 4 * kWords; }
  bool full(bool valid, std::uint32_t dst) const {
    return gather_.mask != 0 && (ended_ || gather_.mask >> (kWords - 1) ||
                                 (valid && gather_.address != block(dst)));
  }
  Burst gather_, out_;
  bool ended_ = false, moved_ = false, handed_over_ = false;
  std::uint64_t sent_at_ = 0;
  unsigned under_way_ = 0;
};

}  // namespace fovea::engine
