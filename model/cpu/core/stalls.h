// Stalled clocks by cause, by the region of the address and by the culprit.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "model/common/waits.h"
#include "model/cpu/core/regions.h"

namespace fovea::cpu {

enum class Cause : std::uint8_t {
  kInterlock, kIcache, kDcache, kWriteBuffer, kUncached, kTlb, kTcm, kCacheOp, kDrain, kBusSync,
  kCount
};
inline constexpr std::size_t kCauses = static_cast<std::size_t>(Cause::kCount);
inline constexpr std::array<const char*, kCauses> kCauseNames = {
    "interlock", "icache", "dcache", "write_buffer", "uncached",
    "tlb",       "tcm",    "cache_op", "drain",      "bus_sync"};
constexpr std::size_t index(Cause c) { return static_cast<std::size_t>(c); }

/// Those of a bus transaction, and the core itself: interlocks, wait states, edges of the AHB clock,
/// the way from the AHB into the core.
inline constexpr std::size_t kCore = kCulprits, kStallCulprits = kCulprits + 1;
/// The transfer itself, behind its first word as well.
inline constexpr std::size_t kService = index(Culprit::kService);
constexpr std::string_view stall_culprit_name(std::size_t culprit) {
  return culprit == kCore ? "core" : culprit_name(static_cast<Culprit>(culprit));
}
/// Causes that wait for bus transactions; the others have but one culprit, the core.
constexpr bool waits_for_bus(Cause c) {
  return c != Cause::kInterlock && c != Cause::kTcm && c != Cause::kBusSync;
}

/// Interlocks, which the running chain of instructions counts by itself, are not in here.
class StallTable {
 public:
  bool operator==(const StallTable&) const = default;
  std::uint64_t at(Cause cause, std::size_t region, std::size_t culprit) const {
    return clocks_[index(cause) * kOfCause + region * kStallCulprits + culprit];
  }
  void add(Cause cause, std::size_t region, std::size_t culprit, std::uint64_t clocks) {
    row(cause, region)[culprit] += clocks;
  }
  /// The culprits of a cause and region.
  std::uint64_t* row(Cause cause, std::size_t region) {
    return &clocks_[index(cause) * kOfCause + region * kStallCulprits];
  }
  /// Over all regions.
  std::uint64_t by(Cause cause, std::size_t culprit) const {
    std::uint64_t sum = 0;
    for (std::size_t r = 0; r < RegionMap::kMax; ++r) sum += at(cause, r, culprit);
    return sum;
  }
  /// Over all regions and culprits.
  std::uint64_t total(Cause cause) const {
    const auto first = clocks_.begin() + index(cause) * kOfCause;
    return std::accumulate(first, first + kOfCause, std::uint64_t{0});
  }

 private:
  static constexpr std::size_t kOfCause = RegionMap::kMax * kStallCulprits;
  // Aligned: g++ 12 takes the table for it when it vectorises sums.
  alignas(16) std::array<std::uint64_t, kCauses * kOfCause> clocks_{};
};

/// Splits `clocks` by what a transaction waited for in `span`, in the proportion of its picoseconds,
/// and calls f(culprit, clocks) so that the parts add up exactly. What is left of the span is
/// service; parts beyond it count for nothing.
template <class F>
[[gnu::always_inline]] inline void split_clocks(std::uint64_t clocks, const RequestWaits& parts,
                                                std::uint64_t span, F f) {
  using Wide = unsigned __int128;
  const bool small = (span | clocks) >> 31 == 0;
  std::uint64_t passed = 0, given = 0;
  parts.each([&](Culprit c, std::uint64_t ps) {
    passed = std::min(passed + ps, span);
    if (passed == 0) return;
    // To the nearest clock on the way, so that no part is favoured.
    const std::uint64_t until =
        small ? (2 * passed * clocks + span) / (2 * span)
              : static_cast<std::uint64_t>((Wide{2} * passed * clocks + span) / (Wide{2} * span));
    f(index(c), until - given);
    given = until;
  });
  if (clocks != given) f(kService, clocks - given);
}

}  // namespace fovea::cpu
