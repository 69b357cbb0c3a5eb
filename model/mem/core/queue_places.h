// Who stands where in the controller's queue.
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "model/common/masters.h"
#include "model/mem/core/ddr_timing.h"

namespace fovea::mem {

/// A set of places, counted from the oldest request: of any set the lowest bit is the oldest.
using Places = std::uint32_t;
inline unsigned oldest(Places set) { return static_cast<unsigned>(std::countr_zero(set)); }

/// The slots of the requests by age, and their places by what the scheduler asks for. When one
/// leaves those behind it move up, in all sets at once.
class QueuePlaces {
  // Eight sets as one word of the host.
  using Lanes [[gnu::vector_size(16), gnu::may_alias]] = std::uint16_t;
  static constexpr std::size_t kLanes = 8;

 public:
  static constexpr unsigned kMost = 16;
  static constexpr unsigned kPriorities = 8;

  unsigned slot(unsigned place) const { return order_ >> 4 * place & 15u; }
  Places of_master(Master m) const { return sets_[kMasters + index(m)]; }
  Places of_bank(unsigned bank) const { return sets_[bank]; }
  /// For each bank the places of a set that come first, by `preferred`: those in it, else all. None
  /// for a bank with one of them in `open`. @return the banks with any, as bits
  struct ByBank {
    alignas(16) std::array<std::uint16_t, DdrDevice::kMaxBanks> places;
  };
  unsigned by_bank(Places set, Places preferred, Places open, ByBank& out) const {
    static_assert(kLanes == DdrDevice::kMaxBanks);
    const Lanes all = lanes(0) & static_cast<std::uint16_t>(set);
    const Lanes some = all & static_cast<std::uint16_t>(preferred);
    const Lanes kind = some | (all & (some == 0));
    const Lanes closed = kind & ((kind & static_cast<std::uint16_t>(open)) == 0);
    reinterpret_cast<Lanes&>(out.places) = closed;
    // A bit of each bank's own, from lanes of all ones or none; lane 0 is the lowest
    // (little-endian).
    using Halves [[gnu::vector_size(16)]] = std::uint64_t;
    const auto any = reinterpret_cast<Halves>(closed != 0);
    std::uint64_t bits = (any[0] & 0x0008'0004'0002'0001u) | (any[1] & 0x0080'0040'0020'0010u);
    bits |= bits >> 32;
    bits |= bits >> 16;
    return bits & 0xFFu;
  }
  Places writes() const { return sets_[kWrites]; }
  /// Those of the most urgent priority in a set that is not empty.
  Places most_urgent(Places set) const { return set & sets_[kOfPriority + urgency(set)]; }
  unsigned urgency(Places set) const {
    unsigned left = priorities_;
    while (!(set & sets_[kOfPriority + oldest(left)])) left &= left - 1;
    return oldest(left);
  }

  /// The newest request, behind all others; `priority` is below kPriorities.
  void add(unsigned place, unsigned slot, Master m, unsigned bank, unsigned priority, bool write) {
    const auto bit = static_cast<std::uint16_t>(1u << place);
    order_ |= std::uint64_t{slot} << 4 * place;
    sets_[kMasters + index(m)] |= bit;
    sets_[bank] |= bit;
    sets_[kOfPriority + priority] |= bit;
    priorities_ |= 1u << priority;
    if (write) sets_[kWrites] |= bit;
  }
  void leave(unsigned place, unsigned priority) {
    const std::uint64_t older = (std::uint64_t{1} << 4 * place) - 1;
    order_ = (order_ & older) | (order_ >> 4 & ~older);
    const auto before = static_cast<std::uint16_t>((1u << place) - 1);
    for (std::size_t i = 0; i < kSets; i += kLanes) {
      Lanes& s = lanes(i);
      s = (s & before) | (s >> 1 & static_cast<std::uint16_t>(~before));
    }
    if (sets_[kOfPriority + priority] == 0) priorities_ &= ~(1u << priority);
  }
  /// The same for a set that is kept elsewhere.
  static Places without(unsigned place, Places set) {
    const Places before = (Places{1} << place) - 1;
    return (set & before) | (set >> 1 & ~before);
  }

 private:
  Lanes& lanes(std::size_t i) { return *reinterpret_cast<Lanes*>(&sets_[i]); }
  const Lanes& lanes(std::size_t i) const { return *reinterpret_cast<const Lanes*>(&sets_[i]); }
  // Banks come first.
  static constexpr std::size_t kMasters = DdrDevice::kMaxBanks;
  static constexpr std::size_t kOfPriority = kMasters + kMasterCount;
  static constexpr std::size_t kWrites = kOfPriority + kPriorities;
  static constexpr std::size_t kSets = (kWrites + kLanes) / kLanes * kLanes;

  alignas(16) std::array<std::uint16_t, kSets> sets_{};
  std::uint64_t order_ = 0;  // four bits a slot, the oldest lowest
  unsigned priorities_ = 0;  // those in use
};

}  // namespace fovea::mem
