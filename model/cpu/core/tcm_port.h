// The DMA port of the internal RAM: which clocks of a bank it uses, and who waits for whom.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "model/common/masters.h"

namespace fovea::cpu {

/// Executes one burst at a time, word by word. A word that has begun is never interrupted; if both
/// the core and the DMA want a bank in the same clock, Rules::core_first decides. No public
/// document describes the chip's arbitration: all of this is assumed.
class TcmPort {
 public:
  struct Rules {
    unsigned word_clocks = 2;  ///< core clocks for which a word of the DMA occupies its bank
    unsigned latency = 2;      ///< core clocks from a burst's arrival to its first word
    unsigned banks = 2;
    bool core_first = true;
  };
  struct Burst {
    std::uint32_t offset = 0;  ///< from the first byte of the RAM; a burst lies in one bank
    unsigned bytes = 0;
    Master master = Master::kLoad;
  };
  enum class Side : std::uint8_t { kFetch, kData };

  TcmPort(const Rules& rules, std::size_t ram_bytes)
      : rules_(rules), bank_bytes_(static_cast<std::uint32_t>(ram_bytes / rules.banks)) {}

  /// @param clock the first core clock after the burst's arrival
  void begin(const Burst& burst, std::uint64_t clock) {
    burst_ = burst;
    left_ = ((burst.offset & 3u) + burst.bytes + 3) / 4;
    active_ = true;
    waited_before_ = waited_[0] + waited_[1];
    next_ = clock + rules_.latency;
    ++bursts_;
  }
  bool same_bank(std::uint32_t a, std::uint32_t b) const {
    return a / bank_bytes_ == b / bank_bytes_;
  }
  void finish() { active_ = false; }
  bool busy() const { return active_; }
  const Burst& burst() const { return burst_; }
  std::uint64_t bursts() const { return bursts_; }
  /// Clock after the last word, if the core does not access this bank meanwhile.
  std::uint64_t end() const { return next_ + std::uint64_t{left_} * rules_.word_clocks; }

  /// The core wants the word at `offset` at `clock`, for `hold` clocks. Must be called in the order
  /// of clocks. @return the clock at which the core gets the word
  std::uint64_t core_access(std::uint32_t offset, std::uint64_t clock, unsigned hold, Side side) {
    if (!active_ || left_ == 0 || !same_bank(offset, burst_.offset)) return clock;
    const unsigned k = rules_.word_clocks;
    // Words of the DMA that begin before the core's, or in the same clock if the DMA goes first.
    const std::uint64_t limit = clock + (rules_.core_first ? 0 : 1);
    std::uint64_t begun = 0;
    if (limit > next_)
      begun = rules_.core_first ? std::min<std::uint64_t>(left_, (limit - next_ + k - 1) / k)
                                : left_;  // the next word wants the bank as soon as one is finished
    next_ += begun * k;
    left_ -= static_cast<unsigned>(begun);
    const std::uint64_t got = begun ? std::max(clock, next_) : clock;
    if (left_ != 0 && next_ < got + hold) {
      waited_[static_cast<std::size_t>(side)] += got + hold - next_;
      next_ = got + hold;
    }
    return got;
  }
  /// Clocks in which words of the DMA waited for the core, since the start.
  std::uint64_t waited(Side side) const { return waited_[static_cast<std::size_t>(side)]; }
  /// The same of the latest burst, so far.
  std::uint64_t waited_of_burst() const { return waited_[0] + waited_[1] - waited_before_; }

 private:
  Rules rules_;
  std::uint32_t bank_bytes_;
  Burst burst_;
  bool active_ = false;
  unsigned left_ = 0;       // words that have not begun, as of the core's last access
  std::uint64_t next_ = 0;  // clock at which the next word wants the bank
  std::uint64_t bursts_ = 0;
  std::array<std::uint64_t, 2> waited_{};
  std::uint64_t waited_before_ = 0;
};

}  // namespace fovea::cpu
