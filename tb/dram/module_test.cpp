// Crossbar and DDR controller as modules, with the kernel between them: whatever moves the
// controller's next decision must reach the crossbar's process, which waits for it.
#include <gtest/gtest.h>

#include <systemc>

#include "model/bus/config_bus.h"
#include "model/bus/scr.h"
#include "model/common/burst_master.h"
#include "model/common/quiet.h"
#include "model/mem/ddr_module.h"

namespace fovea::dram {
namespace {

constexpr std::uint32_t kDdr = 0x8000'0000;
constexpr Frequency kFast(243'000'000), kSlow(1'000'000);

struct Bench {
  bus::CrossbarParams xbar_params;
  bus::ConfigBusParams config_params;
  mem::DdrParams ddr_params;
  QuietPhase quiet{"quiet"};
  bus::Scr scr{"scr", xbar_params, {}, false};
  bus::ConfigBus config{"config",
                        config_params,
                        quiet,
                        {{"ddr", 0x2000'0000, 0x8000, bus::ConfigBus::Speed::kFast}}};
  mem::DdrModule ddr{"ddr", ddr_params};
  BurstMaster master{"master", Master::kLoad, 4};
  ClockSignal ddr_clk{"ddr_clk", kFast}, scr_clk{"scr_clk", Frequency(121'500'000)};
  sc_core::sc_signal<bool> on{"on", true};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority{"priority", kMasterCount};
  struct Done {
    Picoseconds seen, first, last;
    bool error;
  };
  std::vector<Done> done;

  Bench() {
    scr.clk(scr_clk);
    scr.ddr_socket.bind(ddr.socket);
    scr.ddr_lookahead.bind(ddr.lookahead);
    scr.config_socket.bind(config.socket);
    ddr.ddr_clk(ddr_clk);
    ddr.scr_clk(scr_clk);
    ddr.enabled(on);
    config.to("ddr").bind(ddr.reg_socket);
    for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](priority[i]);
    master.socket.bind(*scr.target[index(Master::kLoad)]);
    master.on_done = [this](const BurstMaster::Completion& c) {
      done.push_back({kernel_time(), c.first, c.last, c.error});
    };
    ddr.regs.write(0x0C, 4, 1895);
    ddr.regs.write(0x08, 4, 0x00534A32);
  }
};
Bench* bench = nullptr;

class ModuleTest : public testing::Test {
 protected:
  Bench& b = *bench;
  void SetUp() override {
    b.ddr_clk.write(kFast);
    b.scr_clk.write(Frequency(121'500'000));
    run_for(10 * kPsPerUs);
    b.done.clear();
  }
  /// The end is a kernel event, so that the path does not run past it.
  void run_for(Picoseconds t) {
    end_.notify(ps_time(t));
    sc_core::sc_start(ps_time(t));
  }
  sc_core::sc_event end_;
};

TEST_F(ModuleTest, RequestQueuedWhenTheSdramClockStopsIsServedAfterItsRestart) {
  b.ddr_clk.write(kSlow);
  run_for(5 * kPsPerUs);
  b.master.read(kDdr, 64);
  run_for(2 * kPsPerUs);
  ASSERT_TRUE(b.done.empty());
  b.ddr_clk.write(Frequency());
  run_for(50 * kPsPerUs);
  ASSERT_TRUE(b.done.empty());
  b.ddr_clk.write(kFast);
  run_for(10 * kPsPerUs);
  ASSERT_EQ(b.done.size(), 1u);
  EXPECT_FALSE(b.done[0].error);
  EXPECT_EQ(b.done[0].seen, b.done[0].last);
}

TEST_F(ModuleTest, FasterSdramClockBringsTheNextDecisionForward) {
  b.ddr_clk.write(kSlow);
  run_for(5 * kPsPerUs);
  b.master.read(kDdr + 0x10000, 64);
  run_for(2 * kPsPerUs);
  ASSERT_TRUE(b.done.empty());
  b.ddr_clk.write(kFast);
  run_for(100 * kPsPerUs);
  ASSERT_EQ(b.done.size(), 1u);
  EXPECT_FALSE(b.done[0].error);
  EXPECT_EQ(b.done[0].seen, b.done[0].last) << "the outcome is reported at its last beat";
}

TEST_F(ModuleTest, RequestWhileTheSdramClockStandsEndsInABusError) {
  b.ddr_clk.write(Frequency());
  run_for(5 * kPsPerUs);
  b.master.read(kDdr, 64);
  run_for(5 * kPsPerUs);
  ASSERT_EQ(b.done.size(), 1u);
  EXPECT_TRUE(b.done[0].error);
}

}  // namespace
}  // namespace fovea::dram

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  fovea::dram::Bench bench;
  fovea::dram::bench = &bench;
  return RUN_ALL_TESTS();
}
