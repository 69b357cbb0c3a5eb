// Loads, stores and fetches: which of internal RAM, caches, buffers and bus serves them.
#include <array>
#include <cstring>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

/// A load or store conflicts with the fetch of its own instruction if that came from the same bank.
/// While this costs clocks every fetch is looked up (InternalRam::quick()), so the last line found
/// is the one that the instruction came from.
void Core::ram_access(std::uint32_t pa, TcmPort::Side side) {
  const bool conflicts =
      ram_.own_conflicts() && side == TcmPort::Side::kData && fetch_.in_ram() &&
      ram_.port().same_bank(ram_.offset(pa), fetch_.current_ram_offset());
  const std::uint64_t waited = ram_.access(pa, side, conflicts);
  if (ram_watch_) [[unlikely]]
    ram_watch_->accessed({ram_.offset(pa), regs_.pc, ledger_.cycle - ram_.wait_states(), waited, bus_.room_waits()});
}

/// An aligned, cacheable load that is known to be permitted. Returns nullptr, without having done
/// anything, if the load is of another kind.
template <unsigned kBytes>
const std::uint8_t* Core::load_cached(const Instruction* i, std::uint32_t va) {
  const std::uint32_t mva = system_.modified(va);
  const Translation* const t = mmu_.known_cacheable(mva, Access::kLoad, !regs_.privileged());
  if (!t || !system_.data_cached() || (mva & (kBytes - 1))) return nullptr;
  log_.note(i, va);
  return data_.load(va, mva, kBytes, *t);
}
template const std::uint8_t* Core::load_cached<1>(const Instruction*, std::uint32_t);
template const std::uint8_t* Core::load_cached<2>(const Instruction*, std::uint32_t);
template const std::uint8_t* Core::load_cached<4>(const Instruction*, std::uint32_t);

Core::Result Core::load(std::uint32_t va, unsigned bytes, std::uint32_t& value, Rights rights) {
  if (misaligned(va, bytes)) return Result::kAbort;
  const std::uint32_t mva = system_.modified(va), a = mva & ~(bytes - 1u);
  log_.note(regs_.pc, va, bytes, false);
  value = 0;
  const Translation* const t = translate(a, Access::kLoad, rights);
  if (!t) return Result::kAbort;
  const std::uint32_t pa = t->physical(a);
  if (ram_.contains(pa)) {
    ram_access(pa, TcmPort::Side::kData);
    std::memcpy(&value, ram_.at(pa), bytes);
    ++ram_.reads_of(pa);
    if (ram_watch_) [[unlikely]]
      tell_load(pa, bytes);
    else if (ram_.quick())
      data_.hint_ram_reads(va, mva, ram_.at(pa & ~(DataCache::kReadSpan - 1)), ram_.reads_of(pa));
    return Result::kOk;
  }
  if (t->cacheable && system_.data_cached()) {
    const std::uint8_t* const from = data_.load(va, a, bytes, *t);
    if (bytes == 4)
      std::memcpy(&value, from, 4);
    else
      std::memcpy(&value, from, bytes);
    return Result::kOk;
  }
  const Translation page = *t;  // others may act while the bus is waited for
  ledger_.counts.translated_uncached += system_.mmu_on();
  if (bus_.read_uncached(pa, bytes, swapping_, value)) return Result::kOk;
  mmu_.fault(Access::kLoad, page.bus_fault(), page.domain, mva);
  return Result::kAbort;
}

/// What the buffers do before this load comes first, so that an observer learns of things in the order of their times:
/// as far as nobody else has to act for it, who would act after this instruction if nothing was observed.
void Core::tell_load(std::uint32_t pa, unsigned bytes) {
  if (ledger_.cycle < interface_.stop_cycle && !interface_.attention) bus_.run_buffers(ledger_.cycle);
  ram_watch_->loaded({ram_.offset(pa), bytes, regs_.pc, ledger_.cycle, bus_.room_waits()});
}

void Core::store_to_ram(std::uint32_t va, std::uint32_t pa, unsigned bytes, std::uint32_t value) {
  ram_access(pa, TcmPort::Side::kData);
  std::memcpy(ram_.at(pa), &value, bytes);
  fetch_.drop_ram(ram_.offset(pa));
  ++ram_.writes_of(pa);
  if (ram_.quick() && !ram_watch_)  // who watches learns of each store
    data_.hint_ram_writes(va, system_.modified(va), ram_.at(pa & ~(DataCache::kWriteSpan - 1)),
                          ram_.writes_of(pa));
}

