// The order of requests in the controller's queue, and sets of them by what the scheduler asks for.
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "model/common/masters.h"
#include "model/mem/core/ddr_timing.h"

namespace fovea::mem {

/// A set of queue positions, counted from the oldest request: the lowest bit of any set is the oldest.
using Positions = std::uint32_t;
inline unsigned oldest(Positions set) { return static_cast<unsigned>(std::countr_zero(set)); }

/// The slots of the requests by age, and sets of their positions. When a request leaves, those behind it
/// move up, in all sets at once.
class QueuePositions {
  // Eight sets as one word of the host.
  using Sets [[gnu::vector_size(16), gnu::may_alias]] = std::uint16_t;
  static constexpr std::size_t kSetsInWord = 8;

 public:
  static constexpr unsigned kMost = 16;
  static constexpr unsigned kPriorities = 8;

  unsigned slot(unsigned position) const { return order_ >> 4 * position & 15u; }
  Positions of_master(Master m) const { return sets_[kMasters + index(m)]; }
  Positions of_bank(unsigned bank) const { return sets_[bank]; }
  /// For each bank the positions of a set that are also in `preferred`; if there are none, all of them.
  /// None for a bank with one of them in `open`. @return the banks with any, as bits
  struct ByBank {
    alignas(16) std::array<std::uint16_t, DdrDevice::kMaxBanks> places;
  };
  unsigned by_bank(Positions set, Positions preferred, Positions open, ByBank& out) const {
    static_assert(kSetsInWord == DdrDevice::kMaxBanks);
    const Sets all = sets_at(0) & static_cast<std::uint16_t>(set);
    const Sets some = all & static_cast<std::uint16_t>(preferred);
    const Sets kind = some | (all & (some == 0));
    const Sets closed = kind & ((kind & static_cast<std::uint16_t>(open)) == 0);
    reinterpret_cast<Sets&>(out.places) = closed;
    // A bit of each bank's own, from elements of all ones or none; element 0 is the lowest
    // (little-endian).
    using Halves [[gnu::vector_size(16)]] = std::uint64_t;
    const auto any = reinterpret_cast<Halves>(closed != 0);
    std::uint64_t bits = (any[0] & 0x0008'0004'0002'0001u) | (any[1] & 0x0080'0040'0020'0010u);
    bits |= bits >> 32;
    bits |= bits >> 16;
    return bits & 0xFFu;
  }
  Positions writes() const { return sets_[kWrites]; }
  /// Those of the most urgent priority in a set that is not empty.
  Positions most_urgent(Positions set) const { return set & sets_[kOfPriority + urgency(set)]; }
  unsigned urgency(Positions set) const {
    unsigned left = priorities_;
    while (!(set & sets_[kOfPriority + oldest(left)])) left &= left - 1;
    return oldest(left);
  }

  /// The newest request, behind all others; `priority` is below kPriorities.
  void add(unsigned position, unsigned slot, Master m, unsigned bank, unsigned priority, bool write) {
    const auto bit = static_cast<std::uint16_t>(1u << position);
    order_ |= std::uint64_t{slot} << 4 * position;
    sets_[kMasters + index(m)] |= bit;
    sets_[bank] |= bit;
    sets_[kOfPriority + priority] |= bit;
    priorities_ |= 1u << priority;
    if (write) sets_[kWrites] |= bit;
  }
  void leave(unsigned position, unsigned priority) {
    const std::uint64_t older = (std::uint64_t{1} << 4 * position) - 1;
    order_ = (order_ & older) | (order_ >> 4 & ~older);
    const auto before = static_cast<std::uint16_t>((1u << position) - 1);
    for (std::size_t i = 0; i < kSets; i += kSetsInWord) {
      Sets& s = sets_at(i);
      s = (s & before) | (s >> 1 & static_cast<std::uint16_t>(~before));
    }
    if (sets_[kOfPriority + priority] == 0) priorities_ &= ~(1u << priority);
  }
  /// The same for a set that is kept elsewhere.
  static Positions without(unsigned position, Positions set) {
    const Positions before = (Positions{1} << position) - 1;
    return (set & before) | (set >> 1 & ~before);
  }

 private:
  Sets& sets_at(std::size_t i) { return *reinterpret_cast<Sets*>(&sets_[i]); }
  const Sets& sets_at(std::size_t i) const { return *reinterpret_cast<const Sets*>(&sets_[i]); }
  // Banks come first.
  static constexpr std::size_t kMasters = DdrDevice::kMaxBanks;
  static constexpr std::size_t kOfPriority = kMasters + kMasterCount;
  static constexpr std::size_t kWrites = kOfPriority + kPriorities;
  static constexpr std::size_t kSets = (kWrites + kSetsInWord) / kSetsInWord * kSetsInWord;

  alignas(16) std::array<std::uint16_t, kSets> sets_{};
  std::uint64_t order_ = 0;  // four bits a slot, the oldest lowest
  unsigned priorities_ = 0;  // those in use
};

}  // namespace fovea::mem
