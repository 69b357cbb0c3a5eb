// Clocks of stalls by cause, region of the address, and culprit.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string_view>

#include "model/common/waits.h"
#include "model/cpu/core/regions.h"

namespace fovea::cpu {

/// The causes of stalls, the one list of them: X(constant, name in cpu.stall.NAME, sentence of that statistic, words
/// beside a bar of a chart, words that follow "waits for", whether others than the core may be to blame). A new row
/// comes last (model/howto/add-a-stall-cause.md).
#define FOVEA_STALL_CAUSES(X)                                                                             \
  X(kInterlock, "interlock", "clocks waiting for a register",                                             \
    "interlocks", "results of earlier instructions (interlocks)", false)                                  \
  X(kIcache, "icache", "clocks waiting for line fills of the I-cache",                                    \
    "I-cache fills", "I-cache line fills", true)                                                          \
  X(kDcache, "dcache", "clocks waiting for line fills of the D-cache",                                    \
    "D-cache fills", "D-cache line fills", true)                                                          \
  X(kWriteBuffer, "write_buffer", "clocks waiting for room in the write or victim buffer",                \
    "write buffer full", "room in the write buffer", true)                                                \
  X(kUncached, "uncached", "clocks waiting for uncached reads and fetches and for unbuffered writes",     \
    "uncached accesses", "uncached accesses", true)                                                       \
  X(kTlb, "tlb", "clocks waiting for page walks", "page walks", "page walks", true)                       \
  X(kTcm, "tcm", "clocks of wait states of internal RAM, and waiting for DMA there",                      \
    "internal RAM", "internal RAM", true)                                                                 \
  X(kCacheOp, "cache_op", "clocks of cache maintenance", "cache maintenance", "cache maintenance", true)  \
  X(kDrain, "drain", "clocks waiting for the write buffer to drain",                                      \
    "draining writes", "the write buffer to drain", true)                                                 \
  X(kBusSync, "bus_sync", "clocks waiting for an AHB clock edge, or for the first edge of another clock", \
    "bus clock edge", "an edge of the bus clock", false)                                                  \
  /* the end */
#define FOVEA_CONSTANT(constant, ...) constant,
enum class Cause : std::uint8_t { FOVEA_STALL_CAUSES(FOVEA_CONSTANT) kCount };
#undef FOVEA_CONSTANT
/// Places in tables by cause: a few more than there are causes, so that one more changes the shape of no table.
inline constexpr std::size_t kCauses = 12;
static_assert(static_cast<std::size_t>(Cause::kCount) <= kCauses, "tables by cause need more places");
constexpr std::size_t index(Cause c) { return static_cast<std::size_t>(c); }

struct CauseInfo {
  Cause cause;
  const char* name;       ///< in cpu.stall.NAME
  const char* sentence;   ///< of that statistic
  const char* label;      ///< "D-cache fills", beside a bar
  const char* waits_for;  ///< "D-cache line fills", to follow "waits for"
  bool others;            ///< others may be the culprit; of the rest it is always the core
};
/// Of all causes, in the order of the enumeration. In stalls.cpp alone, so that a program can have another table.
extern const std::span<const CauseInfo> kCauseTable;
inline const char* cause_name(Cause c) { return kCauseTable[index(c)].name; }

/// What ended a sleep: an interrupt of one of these.
enum class WakeEvent : std::uint8_t { kDma, kEngine, kCapture, kDisplay, kTimer, kOther, kCount };
inline constexpr std::size_t kWakeEvents = static_cast<std::size_t>(WakeEvent::kCount);
/// The events, in their order: the name in statistics, the blocks of the chip, and who that is for people.
struct WakeInfo {
  WakeEvent event;
  const char *name, *blocks, *who;
};
inline constexpr std::array kWakeTable = {
    WakeInfo{WakeEvent::kDma, "dma", "EDMA", "the EDMA"},
    WakeInfo{WakeEvent::kEngine, "engine", "remap engine", "the remap engine"},
    WakeInfo{WakeEvent::kCapture, "capture", "video front end", "the camera"},
    WakeInfo{WakeEvent::kDisplay, "display", "display", "the display"},
    WakeInfo{WakeEvent::kTimer, "timer", "timers", "a timer"},
    WakeInfo{WakeEvent::kOther, "other", "other blocks", "another block"}};
static_assert(kWakeTable.size() == kWakeEvents);
static_assert([] {
  for (std::size_t k = 0; k < kWakeEvents; ++k)
    if (static_cast<std::size_t>(kWakeTable[k].event) != k) return false;
  return true;
}());

/// Culprits of a stall: those of a bus transaction, and the core itself (interlocks, wait states,
/// waiting for an edge of the AHB clock, the path from the AHB into the core).
inline constexpr std::size_t kCore = kCulprits, kStallCulprits = kCulprits + 1;
/// The transfer itself, including the words after the first one.
inline constexpr std::size_t kService = index(Culprit::kService);
constexpr std::string_view stall_culprit_name(std::size_t culprit) {
  return culprit == kCore ? "core" : culprit_name(static_cast<Culprit>(culprit));
}

/// Stalled clocks by cause, region and culprit. Interlocks are not included: the running chain of
/// instructions counts them by itself. Values are stored as fractions of a clock (2^-24), so that a
/// stall is split with one division, and rounded to whole clocks when they are read. The limit is
/// 2^40 clocks for one cause and region.
class StallTable {
 public:
  bool operator==(const StallTable&) const = default;
  /// Whole clocks of one culprit. The boundaries between the culprits are rounded, so the sum is
  /// exact.
  std::uint64_t at(Cause cause, std::size_t region, std::size_t culprit) const {
    return at(cause, region, culprit, empty());
  }
  /// The same for what was added since the table was `from`. As a difference of two rounded shares,
  /// the result may be below zero (it wraps around).
  std::uint64_t at(Cause cause, std::size_t region, std::size_t culprit,
                   const StallTable& from) const {
    const std::size_t first = slot(cause, region, 0);
    Parts before = 0;
    for (std::size_t k = first; k < first + culprit; ++k) before += parts_[k] - from.parts_[k];
    const Parts own = parts_[first + culprit] - from.parts_[first + culprit];
    return rounded(before + own) - rounded(before);
  }
  void add(Cause cause, std::size_t region, std::size_t culprit, std::uint64_t clocks) {
    add(&parts_[slot(cause, region, 0)], culprit, clocks);
  }
  /// Splits `clocks` in proportion to the picoseconds that a transaction waited for each culprit.
  /// The part of `span` without waits, and rounding errors, are attributed to kService. `own`
  /// further clocks are attributed to the core.
  [[gnu::always_inline]] void split(Cause cause, std::size_t region, std::uint64_t clocks,
                                    const RequestWaits& waits, std::uint64_t span,
                                    std::uint64_t own = 0) {
    split(&parts_[slot(cause, region, 0)], clocks, waits, span, own);
  }

