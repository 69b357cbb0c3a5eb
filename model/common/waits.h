// Who or what a memory request waited for: every picosecond from its issue to its outcome.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "model/common/masters.h"

namespace fovea {

/// The masters come first, by their numbers: the time in which they were served instead. A master's
/// own number is the wait behind its own earlier requests.
enum class Culprit : std::uint8_t {
  kBridge = kMasterCount,  ///< between port and crossbar, both ways, with the edges waited for
  kService,                ///< its own way through crossbar, controller and return channel
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
/// Names as they appear in statistics; masters have theirs.
inline constexpr std::array<std::string_view, kCulprits> kCulpritNames = [] {
  std::array<std::string_view, kCulprits> names;
  for (const MasterInfo& r : kMasters.rows) names[index(culprit(r.id))] = r.name;
  names[index(Culprit::kBridge)] = "bridge";
  names[index(Culprit::kService)] = "service";
  names[index(Culprit::kRowMiss)] = "row_miss";
  names[index(Culprit::kRowConflict)] = "row_conflict";
  names[index(Culprit::kTurnaround)] = "turnaround";
  names[index(Culprit::kRefresh)] = "refresh";
  names[index(Culprit::kPowerDown)] = "power_down";
  return names;
}();
static_assert([] {
  for (const std::string_view name : kCulpritNames)
    if (name.empty()) return false;
  return true;
}());
constexpr std::string_view culprit_name(Culprit c) { return kCulpritNames[index(c)]; }

/// In `ddr.<label>.wait.<direction>.<name>` taken already: no label of a master in a trace.
constexpr bool is_culprit_name(std::string_view name) {
  for (std::size_t c = kMasterCount; c < kCulprits; ++c)
    if (name == culprit_name(static_cast<Culprit>(c))) return true;
  return name == "own";
}

/// Two neighbouring sums as one vector of the host. The sums are aligned to 8 bytes only, so they
/// are copied, never referred to as a vector: compilers may assume that a vector is aligned to 16.
using PairOfSums [[gnu::vector_size(16)]] = std::uint64_t;
inline PairOfSums load_pair(const std::uint64_t* first) {
  PairOfSums pair;
  std::memcpy(&pair, first, sizeof pair);
  return pair;
}
inline void store_pair(std::uint64_t* first, PairOfSums pair) {
  std::memcpy(first, &pair, sizeof pair);
}

/// Picoseconds by culprit, of the requests of one master and direction.
struct Waits {
  std::array<std::uint64_t, kCulprits> ps{};
  void add(Culprit c, std::uint64_t t) { ps[index(c)] += t; }
  void take_back(Culprit c, std::uint64_t t) { ps[index(c)] -= t; }
  /// What was added to a sum of each master between two readings of it.
  void add_masters(const std::uint64_t* after, const std::uint64_t* before) {
    std::size_t m = 0;
    for (; m + 2 <= kMasterCount; m += 2)
      store_pair(&ps[m], load_pair(&ps[m]) + (load_pair(&after[m]) - load_pair(&before[m])));
    if (m < kMasterCount) ps[m] += after[m] - before[m];
  }
};
struct MasterWaits {
  Waits read, write;
};
/// The same of one request, for a master that asks (MemRequest::parts).
class RequestWaits {
 public:
  void clear() { used_ = 0, total_ = 0; }
  void add(Culprit c, std::uint64_t t) {
    const std::uint32_t bit = 1u << index(c);
    ps_[index(c)] = (used_ & bit ? ps_[index(c)] : 0) + t;
    used_ |= bit;
    total_ += t;
  }
  /// clear(), and two different ones to begin with.
  void begin(Culprit a, std::uint64_t of_a, Culprit b, std::uint64_t of_b) {
    ps_[index(a)] = of_a;
    ps_[index(b)] = of_b;
    used_ = 1u << index(a) | 1u << index(b);
    total_ = of_a + of_b;
  }
  std::uint64_t total() const { return total_; }
  std::uint64_t ps(Culprit c) const { return used_ >> index(c) & 1u ? ps_[index(c)] : 0; }
  /// Calls f(culprit, picoseconds) for those that were added, in their order.
  template <class F>
  void each(F f) const {
    each_of(used_, f);
  }
  /// The same without Culprit::kService.
  template <class F>
  void each_but_service(F f) const {
    each_of(used_ & ~(1u << index(Culprit::kService)), f);
  }

 private:
  template <class F>
  void each_of(std::uint32_t set, F f) const {
    for (; set; set &= set - 1) {
      const auto c = static_cast<std::size_t>(std::countr_zero(set));
      f(static_cast<Culprit>(c), ps_[c]);
    }
  }

  std::uint32_t used_ = 0;  // one bit per culprit; the others' entries mean nothing
  std::uint64_t total_ = 0;
  std::array<std::uint64_t, kCulprits> ps_;
  static_assert(kCulprits <= 32);
};
using WaitTable = std::array<MasterWaits, kMasterCount>;

}  // namespace fovea
