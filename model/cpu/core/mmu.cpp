#include "model/cpu/core/mmu.h"

#include <algorithm>

namespace fovea::cpu {

void Mmu::forget() {
  for (auto& m : data_) m.page = ~0u;
  for (auto& m : fetch_) m.page = ~0u;
}

void Mmu::fault(Access access, Fault status, unsigned domain, std::uint32_t address) {
  const std::uint32_t fsr = domain << 4 | static_cast<std::uint32_t>(status);
  if (access == Access::kFetch) {
    registers_.ifsr = fsr;
  } else {
    registers_.dfsr = fsr;
    registers_.far = address;
  }
}

/// The last word before the 1 KB boundary after the aborted word (ARM DDI 0198D ch. 3, FAR). The
/// words in between are not transferred (assumed).
void Mmu::external_abort_at(std::uint32_t last) {
  const auto status = static_cast<Fault>(registers_.dfsr & 0xFu);
  if (status == Fault::kSectionBus || status == Fault::kPageBus)
    registers_.far = std::min(registers_.far | 0x3FCu, registers_.modified(last));
}

/// Walks the tables and puts the entry into the TLB.
/// @return `fresh`, or nullptr if a fault was recorded
const TlbEntry* Mmu::walk(std::uint32_t mva, Access access, TlbEntry& fresh) {
  ++ledger_.counts.tlb_walks;
  ledger_.stall_to(ledger_.cycle + walk_cycles_, Cause::kTlb,
                   first_level_address(registers_.ttbr, mva), kCore);
  const PageWalk w =
      walk_page_tables(registers_.ttbr, mva, [this](std::uint32_t address, std::uint32_t& word) {
        return bus_.read_word(address, word, Cause::kTlb);
      });
  if (w.fault != Fault::kNone) {
    const bool first = w.fault == Fault::kFirstLevelBus || w.fault == Fault::kSectionTranslation;
    fault(access, w.fault, first ? 0 : w.entry.domain, mva);
    return nullptr;
  }
  fresh = w.entry;
  std::uint32_t& lockdown = registers_.tlb_lock;
  const bool lock = lockdown & 1u;
  tlb_.insert(fresh, lock, lockdown >> 26 & 7u);
  if (lock) lockdown = (lockdown & ~(7u << 26)) | (((lockdown >> 26) + 1) & 7u) << 26;
  // An entry may have been replaced: forget what was remembered of it.
  forget();
  ++insertions_;
  return &fresh;
}

/// @param ap permissions of the part of the page that is accessed
Fault Mmu::check(const TlbEntry& e, std::uint8_t ap, Access access, bool as_user) const {
  enum : unsigned { kClient = 1, kManager = 3 };
  const unsigned rights = registers_.dacr >> (2 * e.domain) & 3u;
  if (rights == kManager) return Fault::kNone;
  if (rights != kClient) return e.section ? Fault::kSectionDomain : Fault::kPageDomain;
  const bool write = access == Access::kStore;
  const bool permitted = [&] {
    switch (ap) {
      case 0: {
        const bool s = registers_.control & kSystemProtection;
        const bool r = registers_.control & kRomProtection;
        if (write) return false;
        return s && !r ? !as_user : r && !s;
      }
      case 1: return !as_user;
      case 2: return !as_user || !write;
      default: return true;
    }
  }();
  if (permitted) return Fault::kNone;
  return e.section ? Fault::kSectionPermission : Fault::kPagePermission;
}

const Translation* Mmu::translate_slow(std::uint32_t mva, Access access, bool as_user) {
  const TlbEntry* e = tlb_.find(mva);
  TlbEntry fresh;
  if (!e) e = walk(mva, access, fresh);
  if (!e) return nullptr;
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
  if (ram_.contains(t.physical(mva))) t.cacheable = false;
  t.ap = e->permissions(mva);
  if (const Fault status = check(*e, t.ap, access, as_user); status != Fault::kNone) {
    fault(access, status, t.domain, mva);
    return nullptr;
  }
  Memo& m = memo(mva, access);
  const std::uint32_t key = memo_key(mva, as_user);
  if (m.page != key) m.read_ok = m.write_ok = false;
  m.page = key;
  m.translation = t;
  (access == Access::kStore ? m.write_ok : m.read_ok) = true;
  return &m.translation;
}

}  // namespace fovea::cpu
