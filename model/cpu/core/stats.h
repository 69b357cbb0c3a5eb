// Counters and statistics of the core. Every clock is attributed to one cause.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/common/stats.h"
#include "model/cpu/core/stalls.h"

namespace fovea::cpu {

/// How executed code is fetched: Thumb state + 2 * FetchFrom + 8 if the MMU is on.
enum class FetchFrom : std::uint8_t { kCache, kTcm, kBus };
inline constexpr std::size_t kFetchKinds = 16;
constexpr std::size_t fetch_kind(bool thumb, FetchFrom from, bool mmu) {
  return static_cast<std::size_t>(from) * 2 + thumb + (mmu ? 8 : 0);
}

/// Plain counters since reset. The statistics of a window are the difference of two copies.
struct Counts {
  std::uint64_t instructions = 0, cycles = 0, issue = 0, idle = 0;
  std::array<std::uint64_t, kCauses> stall{};
  std::array<std::uint64_t, kWakeEvents> idle_by{};  // sums to idle
  std::uint64_t redirects = 0;  // taken branches, writes to the pc, exceptions
  std::uint64_t icache_fills = 0;
  std::uint64_t dcache_reads = 0, dcache_read_fills = 0, dcache_writes = 0,
                dcache_write_misses = 0, dcache_writebacks = 0;
  std::uint64_t itcm_reads = 0, itcm_writes = 0, dtcm_reads = 0, dtcm_writes = 0;
  std::uint64_t translated_uncached = 0;  // data accesses that do not use the D-cache, with the MMU
                                          // on
  std::uint64_t tlb_walks = 0, writeback_words = 0, multiplies = 0, coprocessor = 0;
  std::uint64_t i_read_beats = 0, d_read_beats = 0, d_write_beats = 0;
  std::uint64_t exceptions = 0, unpredictable = 0;
  StallTable stalls;

  bool operator==(const Counts&) const = default;
  /// Declares how the instructions from here on are fetched.
  void fetch_from(std::size_t kind) {
    if (kind == kind_) return;
    executed_[kind_] += instructions;
    redirected_[kind_] += redirects;
    kind_ = kind;
    executed_[kind_] -= instructions;
    redirected_[kind_] -= redirects;
  }
  /// Words fetched for executed instructions, plus the two that the pipeline drops at each change
  /// of flow. A word holds two Thumb instructions; on average, one of the two ends of a sequence is
  /// assumed to be in the middle of a word.
  std::uint64_t words_fetched(FetchFrom from, bool mmu) const {
    const std::size_t arm = fetch_kind(false, from, mmu), thumb = fetch_kind(true, from, mmu);
    return executed(arm) + 2 * redirected(arm) + (executed(thumb) + 3 * redirected(thumb)) / 2;
  }
  std::uint64_t words_fetched(FetchFrom from) const {
    return words_fetched(from, false) + words_fetched(from, true);
  }
  std::uint64_t icache_accesses() const { return words_fetched(FetchFrom::kCache); }
  std::uint64_t tlb_lookups() const {
    return words_fetched(FetchFrom::kCache, true) + words_fetched(FetchFrom::kBus, true) +
           words_fetched(FetchFrom::kTcm, true) + dcache_reads + dcache_writes +
           translated_uncached + translated_ram();
  }
  /// Declares that the MMU is on or off from here on.
  void translate(bool on) {
    if (on == translating_) return;
    translating_ = on;
    translated_ram_ += on ? 0 - ram_accesses() : ram_accesses();
  }

  /// Clocks stalled since the counters had the values `from`.
  std::uint64_t stalled(Cause cause, std::size_t region, std::size_t culprit,
                        const Counts& from) const {
    if (cause != Cause::kInterlock) return stalls.at(cause, region, culprit, from.stalls);
    return region == RegionMap::kNone && culprit == kCore
               ? stall[index(cause)] - from.stall[index(cause)]
               : 0;
  }
  /// The first cause whose clocks do not equal the sum over its regions and culprits; kCount: none.
  Cause unexplained() const {
    for (std::size_t k = 0; k < index(Cause::kCount); ++k) {
      const auto cause = static_cast<Cause>(k);
      if (cause != Cause::kInterlock && stalls.total(cause) != stall[k]) return cause;
    }
    return Cause::kCount;
  }

