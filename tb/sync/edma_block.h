// The EDMA's channel controller with one transfer controller, for the test of the time rule.
#pragma once
#include <cstdint>
#include <functional>
#include <systemc>

#include "model/bus/config_bus.h"
#include "model/bus/scr.h"
#include "model/dma/edma_cc.h"
#include "model/dma/edma_tc.h"

namespace fovea::sync {

/// Transfer controller 3 with its two masters; queue 3 is mapped to it.
struct EdmaBlock {
  static constexpr unsigned kNumber = 3, kChannel = 3;
  static constexpr std::uint32_t kBase = 0x01E0'0000, kTcBase = 0x01E1'0000;

  dma::EdmaParams params;
  dma::EdmaTcParams tc_params;
  dma::EdmaCc channels{"edma", params};
  dma::EdmaTc tc{"edma_tc", kNumber, tc_params};
  sc_core::sc_signal<bool> completion{"completion"}, error{"error"}, tc_error{"tc_error"};
  sc_core::sc_signal<std::uint32_t> misc{"misc"};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority{"tc_priority", kTransferControllers};
  std::function<void()> on_interrupt;

  EdmaBlock(bus::Scr& scr, bus::ConfigBus& config, ClockSignal& clk, sc_core::sc_signal<bool>& on) {
    channels.clk(clk);
    channels.lpsc(on);
    channels.completion.out(completion);
    channels.error.out(error);
    for (unsigned n = 0; n < kTransferControllers; ++n) channels.priority[n](priority[n]);
    tc.clk(clk);
    tc.lpsc(on);
    tc.error.out(tc_error);
    tc.misc(misc);
    tc.attach(channels);
    for (const MasterPort& p : tc.masters()) p.socket->bind(*scr.target[index(p.id)]);
    config.to("edma").bind(channels.reg_socket);
    config.to("edma_tc").bind(tc.reg_socket);
    channels.regs.write(0x240, 4, kNumber << 4 * kChannel);  // DMAQNUM0
    channels.regs.write(0x340, 4, 1u << kChannel);           // DRAE0
    channels.regs.write(0x2060, 4, 1u << kChannel);          // IESR
    sc_core::sc_spawn_options options;
    options.spawn_method();
    options.dont_initialize();
    options.set_sensitivity(&completion.posedge_event());
    sc_core::sc_spawn(
        [this] {
          channels.regs.write(0x2070, 4, 1u << kChannel);  // ICR
          if (on_interrupt) on_interrupt();
        },
        "edma_interrupt", &options);
  }

  /// Software writes a set and triggers it: up to three arrays of up to 128 bytes within 16 KiB from `base`, with any
  /// alignment, as `random` says. One that comes before the last one was served is a missed event.
  void start(std::uint32_t base, std::uint32_t random) {
    const std::uint32_t source = base + (random & 0xFFFu), target = base + 0x2000 + (random >> 4 & 0xFFFu);
    const std::uint32_t words[8] = {(random >> 28 & 1u) << 2 | 1u << 20 | (random >> 29 & 1u) << 23 | kChannel << 12,
                                    source,
                                    (1 + (random >> 16 & 0x7Fu)) | (1 + (random >> 23) % 3) << 16,
                                    target,
                                    200 | 130u << 16,
                                    0xFFFF,
                                    0,
                                    1};
    for (unsigned w = 0; w < 8; ++w) channels.regs.write(0x4000 + 32 * kChannel + 4 * w, 4, words[w]);
    channels.regs.write(0x308, 4, 1u << kChannel);   // EMCR
    channels.regs.write(0x2040, 4, 1u << kChannel);  // SECR
    channels.regs.write(0x2010, 4, 1u << kChannel);  // ESR
  }
};

}  // namespace fovea::sync
