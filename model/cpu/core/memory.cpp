// Loads, stores and fetches: TCMs, translation, caches.
#include <cstring>

#include "model/cpu/core/fast_path.h"

namespace fovea::cpu {

void Core::flush_memos() {
  for (auto& m : dmemo_) m.page = ~0u;
  for (auto& m : imemo_) m.page = ~0u;
  line_va_ = 1;
  line_epoch_ += kEpoch;
  if (line_epoch_ < kEpoch) [[unlikely]] {  // the numbers start again: no line may keep an old one
    line_epoch_ += kEpoch;
    for (auto* lines : {&decoded_, &tcm_decoded_})
      for (auto& d : *lines)
        if (d.valid) d.valid = 2u | (d.valid & 1u);
  }
  flush_hints();
}

void Core::flush_hints() {
  if (!hints_used_) return;
  hints_used_ = false;
  for (auto* hints : {&read_hints_, &write_hints_})
    for (auto& h : *hints) h.key = kNoHint;
  absent_.key = kNoHint;
}

/// To be called when a line of the D-cache changes its contents.
void Core::drop_hints(std::uint32_t line_mva) {
  // FCSE changes only address bits that do not select the hint.
  read_hints_[line_mva / kReadSpan % kHints].key = kNoHint;
  for (unsigned half = 0; half < 2; ++half)
    write_hints_[(line_mva / kWriteSpan + half) % kHints].key = kNoHint;
}

/// @param line host address of the line that contains `va`
/// @param counter member of counts_ that counts accesses to it
void Core::note_read(std::uint32_t va, std::uint32_t mva, std::uint8_t* line,
                     std::uint64_t& counter) {
  const std::uint32_t key = va & ~(kReadSpan - 1);
  read_hints_[mva / kReadSpan % kHints] = {key, counter_offset(counter),
                                           reinterpret_cast<std::uintptr_t>(line) - key};
  hints_used_ = true;
}
void Core::note_write(std::uint32_t va, std::uint32_t mva, std::uint8_t* half,
                      std::uint64_t& counter) {
  const std::uint32_t key = va & ~(kWriteSpan - 1);
  write_hints_[mva / kWriteSpan % kHints] = {key, counter_offset(counter),
                                             reinterpret_cast<std::uintptr_t>(half) - key};
  hints_used_ = true;
}

void Core::fault(bool instruction, unsigned status, unsigned domain, std::uint32_t address) {
  const std::uint32_t fsr = domain << 4 | status;
  if (instruction) {
    ifsr_ = fsr;
  } else {
    dfsr_ = fsr;
    far_ = address;
  }
}

/// Sets the FAR of a transfer of several words up to `last` that was aborted by the bus: the last
/// word before the 1 KB boundary after the aborted word (ARM DDI 0198D ch. 3, FAR). The words in
/// between are not transferred (assumed).
void Core::external_abort_at(std::uint32_t last) {
  const std::uint32_t status = dfsr_ & 0xFu;
  if (status == 0x8 || status == 0xA) far_ = std::min(far_ | 0x3FCu, modified(last));
}

bool Core::walk_read(std::uint32_t address, std::uint32_t& word) {
  BusAccess& a = data_access_;
  a.kind = BusAccess::Kind::kSingle;
  a.write = a.buffered = a.locked = false;
  a.address = address;
  a.bytes = 4;
  a.asked = asked_now();
  bus_read(a, Cause::kTlb);
  std::memcpy(&word, a.data, 4);
  return !a.error;
}

bool Core::walk(std::uint32_t mva, bool instruction, TlbEntry& out) {
  const std::uint32_t first_level = (ttbr_ & 0xFFFFC000u) | (mva >> 20) << 2;
  ++counts_.tlb_walks;
  stall_to(cycle_ + walk_cycles_, Cause::kTlb, first_level, kCore);
  std::uint32_t d = 0;
  if (!walk_read(first_level, d)) {
    fault(instruction, 0xC, 0, mva);
    return false;
  }
  const unsigned domain = (d >> 5) & 15u;
  out.valid = true;
  out.domain = static_cast<std::uint8_t>(domain);
  const auto same = [&out](unsigned ap) { out.ap.fill(static_cast<std::uint8_t>(ap)); };
  const auto page = [&](std::uint32_t word, std::uint32_t mask) {
    out.mask = mask;
    out.base_va = mva & ~mask;
    out.base_pa = word & ~mask;
    out.cacheable = (word >> 3) & 1u;
    out.bufferable = (word >> 2) & 1u;
  };
  if ((d & 3u) == 2) {
    page(d, 0xFFFFFu);
    out.section = true;
    same((d >> 10) & 3u);
    return true;
  }
  if ((d & 3u) == 0) {
    fault(instruction, 0x5, 0, mva);
    return false;
  }
  const std::uint32_t table = (d & 3u) == 1
                                  ? (d & 0xFFFFFC00u) | ((mva >> 12) & 0xFFu) << 2
                                  : (d & 0xFFFFF000u) | ((mva >> 10) & 0x3FFu) << 2;
  std::uint32_t p = 0;
  if (!walk_read(table, p)) {
    fault(instruction, 0xE, domain, mva);
    return false;
  }
  switch (p & 3u) {
    case 1: page(p, 0xFFFFu); break;
    case 2: page(p, 0xFFFu); break;
    case 3:
      if ((d & 3u) == 3) {
        page(p, 0x3FFu);
        same((p >> 4) & 3u);
        return true;
      }
      [[fallthrough]];
    default:
      fault(instruction, 0x7, domain, mva);
      return false;
  }
  for (unsigned q = 0; q < 4; ++q) out.ap[q] = static_cast<std::uint8_t>((p >> (4 + 2 * q)) & 3u);
  return true;
}

bool Core::permitted(const Translation& t, bool write, bool user, unsigned& status) const {
  if (!t.checked) return true;
  const unsigned access = (dacr_ >> (2 * t.domain)) & 3u;
  if (access == 3) return true;
  if (access != 1) {
    status = t.section ? 0x9 : 0xB;
    return false;
  }
  status = t.section ? 0xD : 0xF;
  switch (t.ap) {
    case 0: {
      const bool s = control_ >> 8 & 1u, r = control_ >> 9 & 1u;
      if (write) return false;
      return s && !r ? !user : r && !s;
    }
    case 1: return !user;
    case 2: return !user || !write;
    default: return true;
  }
}

/// Translates with the TLB, and remembers the result for translate(). @return nullptr if a fault
/// was recorded
const Translation* Core::translate_slow(std::uint32_t mva, bool write, bool user,
                                        bool instruction) {
  const bool as_user = user || !privileged();
  const TlbEntry* e = tlb_.find(mva);
  TlbEntry fresh;
  if (!e) {
    if (!walk(mva, instruction, fresh)) return nullptr;
    const bool lock = tlb_lock_ & 1u;
    tlb_.insert(fresh, lock, (tlb_lock_ >> 26) & 7u);
    if (lock) tlb_lock_ = (tlb_lock_ & ~(7u << 26)) | (((tlb_lock_ >> 26) + 1) & 7u) << 26;
    // An entry may have been replaced: forget what was remembered of it.
    flush_memos();
    e = &fresh;
  }
  Translation t;
  t.base_va = e->base_va;
  t.base_pa = e->base_pa;
  t.mask = e->mask;
  t.domain = e->domain;
  t.section = e->section;
  t.cacheable = e->cacheable;
  t.bufferable = e->bufferable;
  // Pages of internal RAM are never cached; the 1 KB of a memo lies completely inside or outside
  // it.
  if (in_tcm(t.physical(mva))) t.cacheable = false;
  t.checked = true;
  // The quarters of a small or large page have permissions of their own.
  t.ap = e->ap[e->mask == 0xFFFu ? (mva >> 10) & 3u : e->mask == 0xFFFFu ? (mva >> 14) & 3u : 0];
  unsigned status = 0;
  if (!permitted(t, write, as_user, status)) {
    fault(instruction, status, t.domain, mva);
    return nullptr;
  }
  Memo& memo = (instruction ? imemo_ : dmemo_)[(mva >> 10) % kMemos];
  const std::uint32_t key = memo_key(mva, user);
  if (memo.page != key) memo.read_ok = memo.write_ok = false;
  memo.page = key;
  memo.translation = t;
  (write ? memo.write_ok : memo.read_ok) = true;
  return &memo.translation;
}

/// During a fill, words can be used as they arrive; any other access waits for its end.
void Core::dcache_wait(std::uint32_t mva) {
  const std::uint64_t c =
      (mva & ~31u) == dfill_.line ? dfill_.word((mva >> 2) & 7u) : dfill_.last;
  stall_to(c, Cause::kDcache, dfill_.pa, kService);
}

/// @return index of the line; after a bus error, that line is invalid
int Core::dcache_fill(std::uint32_t mva, std::uint32_t pa, bool write_back_line) {
  data_access_.asked = asked_now();
  stall_to(dfill_.last, Cause::kDcache, dfill_.pa, kService);
  const unsigned index = dcache_.victim(dcache_.set_of(mva), control_ >> 14 & 1u, dlock_ & 15u);
  if (dcache_.line(index).tag != 1) drop_hints(dcache_.line(index).tag);
  run_buffers(cycle_);
  filling_ = true;  // from here on the read precedes the victim
  write_back(index, Cause::kWriteBuffer);
  BusAccess& a = data_access_;
  a.kind = BusAccess::Kind::kWrap8;
  a.write = a.buffered = a.locked = false;
  a.address = pa & ~3u;
  a.bytes = 32;
  bus_read(a, Cause::kDcache);
  filling_ = false;
  ++counts_.dcache_read_fills;
  Cache::Line& l = dcache_.line(index);
  if (a.error) {  // linefills cannot abort on this core: the line is simply not kept
    dcache_.invalidate(index);
    Diagnostics::instance().guest("bus error on a D-cache line fill");
    std::memset(dcache_.data(index), 0, 32);
    return static_cast<int>(index);
  }
  std::memcpy(dcache_.data(index), a.data, 32);
  absent_.key = kNoHint;
  l.tag = mva & ~31u;
  l.pa = pa & ~31u;
  l.dirty = 0;
  l.write_back = write_back_line;
  dfill_ = {mva & ~31u, (pa >> 2) & 7u, pa, cycle_,
            std::max(cycle_, clock_.edge_at_or_after(a.last) + fill_latency_)};
  return static_cast<int>(index);
}

/// A cacheable load. @param mva address of its first byte @return host address of that byte
[[gnu::always_inline]] inline const std::uint8_t* Core::load_line(std::uint32_t va,
                                                                  std::uint32_t mva,
                                                                  const Translation& t) {
  ++counts_.dcache_reads;
  if (cycle_ < dfill_.last) dcache_wait(mva);
  int i = dcache_.find(mva);
  if (i < 0) i = dcache_fill(mva, t.physical(mva), t.bufferable);
  std::uint8_t* const line = dcache_.data(static_cast<unsigned>(i));
  if (dcache_.line(static_cast<unsigned>(i)).tag == (mva & ~31u))
    note_read(va, mva, line, counts_.dcache_reads);
  return line + (mva & 31u);
}

/// An aligned, cacheable load that is known to be permitted. Returns nullptr, without having done
/// anything, if the load is of another kind.
template <unsigned kBytes>
const std::uint8_t* Core::load_cached(std::uint32_t va) {
  const std::uint32_t mva = modified(va);
  const Memo& memo = dmemo_[(mva >> 10) % kMemos];
  if (memo.page != memo_key(mva, false) || !memo.read_ok || !memo.translation.cacheable ||
      (control_ & 5u) != 5u || (mva & (kBytes - 1)))
    return nullptr;
  record(pc_, va, kBytes);
  return load_line(va, mva, memo.translation);
}
template const std::uint8_t* Core::load_cached<1>(std::uint32_t);
template const std::uint8_t* Core::load_cached<2>(std::uint32_t);
template const std::uint8_t* Core::load_cached<4>(std::uint32_t);

Core::Result Core::load(std::uint32_t va, unsigned bytes, std::uint32_t& value, bool user) {
  const std::uint32_t mva = modified(va);
  if ((control_ & 2u) && (mva & (bytes - 1))) {
    fault(false, 0x1, 0, mva);
    return Result::kAbort;
  }
  const std::uint32_t a = mva & ~(bytes - 1u);
  record(pc_, va, bytes);
  value = 0;
  const Translation* t = translate(a, false, user, false);
  if (!t) return Result::kAbort;
  const std::uint32_t pa = t->physical(a);
  if (in_tcm(pa)) {
    tcm_access(pa, TcmPort::Side::kData);
    std::memcpy(&value, tcm(pa), bytes);
    ++reads_of(pa);
    if (tcm_quick()) note_read(va, mva, tcm(pa & ~(kReadSpan - 1)), reads_of(pa));
    return Result::kOk;
  }
  if (t->cacheable && (control_ & 5u) == 5u) {
    const std::uint8_t* const from = load_line(va, a, *t);
    if (bytes == 4)
      std::memcpy(&value, from, 4);
    else
      std::memcpy(&value, from, bytes);
    return Result::kOk;
  }
  counts_.translated_uncached += control_ & 1u;
  if (!uncached_read(pa, bytes, value)) {
    fault(false, t->section ? 0x8 : 0xA, t->domain, mva);
    return Result::kAbort;
  }
  return Result::kOk;
}

Core::Result Core::store(std::uint32_t va, unsigned bytes, std::uint32_t value, bool user) {
  const std::uint32_t mva = modified(va);
  if ((control_ & 2u) && (mva & (bytes - 1))) {
    fault(false, 0x1, 0, mva);
    return Result::kAbort;
  }
  const std::uint32_t a = mva & ~(bytes - 1u);
  record(pc_, va, bytes | kWritten);
  const Translation* t = translate(a, true, user, false);
  if (!t) return Result::kAbort;
  const std::uint32_t pa = t->physical(a);
  if (in_tcm(pa)) {
    tcm_access(pa, TcmPort::Side::kData);
    std::memcpy(tcm(pa), &value, bytes);
    tcm_decoded(pa).valid = 0;
    ++writes_of(pa);
    if (tcm_quick()) note_write(va, mva, tcm(pa & ~(kWriteSpan - 1)), writes_of(pa));
    return Result::kOk;
  }
  const bool section = t->section, bufferable = t->bufferable;
  const unsigned domain = t->domain;
  if (t->cacheable && (control_ & 5u) == 5u) {
    ++counts_.dcache_writes;
    if (cycle_ < dfill_.last) dcache_wait(a);
    const int i = dcache_.find(a);
    if (i >= 0) {
      std::memcpy(dcache_.data(static_cast<unsigned>(i)) + (a & 31u), &value, bytes);
      if (bufferable && !(cache_debug_ & 4u)) {
        dcache_.line(static_cast<unsigned>(i)).dirty |=
            static_cast<std::uint8_t>(1u << ((a >> 4) & 1u));
        note_write(va, mva, dcache_.data(static_cast<unsigned>(i)) + (a & 16u),
                   counts_.dcache_writes);
        return Result::kOk;
      }
    } else {
      ++counts_.dcache_write_misses;
    }
    std::uint8_t data[4];
    std::memcpy(data, &value, 4);
    enqueue_write(pa, data, bytes);
    return Result::kOk;
  }
  counts_.translated_uncached += control_ & 1u;
  if (bufferable && (control_ & 1u)) {
    std::uint8_t data[4];
    std::memcpy(data, &value, 4);
    enqueue_write(pa, data, bytes);
    return Result::kOk;
  }
  if (!unbuffered_write(pa, bytes, value)) {
    fault(false, section ? 0x8 : 0xA, domain, mva);
    return Result::kAbort;
  }
  return Result::kOk;
}

/// A store that misses the cache and goes to the write buffer. Returns false, without having done
/// anything, if the store is of another kind.
template <unsigned kBytes>
bool Core::store_beside_cache(std::uint32_t va, std::uint32_t value) {
  const std::uint32_t mva = modified(va);
  const Memo& memo = dmemo_[(mva >> 10) % kMemos];
  if (memo.page != memo_key(mva, false) || !memo.write_ok || !memo.translation.cacheable ||
      (control_ & 5u) != 5u || (mva & (kBytes - 1)) || dcache_.find(mva) >= 0)
    return false;
  const std::uint32_t pa = memo.translation.physical(mva);
  absent_.key = va & ~(kReadSpan - 1);
  absent_.pa = pa & ~(kReadSpan - 1);
  hints_used_ = true;
  store_absent<kBytes>(va, pa, value);
  return true;
}
template bool Core::store_beside_cache<1>(std::uint32_t, std::uint32_t);
template bool Core::store_beside_cache<2>(std::uint32_t, std::uint32_t);
template bool Core::store_beside_cache<4>(std::uint32_t, std::uint32_t);

/// Stores the words of an STM or STRD. Consecutive words for the write buffer share an entry.
Core::Result Core::store_words(std::uint32_t va, const std::uint32_t* words, unsigned count,
                               bool user) {
  std::array<std::uint8_t, 64> run;
  std::uint32_t run_pa = 0;
  unsigned run_bytes = 0;
  const auto flush = [&] {
    if (run_bytes) enqueue_write(run_pa, run.data(), run_bytes);
    run_bytes = 0;
  };
  for (unsigned k = 0; k < count; ++k) {
    const std::uint32_t mva = modified(va + 4 * k) & ~3u;
    const Translation* t = translate(mva, true, user, false);
    if (!t) {
      flush();
      return Result::kAbort;
    }
    const std::uint32_t pa = t->physical(mva);
    if (!in_tcm(pa)) {
      const bool cached = t->cacheable && (control_ & 5u) == 5u;
      const bool buffered = t->bufferable && (control_ & 1u);
      const int line = cached ? dcache_.find(mva) : -1;
      const bool keeps = line >= 0 && buffered && !(cache_debug_ & 4u);
      if (cached ? !keeps : buffered) {
        record(pc_, va + 4 * k, 4 | kWritten);
        if (cached) {
          ++counts_.dcache_writes;
          if (cycle_ < dfill_.last) dcache_wait(mva);
          if (line < 0)
            ++counts_.dcache_write_misses;
          else
            std::memcpy(dcache_.data(static_cast<unsigned>(line)) + (mva & 31u), &words[k], 4);
        } else {
          ++counts_.translated_uncached;
        }
        if (run_bytes && pa != run_pa + run_bytes) flush();
        if (!run_bytes) run_pa = pa;
        std::memcpy(run.data() + run_bytes, &words[k], 4);
        run_bytes += 4;
        spend(1);
        continue;
      }
    }
    if (run_bytes) bus_waited_ = true;
    flush();
    if (store(va + 4 * k, 4, words[k], user) != Result::kOk) {
      external_abort_at(va + 4 * (count - 1));
      return Result::kAbort;
    }
    spend(1);
  }
  flush();
  return Result::kOk;
}

void Core::icache_fill(std::uint32_t mva, std::uint32_t pa) {
  fetch_access_.asked = asked_now();
  stall_to(ifill_.last, Cause::kIcache, ifill_.pa, kService);
  const unsigned index = icache_.victim(icache_.set_of(mva), control_ >> 14 & 1u, ilock_ & 15u);
  icache_.invalidate(index);
  decoded_[index].valid = 0;
  bus_fetch_ = true;
  run_buffers(cycle_);
  sync_to_ahb(pa);
  BusAccess& a = fetch_access_;
  a.kind = BusAccess::Kind::kWrap8;
  a.write = a.buffered = false;
  a.address = pa & ~3u;
  a.bytes = 32;
  counts_.i_read_beats += beats(a.bytes);
  submit(a, cycle_);
  port_.finish(a);
  ++counts_.icache_fills;
  const std::uint64_t there = clock_.edge_at_or_after(a.first);
  stall_on(a, a.first, there, there + fill_latency_, Cause::kIcache);
  if (a.error) return;
  std::memcpy(icache_.data(index), a.data, 32);
  icache_.line(index).tag = mva & ~31u;
  ifill_ = {mva & ~31u, (pa >> 2) & 7u, pa, cycle_,
            std::max(cycle_, clock_.edge_at_or_after(a.last) + fill_latency_)};
}

const Instruction* Core::fetch_slow() {
  pack_flags();  // in case of an abort
  const bool thumb = cpsr_ & 0x20u;
  const std::uint32_t mva = fetched_at(pc_) & (thumb ? ~1u : ~3u);
  const unsigned shift = thumb ? 1 : 2;
  const unsigned at = (mva & 31u) >> shift;
  bool in_ram = false;
  const auto decode_into = [&](DecodedLine& d, const std::uint8_t* bytes) -> const Instruction* {
    if (d.valid == 0 || (d.valid & 1u) != thumb) {
      clear_line(d, thumb);
      if (in_ram) flush_hints();  // stores to this line must be noticed
    }
    d.valid = line_key(pc_);
    Instruction& i = d.records[at];
    if (!i.body) {
      i = decode_at(bytes, at, thumb);
      // Other masters may write internal RAM, so its records must not rely on each other.
      Context context = in_ram ? Context{} : record_context(d, at, bytes, thumb);
      context.in_line = true;
      prepare(i, at << shift, context);
    }
    line_va_ = pc_ & ~31u;
    line_thumb_ = thumb ? 0x20u : 0u;
    line_shift_ = shift;
    current_line_ = &d;
    jumps_[pc_ / 32 % kJumps] = &d;
    return &i;
  };
  const bool mmu = fetch_control_ & 1u;
  const Translation* t = !mmu              ? &flat_
                         : control_ & 1u ? translate(mva, false, false, true)
                                         : translate_slow(mva, false, false, true);
  if (!t) {
    take(Exception::kPrefetchAbort, pc_ + 4);
    return nullptr;
  }
  const std::uint32_t pa = t->physical(mva);
  in_ram = in_itcm(pa);
  line_epoch_ = in_ram ? line_epoch_ | kLineInRam : line_epoch_ & ~kLineInRam;
  if (in_ram) {
    counts_.fetch_from(fetch_kind(thumb, FetchFrom::kTcm, mmu));
    tcm_access(pa, TcmPort::Side::kFetch);
    DecodedLine& d = tcm_decoded(pa);
    const Instruction* i = decode_into(d, tcm(pa & ~31u));
    if (!tcm_quick()) {  // every fetch has to be checked
      line_va_ = 1;
      d.valid = 2u | (d.valid & 1u);
    }
    return i;
  }
  if (in_dtcm(pa)) [[unlikely]]
    Diagnostics::instance().guest(
        "instruction fetch from the data window of internal RAM (0x10000), which serves data only: "
        "it goes to the bus, where nothing answers; the same RAM holds code at 0x0");
  // With the MMU off only the I-cache's enable bit decides; with it on, the C bit of the page too.
  const bool cached = (fetch_control_ >> 12 & 1u) && (t->cacheable || !mmu);
  counts_.fetch_from(
      fetch_kind(thumb, cached ? FetchFrom::kCache : FetchFrom::kBus, mmu));
  if (cached) {
    if (cycle_ < ifill_.last && ifill_.line != (mva & ~31u))
      stall_to(ifill_.last, Cause::kIcache, ifill_.pa, kService);
    int index = icache_.find(mva);
    if (index < 0) {
      icache_fill(mva, pa);
      index = icache_.find(mva);
    }
    if (index < 0) {
      fault(true, t->section ? 0x8 : 0xA, t->domain, mva);
      take(Exception::kPrefetchAbort, pc_ + 4);
      return nullptr;
    }
    return decode_into(decoded_[static_cast<unsigned>(index)],
                       icache_.data(static_cast<unsigned>(index)));
  }
  // Uncached: fetch four words ahead and keep them until the program leaves them.
  const unsigned domain = t->domain;
  const bool section = t->section;
  if ((pa & ~15u) != fetch_buffer_pa_ || fetch_branched_ ||
      redirects_seen_ != counts_.redirects) {
    // The port carries one transaction at a time.
    fetch_access_.asked = asked_now();
    stall_to(ifill_.last, Cause::kIcache, ifill_.pa, kService);
    bus_fetch_ = true;
    run_buffers(cycle_);
    sync_to_ahb(pa);
    BusAccess& a = fetch_access_;
    a.kind = BusAccess::Kind::kIncr4;
    a.write = a.buffered = false;
    a.address = pa & ~15u;
    a.bytes = 16;
    counts_.i_read_beats += beats(a.bytes);
    submit(a, cycle_);
    port_.finish(a);
    const std::uint64_t there = clock_.edge_at_or_after(a.last);
    stall_on(a, a.last, there, there + fill_latency_, Cause::kUncached);
    if (a.error) {
      fetch_buffer_pa_ = 1;
      fault(true, section ? 0x8 : 0xA, domain, mva);
      take(Exception::kPrefetchAbort, pc_ + 4);
      return nullptr;
    }
    std::memcpy(fetch_words_, a.data, 16);
    fetch_buffer_pa_ = pa & ~15u;
  }
  fetch_branched_ = false;
  redirects_seen_ = counts_.redirects;
  line_va_ = 1;
  Instruction& i = uncached_record_[0];
  i = decode_at(reinterpret_cast<const std::uint8_t*>(fetch_words_), (pa & 15u) >> shift, thumb);
  prepare(i, mva & 31u, Context{});
  uncached_record_[1].at = static_cast<std::uint8_t>(i.at + (1u << shift));
  return &i;
}

bool Core::peek(std::uint32_t address, std::uint8_t& byte) const {
  const std::uint32_t mva = modified(address);
  const TlbEntry* e = control_ & 1u ? tlb_.find(mva) : nullptr;
  const bool translated = e || !(control_ & 1u);
  const std::uint32_t pa = e ? e->physical(mva) : mva;
  if (translated && in_tcm(pa)) {
    byte = tcm_[tcm_offset(pa)];
    return true;
  }
  if (const int i = dcache_.find(mva); i >= 0) {
    byte = dcache_.data(static_cast<unsigned>(i))[mva & 31u];
    return true;
  }
  return translated && writes_.find(pa, byte);  // it is on its way to memory
}

}  // namespace fovea::cpu