 private:
  std::uint64_t ram_accesses() const {
    return itcm_reads + itcm_writes + dtcm_reads + dtcm_writes;
  }
  /// Loads and stores in internal RAM with the MMU on. While it is on, translated_ram_ holds the
  /// number minus the counters' current values.
  std::uint64_t translated_ram() const {
    return translated_ram_ + (translating_ ? ram_accesses() : 0);
  }
  std::uint64_t translated_ram_ = 0;
  bool translating_ = false;
  // By kind of fetch. The current kind's entry is stored minus the current counters.
  std::array<std::uint64_t, kFetchKinds> executed_{}, redirected_{};
  std::size_t kind_ = 0;
  std::uint64_t executed(std::size_t kind) const {
    return executed_[kind] + (kind == kind_ ? instructions : 0);
  }
  std::uint64_t redirected(std::size_t kind) const {
    return redirected_[kind] + (kind == kind_ ? redirects : 0);
  }
};

/// Statistics of the measurement window, under their public names.
struct CoreStats : StatGroup {
  Counts from, to;
  using V = StatBase::Value;
  template <class F>
  struct Delta : Formula {
    Delta(CoreStats& g, const char* name, const char* unit, const char* sentence, F f)
        : Formula(g, name, unit, sentence, [&g, f] { return V(f(g.to) - f(g.from)); }) {}
  };
#define FOVEA_CPU_STAT(member, name, unit, field, sentence)                              \
  Formula member {                                                                       \
    *this, name, unit, sentence, [this] { return V(to.field - from.field); }             \
  }
  FOVEA_CPU_STAT(instructions, "instructions", "1", instructions, "instructions executed");
  FOVEA_CPU_STAT(cycles, "cycles", "cycles", cycles, "core clocks of the window");
  FOVEA_CPU_STAT(issue, "issue", "cycles", issue, "clocks in which instructions issue");
  FOVEA_CPU_STAT(idle, "idle", "cycles", idle, "clocks in wait-for-interrupt");
  std::vector<std::unique_ptr<Formula>> idle_by = idle_by_event();
  std::vector<std::unique_ptr<Formula>> stalls = stalls_by_cause();
  FOVEA_CPU_STAT(icache_accesses, "icache.accesses", "1", icache_accesses(),
                 "words looked up in the I-cache, with two dropped behind each change of flow");
  FOVEA_CPU_STAT(icache_fills, "icache.line_fills", "1", icache_fills,
                 "lines read into the I-cache");
  FOVEA_CPU_STAT(dcache_reads, "dcache.reads", "1", dcache_reads, "cacheable loads looked up");
  FOVEA_CPU_STAT(dcache_fills, "dcache.read_line_fills", "1", dcache_read_fills,
                 "lines read into the D-cache");
  FOVEA_CPU_STAT(dcache_writes, "dcache.writes", "1", dcache_writes, "cacheable stores looked up");
  FOVEA_CPU_STAT(dcache_write_misses, "dcache.write_misses", "1", dcache_write_misses,
                 "cacheable stores that missed");
  FOVEA_CPU_STAT(dcache_writebacks, "dcache.writebacks", "1", dcache_writebacks,
                 "dirty half or whole lines written back");
  FOVEA_CPU_STAT(exceptions, "exceptions", "1", exceptions, "exceptions taken");
  FOVEA_CPU_STAT(unpredictable, "unpredictable", "1", unpredictable,
                 "instructions with an UNPREDICTABLE encoding");
  // Further inputs of a power model; issue, idle, cache accesses and fills are above.
  FOVEA_CPU_STAT(itcm_fetches, "activity.itcm_fetches", "1", words_fetched(FetchFrom::kTcm),
                 "words fetched from internal RAM, with two dropped behind each change of flow");
  FOVEA_CPU_STAT(itcm_reads, "activity.itcm_reads", "1", itcm_reads,
                 "loads of a word or less through the ITCM window");
  FOVEA_CPU_STAT(itcm_writes, "activity.itcm_writes", "1", itcm_writes,
                 "stores of a word or less through the ITCM window");
  FOVEA_CPU_STAT(dtcm_reads, "activity.dtcm_reads", "1", dtcm_reads,
                 "loads of a word or less through the DTCM window");
  FOVEA_CPU_STAT(dtcm_writes, "activity.dtcm_writes", "1", dtcm_writes,
                 "stores of a word or less through the DTCM window");
  FOVEA_CPU_STAT(writeback_words, "activity.writeback_words", "1", writeback_words,
                 "words of dirty lines moved to the victim buffer");
  FOVEA_CPU_STAT(tlb_lookups, "activity.tlb_lookups", "1", tlb_lookups(),
                 "words fetched and data accesses with the MMU on");
  FOVEA_CPU_STAT(tlb_walks, "activity.tlb_walks", "1", tlb_walks, "page walks begun");
  FOVEA_CPU_STAT(i_read_beats, "activity.ahb_i_read_beats", "1", i_read_beats,
                 "beats asked for on the instruction AHB");
  FOVEA_CPU_STAT(d_read_beats, "activity.ahb_d_read_beats", "1", d_read_beats,
                 "beats of reads asked for on the data AHB");
  FOVEA_CPU_STAT(d_write_beats, "activity.ahb_d_write_beats", "1", d_write_beats,
                 "beats of writes: as they enter the write or victim buffer, or pass them");
  FOVEA_CPU_STAT(multiplies, "activity.multiplies", "1", multiplies,
                 "instructions that use the multiplier");
  FOVEA_CPU_STAT(coprocessor, "activity.coprocessor", "1", coprocessor,
                 "transfers to and from CP15");
  FOVEA_CPU_STAT(redirects, "activity.redirects", "1", redirects,
                 "changes of flow: branches taken, writes to the pc, exceptions");
#undef FOVEA_CPU_STAT
  CoreStats() : StatGroup("cpu") { add_stalls_by_culprit(); }

