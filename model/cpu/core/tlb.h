// The main TLB (2 ways, 32 sets) and the lockdown TLB (8 entries), unified for instructions and
// data.
#pragma once
#include <array>
#include <cstdint>

namespace fovea::cpu {

struct TlbEntry {
  bool valid = false;
  std::uint32_t base_va = 0, base_pa = 0, mask = 0;
  std::array<std::uint8_t, 4> ap{};  // access permissions of each quarter of the page
  std::uint8_t domain = 0;
  bool cacheable = false, bufferable = false, section = false;
  bool covers(std::uint32_t mva) const { return valid && (mva & ~mask) == base_va; }
  std::uint32_t physical(std::uint32_t mva) const { return base_pa | (mva & mask); }
  /// Access permissions at an address: the quarters of a small or large page have their own.
  std::uint8_t permissions(std::uint32_t mva) const {
    return ap[mask == 0xFFFu ? (mva >> 10) & 3u : mask == 0xFFFFu ? (mva >> 14) & 3u : 0];
  }
};

class Tlb {
 public:
  /// Looks up an entry. The set is chosen by the number of the 1 MB, 64 KB, 4 KB or 1 KB page
  /// (assumed: the architecture does not define the structure).
  const TlbEntry* find(std::uint32_t mva) const {
    for (const auto& e : locked_)
      if (e.covers(mva)) return &e;
    for (unsigned shift : {20u, 12u, 16u, 10u})
      for (const auto& e : main_[(mva >> shift) & 31u])
        if (e.covers(mva)) return &e;
    return nullptr;
  }
  void insert(const TlbEntry& e, bool lock, unsigned victim) {
    if (lock) {
      locked_[victim & 7u] = e;
      return;
    }
    const unsigned shift = e.mask == 0xFFFFFu  ? 20
                           : e.mask == 0xFFFu  ? 12
                           : e.mask == 0xFFFFu ? 16
                                               : 10;
    const unsigned set = (e.base_va >> shift) & 31u;
    main_[set][next_[set]] = e;
    next_[set] ^= 1u;
  }
  void invalidate_all() {  // locked entries stay
    for (auto& s : main_)
      for (auto& e : s) e.valid = false;
  }
  void invalidate(std::uint32_t mva) {
    for (auto& s : main_)
      for (auto& e : s)
        if (e.covers(mva)) e.valid = false;
    for (auto& e : locked_)
      if (e.covers(mva)) e.valid = false;
  }

 private:
  std::array<std::array<TlbEntry, 2>, 32> main_{};
  std::array<std::uint8_t, 32> next_{};
  std::array<TlbEntry, 8> locked_{};
};

}  // namespace fovea::cpu