Core::Result Core::store(std::uint32_t va, unsigned bytes, std::uint32_t value, Rights rights) {
  if (misaligned(va, bytes)) return Result::kAbort;
  const std::uint32_t mva = system_.modified(va), a = mva & ~(bytes - 1u);
  log_.note(regs_.pc, va, bytes, true);
  const Translation* const t = translate(a, Access::kStore, rights);
  if (!t) return Result::kAbort;
  const std::uint32_t pa = t->physical(a);
  if (ram_.contains(pa)) {
    store_to_ram(va, pa, bytes, value);
    return Result::kOk;
  }
  const Translation page = *t;  // others may act while the bus is waited for
  const bool cached = page.cacheable && system_.data_cached();
  if (cached) {
    if (data_.store(va, a, bytes, value, page.bufferable)) return Result::kOk;
  } else {
    ledger_.counts.translated_uncached += system_.mmu_on();
  }
  if (cached || (page.bufferable && system_.mmu_on())) {
    std::array<std::uint8_t, 4> data;
    std::memcpy(data.data(), &value, 4);
    bus_.buffer(pa, data.data(), bytes);
    return Result::kOk;
  }
  if (bus_.write_unbuffered(pa, bytes, swapping_, value)) return Result::kOk;
  mmu_.fault(Access::kStore, page.bus_fault(), page.domain, mva);
  return Result::kAbort;
}

/// A store that misses the cache and goes to the write buffer. Returns false, without having done
/// anything, if the store is of another kind.
template <unsigned kBytes>
bool Core::store_beside_cache(const Instruction* i, std::uint32_t va, std::uint32_t value) {
  const std::uint32_t mva = system_.modified(va);
  const Translation* const t = mmu_.known_cacheable(mva, Access::kStore, !regs_.privileged());
  if (!t || !system_.data_cached() || (mva & (kBytes - 1)) || data_.lines().find(mva) >= 0)
    return false;
  const std::uint32_t pa = t->physical(mva);
  data_.hint_absent(va, pa);
  store_absent<kBytes>(i, va, pa, value);
  return true;
}
template bool Core::store_beside_cache<1>(const Instruction*, std::uint32_t, std::uint32_t);
template bool Core::store_beside_cache<2>(const Instruction*, std::uint32_t, std::uint32_t);
template bool Core::store_beside_cache<4>(const Instruction*, std::uint32_t, std::uint32_t);

/// A store to a writable line that the cache does not hold.
template <unsigned kBytes>
void Core::store_absent(const Instruction* i, std::uint32_t va, std::uint32_t pa,
                        std::uint32_t value) {
  log_.note(i, va);
  ++ledger_.counts.dcache_writes;
  if (ledger_.cycle < data_.fill.last) data_.wait_for_fill(system_.modified(va));
  ++ledger_.counts.dcache_write_misses;
  bus_.buffer_word<kBytes>(pa, value);
}
template void Core::store_absent<1>(const Instruction*, std::uint32_t, std::uint32_t,
                                      std::uint32_t);
template void Core::store_absent<2>(const Instruction*, std::uint32_t, std::uint32_t,
                                      std::uint32_t);
template void Core::store_absent<4>(const Instruction*, std::uint32_t, std::uint32_t,
                                      std::uint32_t);

/// Stores the words of an STM or STRD. Consecutive words for the write buffer share an entry.
Core::Result Core::store_words(std::uint32_t va, const std::uint32_t* words, unsigned count) {
  struct {
    std::array<std::uint8_t, 64> bytes;
    std::uint32_t pa = 0;
    unsigned count = 0;
  } run;
  const auto flush = [&] {
    if (run.count) bus_.buffer(run.pa, run.bytes.data(), run.count);
    run.count = 0;
  };
  for (unsigned k = 0; k < count; ++k) {
    const std::uint32_t mva = system_.modified(va + 4 * k) & ~3u;
    const Translation* const t = translate(mva, Access::kStore, Rights::kOfMode);
    if (!t) {
      flush();
      return Result::kAbort;
    }
    const std::uint32_t pa = t->physical(mva);
    if (!ram_.contains(pa)) {
      const bool cached = t->cacheable && system_.data_cached();
      const bool buffered = t->bufferable && system_.mmu_on();
      const int line = cached ? data_.lines().find(mva) : -1;
      if (cached ? !data_.keeps(line, buffered) : buffered) {
        log_.note(regs_.pc, va + 4 * k, 4, true);
        if (cached)
          data_.store(va + 4 * k, mva, 4, words[k], false);
        else
          ++ledger_.counts.translated_uncached;
        if (run.count && pa != run.pa + run.count) flush();
        if (!run.count) run.pa = pa;
        std::memcpy(run.bytes.data() + run.count, &words[k], 4);
        run.count += 4;
        spend(1);
        continue;
      }
    }
    if (run.count) ledger_.bus_waited = true;
    flush();
    if (store(va + 4 * k, 4, words[k], Rights::kOfMode) != Result::kOk) {
      mmu_.external_abort_at(va + 4 * (count - 1));
      return Result::kAbort;
    }
    spend(1);
  }
  flush();
  return Result::kOk;
}