  // The same for the culprits of one cause and region, for tables of other shapes.
  using Parts = std::uint64_t;
  using Shares = std::array<Parts, kStallCulprits>;
  static void add(Parts* row, std::size_t culprit, std::uint64_t clocks) {
    row[culprit] += clocks << kFraction;
  }
  static std::uint64_t whole(const Parts* row, std::size_t culprit) {
    const Parts before = std::accumulate(row, row + culprit, Parts{0});
    return rounded(before + row[culprit]) - rounded(before);
  }
  [[gnu::always_inline]] static void split(Parts* row, std::uint64_t clocks,
                                           const RequestWaits& waits, std::uint64_t span,
                                           std::uint64_t own) {
    row[kCore] += own << kFraction;
    if (clocks == 0) return;
    const std::uint64_t whole = std::max(waits.total(), span);
    const Parts all = clocks << kFraction;
    Parts left = all;
    if (whole == 0) {
    } else if (whole >> 20 == 0) {  // up to a microsecond, the error stays below a tenth of a clock
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
  /// Sum over all regions.
  std::uint64_t by(Cause cause, std::size_t culprit) const {
    return by(cause, culprit, empty());
  }
  std::uint64_t by(Cause cause, std::size_t culprit, const StallTable& from) const {
    std::uint64_t sum = 0;
    for (std::size_t r = 0; r < RegionMap::kMax; ++r) sum += at(cause, r, culprit, from);
    return sum;
  }
  /// Sum over all regions and culprits.
  std::uint64_t total(Cause cause) const {
    const auto first = parts_.begin() + slot(cause, 0, 0);
    return std::accumulate(first, first + kOfCause, Parts{0}) >> kFraction;
  }

 private:
  static const StallTable& empty() {
    static const StallTable table;
    return table;
  }
  static constexpr unsigned kFraction = 24;
  static constexpr std::size_t kOfCause = RegionMap::kMax * kStallCulprits;
  static constexpr std::size_t slot(Cause cause, std::size_t region, std::size_t culprit) {
    return index(cause) * kOfCause + region * kStallCulprits + culprit;
  }
  static std::uint64_t rounded(Parts p) { return (p + (Parts{1} << (kFraction - 1))) >> kFraction; }

  // Aligned because g++ 12 assumes this alignment when it vectorises sums over the table.
  alignas(16) std::array<Parts, kCauses * kOfCause> parts_{};
};

}  // namespace fovea::cpu
