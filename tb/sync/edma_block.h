// The EDMA's channel controller with two transfer controllers, for the test of the time rule.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <systemc>

#include "model/bus/config_bus.h"
#include "model/bus/scr.h"
#include "model/dma/edma_cc.h"
#include "model/dma/edma_tc.h"

namespace fovea::sync {

/// Transfer controllers 2 and 3 with two masters each, behind the queues 2 and 3: a QDMA channel uses the one, a DMA
/// channel the other. Their completion codes are kQuickCode and kChannel.
struct EdmaBlock {
  static constexpr unsigned kChannel = 3, kQuick = 1, kQuickSet = 70, kQuickCode = 9;
  static constexpr std::uint32_t kBase = 0x01E0'0000, kTcBase = 0x01E1'0000, kTcPitch = 0x400;
  static constexpr std::uint32_t kCodes = 1u << kChannel | 1u << kQuickCode;

  dma::EdmaParams params;
  dma::EdmaTcParams tc_params;
  dma::EdmaCc channels{"edma", params};
  dma::EdmaTc tc2{"edma_tc2", 2, tc_params}, tc3{"edma_tc3", 3, tc_params};
  const std::array<dma::EdmaTc*, 2> tcs{&tc2, &tc3};
  sc_core::sc_signal<bool> completion{"completion"}, error{"error"};
  sc_core::sc_vector<sc_core::sc_signal<bool>> tc_error{"tc_error", 2};
  sc_core::sc_signal<std::uint32_t> misc{"misc"};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority{"tc_priority", kTransferControllers};
  std::function<void()> on_interrupt;

  EdmaBlock(bus::Scr& scr, bus::ConfigBus& config, ClockSignal& clk, sc_core::sc_signal<bool>& on) {
    channels.clk(clk);
    channels.lpsc(on);
    channels.completion.out(completion);
    channels.error.out(error);
    for (unsigned n = 0; n < kTransferControllers; ++n) channels.priority[n](priority[n]);
    for (std::size_t n = 0; n < tcs.size(); ++n) {
      dma::EdmaTc& tc = *tcs[n];
      tc.clk(clk);
      tc.lpsc(on);
      tc.error.out(tc_error[n]);
      tc.misc(misc);
      tc.attach(channels);
      for (const MasterPort& p : tc.masters()) p.socket->bind(*scr.target[index(p.id)]);
    }
    config.to("edma").bind(channels.reg_socket);
    config.to("edma_tc2").bind(tc2.reg_socket);
    config.to("edma_tc3").bind(tc3.reg_socket);
    channels.regs.write(0x240, 4, 3u << 4 * kChannel);                 // DMAQNUM0
    channels.regs.write(0x260, 4, 2u << 4 * kQuick);                   // QDMAQNUM
    channels.regs.write(0x200 + 4 * kQuick, 4, kQuickSet << 5 | 7u << 2);  // QCHMAP: CCNT triggers
    channels.regs.write(0x340, 4, kCodes);                             // DRAE0
    channels.regs.write(0x380, 4, 1u << kQuick);                       // QRAE0
    channels.regs.write(0x208C, 4, 1u << kQuick);                      // QEESR
    channels.regs.write(0x2060, 4, kCodes);                            // IESR
    sc_core::sc_spawn_options options;
    options.spawn_method();
    options.dont_initialize();
    options.set_sensitivity(&completion.posedge_event());
    sc_core::sc_spawn(
        [this] {
          channels.regs.write(0x2070, 4, kCodes);  // ICR
          if (on_interrupt) on_interrupt();
        },
        "edma_interrupt", &options);
  }

  /// Software writes a set and triggers it: up to three arrays of up to 128 bytes, with any alignment, each side in
  /// the first 16 KiB of SDRAM or of internal RAM, as `random` says. One that comes before the last one of its channel
  /// was served is a missed event.
  void start(std::uint32_t sdram, std::uint32_t ram, std::uint32_t random) {
    const bool quick = random >> 12 & 1u;
    const std::uint32_t source = (random >> 13 & 3u ? sdram : ram) + (random & 0xFFFu);
    const std::uint32_t target = (random >> 30 ? sdram : ram) + 0x2000 + (random >> 4 & 0xFFFu);
    const unsigned code = quick ? kQuickCode : kChannel, set = quick ? kQuickSet : kChannel;
    const std::uint32_t chain = quick ? 0 : random >> 29 & 1u;  // ITCCHEN, of the channel itself
    const std::uint32_t words[8] = {(random >> 28 & 1u) << 2 | 1u << 20 | chain << 23 | code << 12,
                                    source,
                                    (1 + (random >> 16 & 0x7Fu)) | (1 + (random >> 23) % 3) << 16,
                                    target,
                                    200 | 130u << 16,
                                    0xFFFF,
                                    0,
                                    1};
    const std::uint32_t bit = quick ? 1u << kQuick : 1u << kChannel;
    channels.regs.write(quick ? 0x314 : 0x308, 4, bit);    // QEMCR or EMCR
    channels.regs.write(quick ? 0x2094 : 0x2040, 4, bit);  // QSECR or SECR
    for (unsigned w = 0; w < 8; ++w) channels.regs.write(0x4000 + 32 * set + 4 * w, 4, words[w]);
    if (!quick) channels.regs.write(0x2010, 4, bit);  // ESR
  }
};

}  // namespace fovea::sync
