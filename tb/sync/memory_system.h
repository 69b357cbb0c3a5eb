// Crossbar, configuration bus and SDRAM as the tests of the time rule use them: no video, no firmware.
#pragma once
#include <systemc>

#include "model/bus/config_bus.h"
#include "model/bus/scr.h"
#include "model/common/end_of_instant.h"
#include "model/mem/ddr_module.h"

namespace fovea::sync {

/// The registers as TI's boot loader (UBL) leaves them for 243 MHz.
inline void start_sdram(mem::DdrModule& ddr) {
  ddr.regs.write(0x08, 4, 0x00D3CA32);  // BOOTUNLOCK
  ddr.regs.write(0x08, 4, 0x0053CA32);  // TIMUNLOCK
  ddr.regs.write(0x10, 4, 30u << 25 | 4u << 22 | 4u << 19 | 3u << 16 | 10u << 11 | 15u << 6 |
                              2u << 3 | 2u);
  ddr.regs.write(0x14, 4, 1u << 5 | 33u << 16);
  ddr.regs.write(0x0C, 4, 1895);
  ddr.regs.write(0xE4, 4, 5);
  ddr.regs.write(0x20, 4, 0xFE);
  ddr.regs.write(0x08, 4, 0x00534A32);
}

struct MemorySystem {
  MemorySystem(bus::AddressMap map, bool strict, Frequency ddr_clock, Frequency scr_clock)
      : scr("scr", xbar_params, ddr_params, map, strict),
        config("config", config_params, end_of_instant,
               {{"ddr", 0x2000'0000, 0x8000, bus::ConfigBus::Speed::kFast}}),
        ddr("ddr", ddr_params, scr.memory()),
        ddr_clk("ddr_clk", ddr_clock),
        scr_clk("scr_clk", scr_clock) {
    for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](priority[i]);
    scr.clk(scr_clk);
    scr.config_socket.bind(config.socket);
    ddr.ddr_clk(ddr_clk);
    ddr.scr_clk(scr_clk);
    ddr.enabled(on);
    config.to("ddr").bind(ddr.reg_socket);
    start_sdram(ddr);
  }

  EndOfInstant end_of_instant{"end_of_instant"};
  bus::CrossbarParams xbar_params;
  bus::ConfigBusParams config_params;
  mem::DdrParams ddr_params;
  bus::Scr scr;
  bus::ConfigBus config;
  mem::DdrModule ddr;
  ClockSignal ddr_clk, scr_clk;
  sc_core::sc_signal<bool> on{"on", true};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority{"priority", kMasterCount};
};

}  // namespace fovea::sync