const Instruction* Core::fetch_slow() {
  regs_.pack_flags();  // in case of an abort
  FetchTarget target{.pc = regs_.pc, .mva = 0, .thumb = regs_.thumb()};
  target.mva = fetch_.modified(regs_.pc) & (target.thumb ? ~1u : ~3u);
  const bool mmu = fetch_.mmu_on(), as_user = !regs_.privileged();
  const Translation* const t =
      !mmu ? &mmu_.flat()
      : system_.mmu_on()
          ? translated(mmu_.translate(target.mva, Access::kFetch, as_user))
          : translated(mmu_.translate_slow(target.mva, Access::kFetch, as_user));
  if (!t) return prefetch_abort();
  const Translation page = *t;  // others may act while the bus is waited for
  const std::uint32_t pa = page.physical(target.mva);
  const bool in_ram = ram_.in_itcm(pa);
  fetch_.set_in_ram(in_ram);
  if (in_ram) {
    ledger_.counts.fetch_from(fetch_kind(target.thumb, FetchFrom::kTcm, mmu));
    return fetch_from_ram(pa, target);
  }
  if (ram_.in_dtcm(pa)) [[unlikely]]
    diagnostics_.guest(
        "instruction fetch from the data window of internal RAM (0x10000), which serves data only: "
        "it goes to the bus, where nothing answers; the same RAM holds code at 0x0");
  // With the MMU off only the I-cache's enable bit decides; with it on, the C bit of the page too.
  const bool cached = fetch_.cached() && (page.cacheable || !mmu);
  ledger_.counts.fetch_from(
      fetch_kind(target.thumb, cached ? FetchFrom::kCache : FetchFrom::kBus, mmu));
  if (cached) {
    if (const int index = fetch_.find_line(target.mva, pa); index >= 0) {
      const auto line = static_cast<unsigned>(index);
      return fetch_.decode(fetch_.cache_line(line), fetch_.icache().data(line), target, false);
    }
  } else if (fetch_.read_ahead(pa)) {
    return fetch_.decode_uncached(pa, target);
  }
  mmu_.fault(Access::kFetch, page.bus_fault(), page.domain, target.mva);
  return prefetch_abort();
}

const Instruction* Core::fetch_from_ram(std::uint32_t pa, const FetchTarget& target) {
  ram_access(pa, TcmPort::Side::kFetch);
  DecodedLine& d = fetch_.ram_line(ram_.offset(pa));
  if (d.stale(target.thumb)) data_.forget_hints();  // stores to this line must be noticed
  const Instruction* const i = fetch_.decode(d, ram_.at(pa & ~31u), target, true);
  if (!ram_.quick()) {  // every fetch has to be checked
    fetch_.leave_line();
    d.look_up_again();
  }
  return i;
}

bool Core::peek(std::uint32_t address, std::uint8_t& byte) const {
  const std::uint32_t mva = system_.modified(address);
  const TlbEntry* const e = system_.mmu_on() ? mmu_.tlb().find(mva) : nullptr;
  const bool translated = e || !system_.mmu_on();
  const std::uint32_t pa = e ? e->physical(mva) : mva;
  if (translated && ram_.contains(pa)) {
    byte = *ram_.at(pa);
    return true;
  }
  if (const int i = data_.lines().find(mva); i >= 0) {
    byte = data_.lines().data(static_cast<unsigned>(i))[mva & 31u];
    return true;
  }
  return translated && bus_.writes().find(pa, byte);  // it is on its way to memory
}

void Core::tcm_burst_begins(const TcmPort::Burst& burst, Picoseconds at) {
  FOVEA_CHECK(!ram_.port().busy() && burst.bytes > 0 && burst.offset + burst.bytes <= ram_.size(),
              "bad burst to internal RAM");
  ram_.port().begin(burst, interface_.clock.edge_after(at));
  // Until the burst ends each access to internal RAM has to be looked at.
  data_.forget_ram_hints();
  if (fetch_.knows_ram()) fetch_.forget();
}

void Core::tcm_burst_ends(bool write, std::uint8_t* data) {
  const std::span<std::uint8_t> bytes = ram_.burst_bytes();
  const std::uint32_t offset = ram_.port().burst().offset;
  ram_.port().finish();
  if (write) {
    std::memcpy(bytes.data(), data, bytes.size());
    fetch_.drop_ram(offset, static_cast<std::uint32_t>(bytes.size()));
  } else {
    std::memcpy(data, bytes.data(), bytes.size());
  }
  if (ram_watch_)
    ram_watch_->moved({offset, static_cast<unsigned>(bytes.size()), write, ram_.port().burst().master,
                       ram_.port().waited_of_burst()},
                      tcm_burst_over());
}

}  // namespace fovea::cpu
