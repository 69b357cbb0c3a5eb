// Stalled clocks by cause, by the region of the address and by the culprit.
#pragma once
#include <algorithm>
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
/// Causes that may wait for others; the rest have but one culprit, the core.
constexpr bool waits_for_others(Cause c) {
  return c != Cause::kInterlock && c != Cause::kBusSync;
}

/// Interlocks, which the running chain of instructions counts by itself, are not in here. Kept in
/// parts of a clock, so that a stall is split by one division; whole clocks are made when they are
/// read. Good for 2^40 clocks of a cause and region.
class StallTable {
 public:
  bool operator==(const StallTable&) const = default;
  /// Each end of a culprit's share is rounded, so that whole clocks add up exactly.
  std::uint64_t at(Cause cause, std::size_t region, std::size_t culprit) const {
    return at(cause, region, culprit, empty());
  }
  /// Of what was added since the table was `from`: the difference of two rounded shares may be less
  /// than nothing.
  std::uint64_t at(Cause cause, std::size_t region, std::size_t culprit,
                   const StallTable& from) const {
    const std::size_t first = place(cause, region, 0);
    Parts before = 0;
    for (std::size_t k = first; k < first + culprit; ++k) before += parts_[k] - from.parts_[k];
    const Parts own = parts_[first + culprit] - from.parts_[first + culprit];
    return rounded(before + own) - rounded(before);
  }
  void add(Cause cause, std::size_t region, std::size_t culprit, std::uint64_t clocks) {
    parts_[place(cause, region, culprit)] += clocks << kFraction;
  }
  /// Splits `clocks` by what a transaction waited for, in the proportion of its picoseconds. What the
  /// waits leave of `span`, and what is lost by rounding, is service as well. `own` clocks more are
  /// the core's.
  [[gnu::always_inline]] void split(Cause cause, std::size_t region, std::uint64_t clocks,
                                    const RequestWaits& waits, std::uint64_t span,
                                    std::uint64_t own = 0) {
    Parts* const row = &parts_[place(cause, region, 0)];
    row[kCore] += own << kFraction;
    if (clocks == 0) return;
    const std::uint64_t whole = std::max(waits.total(), span);
    const Parts all = clocks << kFraction;
    Parts left = all;
    if (whole == 0) {
    } else if (whole >> 20 == 0) {  // a microsecond: the error stays below a tenth of a clock
      const Parts rate = all / whole;
      waits.each_but_service([&](Culprit c, std::uint64_t ps) {
        row[index(c)] += ps * rate;
        left -= ps * rate;
      });
    } else {
      waits.each_but_service([&](Culprit c, std::uint64_t ps) {
        const auto part = static_cast<Parts>(static_cast<unsigned __int128>(ps) * all / whole);
        row[index(c)] += part;
        left -= part;
      });
    }
    row[kService] += left;
  }
  /// Over all regions.
  std::uint64_t by(Cause cause, std::size_t culprit) const {
    return by(cause, culprit, empty());
  }
  std::uint64_t by(Cause cause, std::size_t culprit, const StallTable& from) const {
    std::uint64_t sum = 0;
    for (std::size_t r = 0; r < RegionMap::kMax; ++r) sum += at(cause, r, culprit, from);
    return sum;
  }
  /// Over all regions and culprits.
  std::uint64_t total(Cause cause) const {
    const auto first = parts_.begin() + place(cause, 0, 0);
    return std::accumulate(first, first + kOfCause, Parts{0}) >> kFraction;
  }

 private:
  static const StallTable& empty() {
    static const StallTable table;
    return table;
  }
  using Parts = std::uint64_t;
  static constexpr unsigned kFraction = 24;
  static constexpr std::size_t kOfCause = RegionMap::kMax * kStallCulprits;
  static constexpr std::size_t place(Cause cause, std::size_t region, std::size_t culprit) {
    return index(cause) * kOfCause + region * kStallCulprits + culprit;
  }
  static std::uint64_t rounded(Parts p) { return (p + (Parts{1} << (kFraction - 1))) >> kFraction; }

  // Aligned: g++ 12 takes the table for it when it vectorises sums.
  alignas(16) std::array<Parts, kCauses * kOfCause> parts_{};
};

}  // namespace fovea::cpu
