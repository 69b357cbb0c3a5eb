// The D-cache with its line fill, and the hints that make a hit one comparison.
#pragma once
#include <array>
#include <cstdint>
#include <cstring>

#include "model/common/check.h"
#include "model/common/observers.h"
#include "model/cpu/core/cache.h"
#include "model/cpu/core/data_bus.h"
#include "model/cpu/core/line_watch.h"
#include "model/cpu/core/mmu.h"
#include "model/cpu/core/stall_ledger.h"
#include "model/cpu/core/system_registers.h"

namespace fovea::cpu {

class DataCache {
 public:
  /// An address range that the core may read or write without further checks: translation,
  /// permission and cache tag were valid when the hint was made, and whatever could change them
  /// removes the hint. A write hint covers half a line whose dirty bit is set.
  struct Hint {
    std::uint32_t key = kNoHint;  // virtual address of its first byte
    std::uint32_t counter = 0;    // offset in Counts of the counter of these accesses, in bytes
    std::uintptr_t bias = 0;      // host address of the byte at VA is bias + VA
  };
  static constexpr std::uint32_t kNoHint = 4;  // no aligned address has this bit
  static constexpr unsigned kHints = 256, kReadSpan = 32, kWriteSpan = 16;

  DataCache(std::uint64_t bytes, StallLedger& ledger, DataBus& bus, const SystemRegisters& registers,
            const DiagnosticsRef& diagnostics)
      : ledger_(ledger), bus_(bus), registers_(registers), lines_(bytes), diagnostics_(diagnostics) {}
  DataCache(const DataCache&) = delete;
  DataCache& operator=(const DataCache&) = delete;

  /// A cacheable load. @param mva address of its first byte @return host address of that byte
  [[gnu::always_inline]] const std::uint8_t* load(std::uint32_t va, std::uint32_t mva,
                                                  unsigned bytes, const Translation& t) {
    ++ledger_.counts.dcache_reads;
    if (ledger_.cycle < fill.last) wait_for_fill(mva);
    int i = lines_.find(mva);
    if (i < 0) i = fill_line(mva, t.physical(mva), t.bufferable);
    std::uint8_t* const line = lines_.data(static_cast<unsigned>(i));
    // A watched line differs in one of the tag's five lowest bits, so that it needs no branch of its own.
    const Cache::Line& l = lines_.line(static_cast<unsigned>(i));
    if ((l.tag ^ l.watched) == (mva & ~31u))
      hint_reads(va, mva, line, ledger_.counts.dcache_reads);
    else if (l.watched)
      announce_load(static_cast<unsigned>(i), mva & 31u, bytes);
    return line + (mva & 31u);
  }
  /// A cacheable store. @return true if the line is dirty now, so that memory need not be written
  bool store(std::uint32_t va, std::uint32_t mva, unsigned bytes, std::uint32_t value,
             bool write_back_page);
  /// During a fill, words can be used as they arrive; any other access waits for its end.
  void wait_for_fill(std::uint32_t mva) {
    ledger_.stall_to((mva & ~31u) == fill.line ? fill.word(mva) : fill.last, Cause::kDcache,
                     fill.pa, kService);
  }
  /// Stores to a page with this C and B setting stay in a line that the cache holds.
  bool keeps(int line, bool write_back_page) const {
    return line >= 0 && write_back_page && !(registers_.cache_debug & 4u);
  }
  void write_back(unsigned line, Cause cause) { write_back(line, false, cause); }

