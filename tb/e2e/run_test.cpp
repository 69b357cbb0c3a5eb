// Figures of a run as `fovea run` reports them: conservation, arithmetic of the video streams.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <systemc>

#include "model/common/masters.h"
#include "sw/fovea/simulation.h"

namespace fovea::e2e {
namespace {

class Quiet : public app::ProgressSink {
  void update(const app::Progress&) override {}
};

app::RunResult run(const std::vector<std::pair<std::string, std::string>>& keys,
                   bool strict = false) {
  static auto simulation = app::make_simulation();
  static ParamSet set;
  simulation->declare(set);
  set.set("camera.kind", "chart");
  set.set("camera.stamp", "false");
  set.set("firmware.elf", std::string(FOVEA_FIRMWARE_DIR) + "/fovea_firmware.elf");
  for (const auto& [key, value] : keys) set.set(key, value);
  static std::atomic<bool> stop{false};
  static Quiet progress;
  app::RunRequest request{set, {}, strict, stop, progress, {}};
  return simulation->run(request);
}

std::uint64_t count(const app::RunResult& r, const std::string& name) {
  const app::StatRow* row = app::find(r.stats, name);
  EXPECT_TRUE(row) << name;
  return row ? std::get<std::uint64_t>(row->value) : 0;
}
double real(const app::RunResult& r, const std::string& name) {
  const app::StatRow* row = app::find(r.stats, name);
  EXPECT_TRUE(row) << name;
  return row ? std::get<double>(row->value) : 0;
}

/// Every cycle has one cause; every byte on the SDRAM has one master.
void expect_conservation(const app::RunResult& r) {
  std::uint64_t causes = count(r, "cpu.issue") + count(r, "cpu.idle");
  for (const char* cause : {"interlock", "icache", "dcache", "write_buffer", "uncached", "tlb",
                            "tcm", "cache_op", "drain", "bus_sync"})
    causes += count(r, std::string("cpu.stall.") + cause);
  EXPECT_EQ(count(r, "cpu.cycles"), causes);
  std::uint64_t read = 0, write = 0;
  for (auto name : kMasterNames) {
    read += count(r, "bus." + std::string(name) + ".read_bytes");
    write += count(r, "bus." + std::string(name) + ".write_bytes");
  }
  // Register accesses go over the same crossbar but not to the SDRAM; they are counted apart.
  EXPECT_EQ(count(r, "ddr.read_bytes"), read - count(r, "bus.config.read_bytes"));
  EXPECT_EQ(count(r, "ddr.write_bytes"), write - count(r, "bus.config.write_bytes"));
}

TEST(RunTest, SmallPalRegionConservesCyclesAndBytes) {
  const auto r = run({{"video.width", "320"}, {"video.height", "64"}, {"run.frames", "10"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  expect_conservation(r);
  EXPECT_EQ(count(r, "frame.displayed"), 10u);
  EXPECT_EQ(count(r, "frame.dropped"), 0u);
  EXPECT_DOUBLE_EQ(real(r, "frame.rate"), 25.0);
  EXPECT_DOUBLE_EQ(real(r, "frame.window"), 0.4);
  // 320 x 64 pairs of bytes, ten frames in and ten out.
  EXPECT_EQ(count(r, "bus.vpfe.write_bytes"), 320u * 64 * 2 * 10);
  EXPECT_EQ(count(r, "bus.vpbe.read_bytes"), 320u * 64 * 2 * 10);
  // The window is 0.4 s of a 297 MHz clock, to the instruction at each end.
  EXPECT_NEAR(static_cast<double>(count(r, "cpu.cycles")), 0.4 * 297e6, 200);
  // One word out for each pair, and no other uncached or missing stores of that size class.
  EXPECT_GE(count(r, "cpu.dcache.write_misses"), 320u / 2 * 64 * 10);
}

TEST(RunTest, NtscWindowHasTheTelevisionRate) {
  const auto r = run({{"video.standard", "ntsc"}, {"video.width", "160"},
                      {"video.height", "48"}, {"run.frames", "10"}});
  ASSERT_TRUE(r.complete) << r.guest_failure << r.uart;
  expect_conservation(r);
  EXPECT_NEAR(real(r, "frame.rate"), 30000.0 / 1001, 1e-6);
  EXPECT_EQ(count(r, "bus.vpfe.write_bytes"), 160u * 48 * 2 * 10);
}

}  // namespace
}  // namespace fovea::e2e

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
