// Who or what a memory request waited for: every picosecond from its issue to its outcome.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "model/common/masters.h"
#include "model/common/stats.h"

namespace fovea {

/// The masters come first, by their numbers: the time in which they were served instead. A master's
/// own number is the wait behind its own earlier requests.
enum class Culprit : std::uint8_t {
  kBridge = kMasterCount,  ///< between port and crossbar, both ways, with the edges waited for
  kService,                ///< its own way through crossbar, controller and return lane
  kRowMiss,                ///< its bank was closed: ACT to column command
  kRowConflict,            ///< another row was open: PRE to column command
  kTurnaround,             ///< the data bus turns from writes to reads or back
  kRefresh,
  kPowerDown,              ///< the memory sleeps, or wakes up
  kCount
};
inline constexpr std::size_t kCulprits = static_cast<std::size_t>(Culprit::kCount);
constexpr Culprit culprit(Master m) { return static_cast<Culprit>(index(m)); }
constexpr std::size_t index(Culprit c) { return static_cast<std::size_t>(c); }

/// Two neighbouring sums as one word of the host.
using PairOfSums [[gnu::vector_size(16), gnu::aligned(8), gnu::may_alias]] = std::uint64_t;
inline PairOfSums& pair(std::uint64_t* first) { return *reinterpret_cast<PairOfSums*>(first); }
inline const PairOfSums& pair(const std::uint64_t* first) {
  return *reinterpret_cast<const PairOfSums*>(first);
}

/// Picoseconds by culprit, of the requests of one master and direction.
struct Waits {
  std::array<std::uint64_t, kCulprits> ps{};
  void add(Culprit c, std::uint64_t t) { ps[index(c)] += t; }
  void take_back(Culprit c, std::uint64_t t) { ps[index(c)] -= t; }
  /// What was added to a sum of each master between two readings of it.
  void add_masters(const std::uint64_t* after, const std::uint64_t* before) {
    std::size_t m = 0;
    for (; m + 2 <= kMasterCount; m += 2) pair(&ps[m]) += pair(&after[m]) - pair(&before[m]);
    if (m < kMasterCount) ps[m] += after[m] - before[m];
  }
};
struct MasterWaits {
  Waits read, write;
};
using WaitTable = std::array<MasterWaits, kMasterCount>;

}  // namespace fovea
