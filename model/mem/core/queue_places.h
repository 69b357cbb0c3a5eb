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

/// The slots of the requests by age, and their places by what the scheduler asks for. When one leaves
/// those behind it move up, in all sets at once.
class QueuePlaces {
 public:
  static constexpr unsigned kMost = 16;
  static constexpr unsigned kPriorities = 8;

  unsigned slot(unsigned place) const { return order_ >> 4 * place & 15u; }
  Places of_master(Master m) const { return sets_[index(m)]; }
  Places of_bank(unsigned bank) const { return sets_[kBanks + bank]; }
  Places writes() const { return sets_[kWrites]; }
  /// Those of the most urgent priority in a set that is not empty.
  Places most_urgent(Places set) const { return set & sets_[kOfPriority + urgency(set)]; }
  unsigned urgency(Places set) const {
    unsigned left = priorities_;
    while (!(set & sets_[kOfPriority + oldest(left)])) left &= left - 1;
    return oldest(left);
  }

  /// The newest request, behind all others.
  void add(unsigned place, unsigned slot, Master m, unsigned bank, unsigned priority, bool write) {
    const auto bit = static_cast<std::uint16_t>(1u << place);
    order_ |= std::uint64_t{slot} << 4 * place;
    sets_[index(m)] |= bit;
    sets_[kBanks + bank] |= bit;
    sets_[kOfPriority + priority] |= bit;
    priorities_ |= 1u << priority;
    if (write) sets_[kWrites] |= bit;
  }
  void leave(unsigned place, unsigned priority) {
    const std::uint64_t older = (std::uint64_t{1} << 4 * place) - 1;
    order_ = (order_ & older) | (order_ >> 4 & ~older);
    const auto before = static_cast<std::uint16_t>((1u << place) - 1);
    for (std::size_t i = 0; i < kSets; i += kLanes) {
      Lanes& s = *reinterpret_cast<Lanes*>(&sets_[i]);
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
  // Eight sets as one word of the host.
  using Lanes [[gnu::vector_size(16), gnu::may_alias]] = std::uint16_t;
  static constexpr std::size_t kLanes = 8;
  static constexpr std::size_t kBanks = kMasterCount;
  static constexpr std::size_t kOfPriority = kBanks + DdrDevice::kMaxBanks;
  static constexpr std::size_t kWrites = kOfPriority + kPriorities;
  static constexpr std::size_t kSets = (kWrites + kLanes) / kLanes * kLanes;

  alignas(16) std::array<std::uint16_t, kSets> sets_{};
  std::uint64_t order_ = 0;  // four bits a slot, the oldest lowest
  unsigned priorities_ = 0;  // those in use
};

}  // namespace fovea::mem
