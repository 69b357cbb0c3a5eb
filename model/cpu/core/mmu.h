// The memory management unit: TLB, page walks, permissions.
#pragma once
#include <array>
#include <cstdint>

#include "model/cpu/core/data_bus.h"
#include "model/cpu/core/internal_ram.h"
#include "model/cpu/core/page_walk.h"
#include "model/cpu/core/stall_ledger.h"
#include "model/cpu/core/system_registers.h"
#include "model/cpu/core/tlb.h"

namespace fovea::cpu {

enum class Access : std::uint8_t { kLoad, kStore, kFetch };
/// Whose permissions count. kUser: those of user mode, also in a privileged mode (LDRT, STRT).
enum class Rights : std::uint8_t { kOfMode, kUser };

/// The translation of a page, as far as an access needs it.
struct Translation {
  std::uint32_t base_va = 1, base_pa = 0, mask = 0;  // pa = base_pa | (mva & mask)
  std::uint8_t ap = 3, domain = 0;
  bool cacheable = false, bufferable = false;
  bool section = false;
  std::uint32_t physical(std::uint32_t mva) const { return base_pa | (mva & mask); }
  /// The status of an access that the bus refuses.
  Fault bus_fault() const { return section ? Fault::kSectionBus : Fault::kPageBus; }
};

class Mmu {
 public:
  Mmu(StallLedger& ledger, DataBus& bus, const InternalRam& ram, SystemRegisters& registers,
      unsigned walk_cycles)
      : ledger_(ledger),
        bus_(bus),
        ram_(ram),
        registers_(registers),
        walk_cycles_(walk_cycles) {
    flat_.mask = ~0u;
  }
  Mmu(const Mmu&) = delete;
  Mmu& operator=(const Mmu&) = delete;

  /// Translates an address with the MMU on. Walks the tables if the TLB has no entry.
  /// @return nullptr if a fault was recorded
  [[gnu::always_inline]] const Translation* translate(std::uint32_t mva, Access access,
                                                      bool as_user) {
    const Memo& m = memo(mva, access);
    if (m.page == memo_key(mva, as_user) && (access == Access::kStore ? m.write_ok : m.read_ok))
      return &m.translation;
    return translate_slow(mva, access, as_user);
  }
  [[gnu::noinline]] const Translation* translate_slow(std::uint32_t mva, Access access,
                                                      bool as_user);
  /// The translation of every address while the MMU is off.
  const Translation& flat() const { return flat_; }
  /// A permitted, remembered load or store of a cacheable page; nullptr: not known.
  [[gnu::always_inline]] const Translation* known_cacheable(std::uint32_t mva, Access access,
                                                            bool as_user) const {
    const Memo& m = data_[(mva >> 10) % kMemos];
    const bool known = m.page == memo_key(mva, as_user) &&
                       (access == Access::kStore ? m.write_ok : m.read_ok) &&
                       m.translation.cacheable;
    return known ? &m.translation : nullptr;
  }
  /// Forgets the remembered translations; the TLB keeps its entries.
  void forget();
  /// Number of entries put into the TLB so far. An older one may have been replaced, so code that
  /// remembers something of a translation must forget it.
  std::uint64_t insertions() const { return insertions_; }

  /// Empties the TLB, locked entries included.
  void reset() { tlb_ = {}; }
  void invalidate_all() { tlb_.invalidate_all(); }
  void invalidate(std::uint32_t mva) { tlb_.invalidate(mva); }

  /// Records a fault for the abort handler.
  void fault(Access access, Fault status, unsigned domain, std::uint32_t address);
  /// Sets the FAR of a transfer of several words up to `last` that was aborted by the bus.
  void external_abort_at(std::uint32_t last);

  const Tlb& tlb() const { return tlb_; }

 private:
  struct Memo {
    std::uint32_t page = 1;  // mva >> 10, or a number that no page has
    Translation translation;
    bool read_ok = false, write_ok = false;
  };
  static constexpr unsigned kMemos = 256;

  Memo& memo(std::uint32_t mva, Access access) {
    return (access == Access::kFetch ? fetch_ : data_)[(mva >> 10) % kMemos];
  }
  static std::uint32_t memo_key(std::uint32_t mva, bool as_user) {
    return (mva >> 10) | (as_user ? 1u << 22 : 0u);
  }
  const TlbEntry* walk(std::uint32_t mva, Access access, TlbEntry& fresh);
  Fault check(const TlbEntry& e, std::uint8_t ap, Access access, bool as_user) const;

  StallLedger& ledger_;
  DataBus& bus_;
  const InternalRam& ram_;
  SystemRegisters& registers_;
  unsigned walk_cycles_;  // core clocks of a walk beyond its bus reads
  Tlb tlb_;
  std::array<Memo, kMemos> data_{}, fetch_{};
  Translation flat_;
  std::uint64_t insertions_ = 0;
};

}  // namespace fovea::cpu
