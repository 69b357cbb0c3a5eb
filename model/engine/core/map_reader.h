// Reads the words of a map ahead of the address generator, clock by clock: bursts of up to 64 bytes, asked for when
// the buffer of 32 beats has room for all of one.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "model/engine/core/ring.h"

namespace fovea::engine {

class MapReader {
 public:
  static constexpr unsigned kBeats = 32, kBurstBeats = 8;

  void start(std::uint32_t base, std::uint32_t words) {
    next_ = base;
    left_ = words / 2 + words % 2;
  }
  void clear() {
    offered_ = high_ = false;
    left_ = promised_ = 0;
    beats_.clear();
  }
  /// A burst is asked for, and is taken as soon as the port is free.
  bool asks() const { return offered_; }
  std::uint32_t address() const { return address_; }
  unsigned length() const { return 8 * offered_beats_; }  ///< bytes
  bool wants_to_ask() const { return offered_ || (left_ > 0 && promised_ <= kBeats - kBurstBeats); }

  /// The word to be taken in `clock`; null: none has arrived.
  const std::uint32_t* word(std::uint64_t clock) const {
    return !beats_.empty() && beats_.front().there <= clock ? &beats_.front().words[high_] : nullptr;
  }
  bool empty() const { return beats_.empty(); }
  /// When the oldest beat can be taken. @pre !empty()
  std::uint64_t there() const { return beats_.front().there; }

  /// @param asked the burst was taken; @param taken word() was
  /// @return anything has moved
  bool clock(bool asked, bool taken, bool stop) {
    bool moved = asked || taken;
    if (asked) {
      offered_ = false;
      promised_ += offered_beats_;
    } else if (promised_ <= kBeats - kBurstBeats && !offered_ && left_ > 0 && !stop) {
      offered_ = moved = true;
      address_ = next_;
      offered_beats_ = std::min(left_, kBurstBeats);
      next_ += 8 * kBurstBeats;
      left_ -= offered_beats_;
    }
    if (taken) {
      promised_ -= high_;
      if (high_) beats_.pop();
      high_ = !high_;
    }
    return moved;
  }
  /// A beat that can be taken from clock `there` on.
  void arrive(const std::uint8_t* bytes, std::uint64_t there) {
    Beat& beat = beats_.push();
    std::memcpy(beat.words, bytes, sizeof beat.words);
    beat.there = there;
  }

 private:
  struct Beat {
    std::uint32_t words[2];
    std::uint64_t there;
  };
  bool offered_ = false, high_ = false;
  std::uint32_t address_ = 0, next_ = 0;
  unsigned left_ = 0, promised_ = 0, offered_beats_ = 0;  // beats
  Ring<Beat, kBeats> beats_;
};

}  // namespace fovea::engine
