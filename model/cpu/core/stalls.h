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
    clocks_[index(cause) * kOfCause + region * kStallCulprits + culprit] += clocks;
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

/// Splits `clocks` by what a transaction waited for, in the proportion of its picoseconds, and calls
/// f(culprit, clocks) so that the parts add up exactly. What the parts leave of `span` is service.
template <class F>
void split_clocks(std::uint64_t clocks, const RequestWaits& parts, std::uint64_t span, F f) {
  if (clocks == 0) return;
  std::uint64_t named = 0;
  parts.each([&named](Culprit, std::uint64_t ps) { named += ps; });
  const std::uint64_t whole = named > span ? named : span;
  // Clocks in a picosecond * 2^33: what is lost in all of `whole` is less than half a clock.
  const bool small = (whole | clocks) >> 31 == 0;
  const std::uint64_t rate = small ? (clocks << 33) / whole : 0;
  std::uint64_t passed = 0, given = 0;
  const auto give = [&](Culprit c, std::uint64_t ps) {
    if (ps == 0) return;
    passed += ps;
    // To the nearest clock on the way, so that no part is favoured.
    using Wide = unsigned __int128;
    const std::uint64_t until =
        small ? (passed * rate + (std::uint64_t{1} << 32)) >> 33
              : static_cast<std::uint64_t>((Wide{2} * passed * clocks + whole) / (Wide{2} * whole));
    if (until > given) f(index(c), until - given);
    given = until;
  };
  parts.each(give);
  if (given < clocks) f(index(Culprit::kService), clocks - given);
}

}  // namespace fovea::cpu
