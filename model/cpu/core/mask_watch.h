// The longest stretch for which the program keeps IRQs masked.
#pragma once
#include <cstdint>

namespace fovea::cpu {

/// Clocks in which the core sleeps do not count: an interrupt ends them.
class MaskWatch {
 public:
  struct Stretch {
    std::uint64_t clocks = 0;
    std::uint32_t begin = 0, end = 0;  ///< addresses of the instructions that mask and unmask
  };
  /// The mask is now as `masked` says. @param awake clocks in which the core did not sleep
  void set(bool masked, std::uint64_t awake, std::uint32_t pc) {
    if (masked == masked_) return;
    if (!masked) close(awake, pc);
    masked_ = masked;
    since_ = awake;
    begin_ = pc;
  }
  /// What was seen so far is forgotten, and stretches count from here on, or nothing does.
  void count(bool on, std::uint64_t awake, std::uint32_t pc) {
    if (counting_ && masked_) close(awake, pc);
    if (on && !counting_) longest_ = {};
    counting_ = on;
    since_ = awake;
  }
  const Stretch& longest() const { return longest_; }

 private:
  void close(std::uint64_t awake, std::uint32_t pc) {
    if (counting_ && awake - since_ > longest_.clocks) longest_ = {awake - since_, begin_, pc};
  }
  bool masked_ = true, counting_ = true;  // after a reset IRQs are masked
  std::uint64_t since_ = 0;
  std::uint32_t begin_ = 0;
  Stretch longest_;
};

}  // namespace fovea::cpu