 private:
  std::vector<std::unique_ptr<Formula>> idle_by_event() {
    std::vector<std::unique_ptr<Formula>> out;
    for (std::size_t k = 0; k < kWakeEvents; ++k) {
      const std::string event = kWakeTable[k].name;
      out.push_back(std::make_unique<Formula>(
          *this, "idle." + event, "cycles",
          event == "other" ? "clocks of cpu.idle that any other interrupt, a reset or nothing ended"
                           : "clocks of cpu.idle that ended with an interrupt of the " +
                                 std::string(kWakeTable[k].blocks),
          [this, k] { return V(to.idle_by[k] - from.idle_by[k]); }));
    }
    return out;
  }
  std::vector<std::unique_ptr<Formula>> stalls_by_cause() {
    std::vector<std::unique_ptr<Formula>> out;
    for (const CauseInfo& info : kCauseTable)
      out.push_back(std::make_unique<Formula>(
          *this, "stall." + std::string(info.name), "cycles", info.sentence,
          [this, k = index(info.cause)] { return V(to.stall[k] - from.stall[k]); }));
    return out;
  }
  void add_stalls_by_culprit() {
    for (const CauseInfo& info : kCauseTable) {
      if (!info.others) continue;
      const std::string name = info.name;
      for (std::size_t c = 0; c < kStallCulprits; ++c) {
        const std::string culprit(stall_culprit_name(c));
        by_culprit_.push_back(std::make_unique<Formula>(
            *this, "stall." + name + ".by." + culprit, "cycles",
            "clocks of cpu.stall." + name + " for which " + culprit + " is to blame",
            [this, cause = info.cause, c] { return V(to.stalls.by(cause, c, from.stalls)); }));
      }
    }
  }

  std::vector<std::unique_ptr<Formula>> by_culprit_;
};

}  // namespace fovea::cpu
