// The registers of CP15 that software sets (ARM DDI 0198D chapter 2).
#pragma once
#include <cstdint>

namespace fovea::cpu {

/// Bits of the control register (c1).
inline constexpr std::uint32_t kMmuOn = 1u << 0, kAlignmentChecked = 1u << 1, kDcacheOn = 1u << 2,
                               kSystemProtection = 1u << 8, kRomProtection = 1u << 9,
                               kIcacheOn = 1u << 12, kHighVectors = 1u << 13,
                               kRoundRobin = 1u << 14, kArmV4Loads = 1u << 15;

/// Plain values. The code that changes one informs the parts that keep something derived from it
/// (Core::cp15_write).
struct SystemRegisters {
  static constexpr std::uint32_t kControlAtReset = 0x0005'0078;

  bool mmu_on() const { return control & kMmuOn; }
  /// Cacheable pages use the D-cache.
  bool data_cached() const { return (control & (kMmuOn | kDcacheOn)) == (kMmuOn | kDcacheOn); }
  /// The modified virtual address of a data access (FCSE, ARM DDI 0198D 2-34).
  std::uint32_t modified(std::uint32_t va) const { return va < 0x0200'0000u ? va | process : va; }

  std::uint32_t control = kControlAtReset;
  std::uint32_t ttbr = 0, dacr = 0, dfsr = 0, ifsr = 0, far = 0;
  std::uint32_t fcse_pid = 0, context_id = 0;
  std::uint32_t process = 0;  // the FCSE PID while the MMU is on, otherwise 0 (ARM DDI 0198D 2-34)
  std::uint32_t dlock = 0, ilock = 0, tlb_lock = 0;
  std::uint32_t itcm_region = 0, dtcm_region = 0, debug_override = 0, cache_debug = 0;
};

}  // namespace fovea::cpu
