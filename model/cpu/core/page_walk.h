// The walk of the page tables (ARM DDI 0198D chapter 3). The only one: the MMU reads the tables
// over the bus and a debugger reads them without time, both through this function.
#pragma once
#include <cstdint>

#include "model/cpu/core/tlb.h"

namespace fovea::cpu {

/// Values of the fault status registers' status field.
enum class Fault : std::uint8_t {
  kNone = 0,
  kAlignment = 0x1,
  kBreakpoint = 0x2,
  kSectionTranslation = 0x5,
  kPageTranslation = 0x7,
  kSectionBus = 0x8,
  kSectionDomain = 0x9,
  kPageBus = 0xA,
  kPageDomain = 0xB,
  kFirstLevelBus = 0xC,
  kSectionPermission = 0xD,
  kSecondLevelBus = 0xE,
  kPagePermission = 0xF,
};

struct PageWalk {
  Fault fault = Fault::kNone;  ///< kNone: `entry` is valid
  TlbEntry entry;              ///< its domain is valid for faults of the second level too
};

/// Address of the first-level descriptor of an address.
constexpr std::uint32_t first_level_address(std::uint32_t ttbr, std::uint32_t mva) {
  return (ttbr & 0xFFFFC000u) | (mva >> 20) << 2;
}

/// @param read bool(std::uint32_t address, std::uint32_t& word): reads a descriptor; false if the
///        bus refuses
template <class Read>
PageWalk walk_page_tables(std::uint32_t ttbr, std::uint32_t mva, Read read) {
  enum : std::uint32_t { kInvalid, kCoarse, kSection, kFine };  // kinds of first-level descriptors
  enum : std::uint32_t { kLarge = 1, kSmall, kTiny };           // kinds of pages
  PageWalk w;
  TlbEntry& e = w.entry;
  const auto failed = [&w](Fault fault) {
    w.fault = fault;
    return w;
  };
  const auto found = [&](std::uint32_t descriptor, std::uint32_t mask) {
    e.valid = true;
    e.mask = mask;
    e.base_va = mva & ~mask;
    e.base_pa = descriptor & ~mask;
    e.cacheable = descriptor >> 3 & 1u;
    e.bufferable = descriptor >> 2 & 1u;
    return w;
  };
  const auto permissions = [](std::uint32_t descriptor, unsigned from) {
    return static_cast<std::uint8_t>(descriptor >> from & 3u);
  };

  std::uint32_t first = 0, second = 0;
  if (!read(first_level_address(ttbr, mva), first)) return failed(Fault::kFirstLevelBus);
  e.domain = static_cast<std::uint8_t>(first >> 5 & 15u);
  const std::uint32_t kind = first & 3u;
  if (kind == kInvalid) return failed(Fault::kSectionTranslation);
  if (kind == kSection) {
    e.section = true;
    e.ap.fill(permissions(first, 10));
    return found(first, 0xFFFFFu);
  }
  const bool fine = kind == kFine;
  const std::uint32_t address = fine ? (first & 0xFFFFF000u) | (mva >> 10 & 0x3FFu) << 2
                                     : (first & 0xFFFFFC00u) | (mva >> 12 & 0xFFu) << 2;
  if (!read(address, second)) return failed(Fault::kSecondLevelBus);
  const std::uint32_t page = second & 3u;
  if (page == kTiny && fine) {
    e.ap.fill(permissions(second, 4));
    return found(second, 0x3FFu);
  }
  if (page != kLarge && page != kSmall) return failed(Fault::kPageTranslation);
  for (unsigned quarter = 0; quarter < 4; ++quarter)
    e.ap[quarter] = permissions(second, 4 + 2 * quarter);
  return found(second, page == kLarge ? 0xFFFFu : 0xFFFu);
}

}  // namespace fovea::cpu
