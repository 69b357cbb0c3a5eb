// The internal RAM with its two windows, and the core's accesses to it beside other masters'.
#pragma once
#include <cstdint>
#include <span>

#include "model/contract/memory_map.h"
#include "model/cpu/core/bus_interface.h"
#include "model/cpu/core/params.h"
#include "model/cpu/core/stall_ledger.h"
#include "model/cpu/core/tcm_port.h"

namespace fovea::cpu {

/// The physical address selects internal RAM (model/decisions/0008-internal-ram.md). Data accesses
/// reach it through both windows, instruction fetches only through that of the instruction TCM.
///
/// The core runs ahead strictly before a burst of the DMA arrives, and before its data are moved.
/// Between these two, each access of the core is checked in access().
class InternalRam {
 public:
  static constexpr std::uint32_t kDtcmBase = INTERNAL_RAM_DATA_BASE;

  InternalRam(const CpuParams& params, BusInterface& interface, StallLedger& ledger,
              std::span<std::uint8_t> bytes)
      : interface_(interface),
        ledger_(ledger),
        bytes_(bytes),
        port_({static_cast<unsigned>(params.tcm_dma_word_clocks()),
               static_cast<unsigned>(params.tcm_dma_latency()),
               static_cast<unsigned>(params.tcm_banks()), params.tcm_first.is("core")},
              bytes.size()),
        wait_(static_cast<unsigned>(params.tcm_wait_states())),
        own_conflict_(static_cast<unsigned>(params.tcm_own_conflict())) {}

  bool in_itcm(std::uint32_t pa) const { return pa < itcm_size_; }
  bool in_dtcm(std::uint32_t pa) const { return pa - kDtcmBase < dtcm_size_; }
  bool contains(std::uint32_t pa) const { return in_itcm(pa) || in_dtcm(pa); }
  std::uint32_t offset(std::uint32_t pa) const {
    return pa & static_cast<std::uint32_t>(bytes_.size() - 1);
  }
  std::uint8_t* at(std::uint32_t pa) { return bytes_.data() + offset(pa); }
  const std::uint8_t* at(std::uint32_t pa) const { return bytes_.data() + offset(pa); }
  bool empty() const { return bytes_.empty(); }
  std::uint32_t size() const { return static_cast<std::uint32_t>(bytes_.size()); }

  /// The counter of loads and of stores through the window of an address.
  std::uint64_t& reads_of(std::uint32_t pa) {
    return in_itcm(pa) ? ledger_.counts.itcm_reads : ledger_.counts.dtcm_reads;
  }
  std::uint64_t& writes_of(std::uint32_t pa) {
    return in_itcm(pa) ? ledger_.counts.itcm_writes : ledger_.counts.dtcm_writes;
  }

  /// Sizes of the two windows; 0: off.
  void set_itcm(std::uint32_t bytes) { itcm_size_ = bytes; }
  void set_dtcm(std::uint32_t bytes) { dtcm_size_ = bytes; }
  void set_wait_states(unsigned clocks) { wait_ = clocks; }
  /// True if accesses cost no extra clocks and no DMA can interfere.
  bool quick() const { return (wait_ | own_conflict_) == 0 && !port_.busy(); }
  bool own_conflicts() const { return own_conflict_ != 0; }

  /// To be called for an access of the core: waits until all agents that act before the time of the
  /// access have acted, and for the bank.
  /// @param conflicts the executed instruction was fetched from the bank that holds `pa`
  /// @return clocks waited for words of other masters
  std::uint64_t access(std::uint32_t pa, TcmPort::Side side, bool conflicts);
  unsigned wait_states() const { return wait_; }

  TcmPort& port() { return port_; }
  const TcmPort& port() const { return port_; }
  std::span<std::uint8_t> burst_bytes() {
    return bytes_.subspan(port_.burst().offset, port_.burst().bytes);
  }

 private:
  BusInterface& interface_;
  StallLedger& ledger_;
  std::span<std::uint8_t> bytes_;
  TcmPort port_;
  std::uint32_t itcm_size_ = 0, dtcm_size_ = 0;
  unsigned wait_, own_conflict_;
};

}  // namespace fovea::cpu
