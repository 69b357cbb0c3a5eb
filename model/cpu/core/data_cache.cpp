#include "model/cpu/core/data_cache.h"

#include <algorithm>

#include "model/common/check.h"

namespace fovea::cpu {

void DataCache::forget_hints() {
  if (!hints_used_) return;
  hints_used_ = false;
  for (auto* hints : {&read_hints, &write_hints})
    for (auto& h : *hints) h.key = kNoHint;
  absent.key = kNoHint;
  ram_hints_used_ = 0;
}

void DataCache::forget_ram_hints() {
  if (ram_hints_used_ > kRamHints) return forget_hints();
  for (unsigned k = 0; k < ram_hints_used_; ++k) ram_hints_[k]->key = kNoHint;
  ram_hints_used_ = 0;
}

/// To be called when a line comes into the cache. The hint is by virtual address, and FCSE may have changed
/// the upper seven bits of one of the two: those do not count.
void DataCache::forget_absent(std::uint32_t line_mva) {
  constexpr std::uint32_t kKnown = 0x01FFFFE0;
  if (((absent.key ^ line_mva) & kKnown) == 0) absent.key = kNoHint;
}

/// To be called when a line changes its contents.
void DataCache::drop_hints(std::uint32_t line_mva) {
  // FCSE changes only address bits that do not select the hint.
  read_hints[line_mva / kReadSpan % kHints].key = kNoHint;
  for (unsigned half = 0; half < 2; ++half)
    write_hints[(line_mva / kWriteSpan + half) % kHints].key = kNoHint;
}

/// @return index of the line; after a bus error, that line is invalid
int DataCache::fill_line(std::uint32_t mva, std::uint32_t pa, bool write_back_page) {
  const std::uint64_t asked = bus_.asked_now();
  ledger_.stall_to(fill.last, Cause::kDcache, fill.pa, kService);
  const unsigned index = lines_.victim(lines_.set_of(mva), registers_.control & kRoundRobin,
                                       registers_.dlock & 15u);
  if (lines_.line(index).tag != 1) drop_hints(lines_.line(index).tag);
  bus_.run_buffers(ledger_.cycle);
  write_back(index, true, Cause::kWriteBuffer);
  const bool good = bus_.read_line(pa, asked, Cause::kDcache);
  ++ledger_.counts.dcache_read_fills;
  Cache::Line& l = lines_.line(index);
  if (!good) {  // linefills cannot abort on this core: the line is simply not kept
    lines_.invalidate(index);
    diagnostics_.guest("bus error on a D-cache line fill");
    std::memset(lines_.data(index), 0, 32);
    return static_cast<int>(index);
  }
  std::memcpy(lines_.data(index), bus_.data(), 32);
  forget_absent(mva);
  l.tag = mva & ~31u;
  l.pa = pa & ~31u;
  l.dirty = 0;
  l.write_back = write_back_page;
  l.watched = 0;
  fill = {mva & ~31u, (pa >> 2) & 7u, pa, ledger_.cycle,
          std::max(ledger_.cycle, bus_.last_word())};
  if (!observers_.empty()) [[unlikely]] {
    bus_.let_others_act();  // what they did while the line came must not depend on who is ahead
    observers_.each([index](LineWatch* w) { w->filled(index); });
  }
  return static_cast<int>(index);
}

void DataCache::write_back(unsigned line, bool before_fill, Cause cause) {
  const unsigned halves = lines_.line(line).dirty;
  bus_.write_back(lines_, line, before_fill, cause);
  if (halves && !observers_.empty()) [[unlikely]]
    observers_.each([=](LineWatch* w) { w->written_back(line, halves); });
}

void DataCache::announce_load(unsigned line, unsigned offset, unsigned bytes) {
  observers_.each([=](LineWatch* w) { w->loaded(line, offset, bytes); });
}

void DataCache::watch_line(unsigned line, bool on) {
  Cache::Line& l = lines_.line(line);
  if (on) {
    ++l.watched;
    drop_hints(l.tag);
  } else if (l.watched) {
    --l.watched;
  }
}

bool DataCache::store(std::uint32_t va, std::uint32_t mva, unsigned bytes, std::uint32_t value,
                      bool write_back_page) {
  ++ledger_.counts.dcache_writes;
  if (ledger_.cycle < fill.last) wait_for_fill(mva);
  const int i = lines_.find(mva);
  if (i < 0) {
    ++ledger_.counts.dcache_write_misses;
    return false;
  }
  const auto line = static_cast<unsigned>(i);
  std::memcpy(lines_.data(line) + (mva & 31u), &value, bytes);
  if (!observers_.empty()) [[unlikely]]
    observers_.each([=](LineWatch* w) { w->stored(line, mva & 31u, bytes); });
  if (!keeps(i, write_back_page)) return false;
  lines_.line(line).dirty |= static_cast<std::uint8_t>(1u << ((mva >> 4) & 1u));
  if (!lines_.line(line).watched) [[likely]]
    hint_writes(va, mva, lines_.data(line) + (mva & 16u), ledger_.counts.dcache_writes);
  return true;
}

}  // namespace fovea::cpu
