// The CPLD on TI's DM365 evaluation board.
#pragma once
#include <cstdint>
#include <systemc>

#include "model/board/board_params.h"
#include "model/common/bus_target.h"
#include "model/periph/clocked_target.h"

namespace fovea::board {

/// Byte registers on AEMIF CE1; names and offsets: Linux board-dm365-evm.c. What TI's CPLD holds
/// out of reset is not public: 0 is assumed where nothing else is said.
struct CpldRegs : RegBank {
  explicit CpldRegs(std::uint32_t switches);
  Reg leds{*this, "LEDS", 0x10, "1: LED off"};
  Field leds_all{leds, "LEDS", 0, 8, Mode::kRw, "one bit an LED"};
  Reg mux{*this, "MUX", 0x18, "external multiplexers"};
  Field video{mux, "VIDEO", 0, 3, Mode::kRw, "1, 6: TVP7002; 2, 7: imager; 5: TVP5146"};
  Field mux_other{mux, "OTHER", 3, 5, Mode::kRw, "imager or MMC1, ENET, AIC33; key pad; kept"};
  Reg switches;
  Reg cardstat;
  Reg resets{*this, "RESETS", 0x1018, "1 holds a chip in reset"};
  Field reset_tvp5146{resets, "TVP5146", 0, 1, Mode::kRw, "video decoder"};
  Field reset_aic33{resets, "AIC33", 1, 1, Mode::kRw, "audio codec; not modelled"};
  Field reset_tvp7002{resets, "TVP7002", 2, 1, Mode::kRw, "component decoder; not modelled"};
  Field reset_enet{resets, "ENET", 3, 1, Mode::kRw, "Ethernet PHY; not modelled"};
};

/// MUX and RESETS move no wires here: the decoder stays connected, and settings that would take its
/// picture away are reported once. The bus access costs what a register on the slow part of the
/// configuration bus costs (bus.config.slow_latency; the interface's own wait states are not
/// modelled).
class EvmCpld : public WithRegs<CpldRegs>, public BusTarget {
 public:
  /// Decoded part of CE1 (assumed: the registers lie below 64 KB).
  static constexpr std::uint32_t kBytes = 0x1'0000;
  EvmCpld(sc_core::sc_module_name name, const DevicesParams& params);
  /// It is not on the chip: the watchdog's reset does not leave the chip (assumed).
  void reset(ResetKind kind) override {
    if (kind != ResetKind::kWatchdog) BusTarget::reset(kind);
  }
};

}  // namespace fovea::board