  /// The same as read_hints[va / kReadSpan % kHints], one host instruction shorter.
  const Hint& read_hint(std::uint32_t va) const {
    static_assert(sizeof(Hint) == 16 && kReadSpan == 2 * sizeof(Hint));
    return *reinterpret_cast<const Hint*>(reinterpret_cast<const char*>(read_hints.data()) +
                                          (va / 2 & (kHints - 1) * sizeof(Hint)));
  }
  /// @param line host address of the line that contains `va`
  /// @param counter member of Counts that counts accesses to it
  void hint_reads(std::uint32_t va, std::uint32_t mva, std::uint8_t* line,
                  std::uint64_t& counter) {
    const std::uint32_t key = va & ~(kReadSpan - 1);
    read_hints[mva / kReadSpan % kHints] = {key, counter_offset(counter),
                                            reinterpret_cast<std::uintptr_t>(line) - key};
    hints_used_ = true;
  }
  void hint_writes(std::uint32_t va, std::uint32_t mva, std::uint8_t* half,
                   std::uint64_t& counter) {
    const std::uint32_t key = va & ~(kWriteSpan - 1);
    write_hints[mva / kWriteSpan % kHints] = {key, counter_offset(counter),
                                              reinterpret_cast<std::uintptr_t>(half) - key};
    hints_used_ = true;
  }
  /// The same for internal RAM; `bytes` is the host address of the range that contains `va`.
  void hint_ram_reads(std::uint32_t va, std::uint32_t mva, std::uint8_t* bytes, std::uint64_t& counter) {
    Hint& hint = read_hints[mva / kReadSpan % kHints];
    if (hint.key != (va & ~(kReadSpan - 1))) note_ram_hint(hint);
    hint_reads(va, mva, bytes, counter);
  }
  void hint_ram_writes(std::uint32_t va, std::uint32_t mva, std::uint8_t* bytes, std::uint64_t& counter) {
    Hint& hint = write_hints[mva / kWriteSpan % kHints];
    if (hint.key != (va & ~(kWriteSpan - 1))) note_ram_hint(hint);
    hint_writes(va, mva, bytes, counter);
  }
  void hint_absent(std::uint32_t va, std::uint32_t pa) {
    absent = {va & ~(kReadSpan - 1), pa & ~(kReadSpan - 1)};
    hints_used_ = true;
  }
  void forget_hints();
  /// Forgets those of internal RAM: others begin to use it, so that each access has to be looked at.
  void forget_ram_hints();
  std::uint32_t counter_offset(const std::uint64_t& counter) const {
    return static_cast<std::uint32_t>(reinterpret_cast<const char*>(&counter) -
                                      reinterpret_cast<const char*>(&ledger_.counts));
  }

  /// Drops all lines, dirty ones too.
  void reset() {
    fill = {};
    lines_.invalidate_all();
    forget_hints();
  }
  Subscription observe(LineWatch& watch) { return observers_.add(&watch); }
  /// Only for observers. A line is watched until as many calls have ended it as have begun it, or until
  /// it is filled again.
  void watch_line(unsigned line, bool on);
  Cache& lines() { return lines_; }
  const Cache& lines() const { return lines_; }

  // Used by the handlers of loads and stores.
  LineFill fill;
  std::array<Hint, kHints> read_hints{}, write_hints{};
  /// A writable, cacheable line that the cache does not hold; valid under the same conditions as a
  /// read hint. Stores to it go to the write buffer.
  struct {
    std::uint32_t key = kNoHint, pa = 0;
  } absent;

 private:
  int fill_line(std::uint32_t mva, std::uint32_t pa, bool write_back_page);
  void drop_hints(std::uint32_t line_mva);
  void forget_absent(std::uint32_t line_mva);
  void write_back(unsigned line, bool before_fill, Cause cause);
  void announce_load(unsigned line, unsigned offset, unsigned bytes);
  void note_ram_hint(Hint& hint) {
    if (ram_hints_used_ > kRamHints) return;
    if (ram_hints_used_ < kRamHints) ram_hints_[ram_hints_used_] = &hint;
    ++ram_hints_used_;
  }

  static constexpr unsigned kRamHints = 64;  // with more of them, all hints are forgotten
  StallLedger& ledger_;
  DataBus& bus_;
  const SystemRegisters& registers_;
  Cache lines_;
  Observers<LineWatch*> observers_;
  bool hints_used_ = false;
  /// Where hints of internal RAM were put; others may have taken their places since.
  std::array<Hint*, kRamHints> ram_hints_{};
  unsigned ram_hints_used_ = 0;
  DiagnosticsRef diagnostics_;
};

}  // namespace fovea::cpu
