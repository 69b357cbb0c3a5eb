// OSD, VENC and display: bursts from memory, data that come too late, and clocks of the encoder that change.
#include <gtest/gtest.h>

#include "tb/video/display_bench.h"

namespace fovea::video {
namespace {

TEST_F(DisplayTest, ReadsAreBurstsOf64TheConfiguredLinesAhead) {
  const Clock clock(kByteClock);
  const std::uint64_t origin = clock.edge_after(kernel_time());
  show(1);
  ASSERT_GE(b.memory.log.size(), std::size_t{23} * kRows);
  const Picoseconds ahead =
      clock.edge(origin + ((kIs625 ? 22u : 16u) - kAhead) * kStd.line_bytes);
  EXPECT_EQ(b.memory.log[0].time, ahead);
  const unsigned kAtOnce = kOutstanding;
  EXPECT_EQ(b.memory.log[kAtOnce - 1].time, ahead);
  EXPECT_EQ(b.memory.log[kAtOnce].time, ahead + b.memory.latency);
  EXPECT_EQ(b.memory.log[0].bytes, 64u);
  EXPECT_EQ(b.memory.log[0].address, kBuffer);
}

TEST_F(DisplayTest, DataDueAtTheirArrivalAreTooLateAndOnePicosecondEarlierAreNot) {
  // 64 bytes a line, read kAhead lines before its own start: due after these and the blanking.
  // Rows of 1440 bytes: the upper field's are one burst of 64, the lower field's two of 32.
  b.osd_regs.write(XL, 32);
  const Clock clock(kByteClock);
  const Picoseconds due = clock.edge(kAhead * kStd.line_bytes + kStd.active_offset());
  b.memory.latency = due - 2;  // edges round down: the interval may be shorter by 1 ps
  show(1);
  EXPECT_EQ(underflows(), 0u);
  EXPECT_EQ(b.frames[0].picture.row(100)[0], pattern(100, 0));
  b.venc_regs.write(VMOD, 0);
  run_for(kPsPerMs);
  b.memory.latency = due + 1;
  show(1);
  EXPECT_EQ(underflows(), kRows) << "the first burst of each line; the second is due later";
  EXPECT_EQ(b.frames[1].picture.row(100)[0], 0x80);
  EXPECT_EQ(b.frames[1].picture.row(101)[31], 0x10);
  EXPECT_EQ(b.frames[1].picture.row(101)[32], pattern(101, 32));
  EXPECT_EQ(b.frames[1].underflows, kRows);
}

TEST_F(DisplayTest, HopelessMemoryGivesBlackAndCountsEveryBurst) {
  b.memory.latency = 5 * kPsPerMs;
  show(1);
  EXPECT_EQ(underflows(), std::uint64_t{23} * kRows);
  EXPECT_EQ(b.frames[0].picture, Picture(720, kRows));
  b.venc_regs.write(VMOD, 0);
  run_for(25 * kPsPerMs);  // late answers come when no read waits for them
}

// Bit 6 of MISCCTL.
TEST_F(DisplayTest, LateDataSetAFlagThatStaysUntilOneIsWritten) {
  constexpr std::uint32_t kMiscctl = 0xE8, kDmang = 1u << 6;
  b.osd_regs.write(kMiscctl, kDmang | 0x10);
  show(2);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u) << "none is late";
  b.memory.latency = 5 * kPsPerMs;
  show(1);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u | kDmang);
  b.memory.latency = 100 * kPsPerNs;
  run_for(10 * kPsPerMs);
  show(2);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u | kDmang) << "it stays";
  b.osd_regs.write(kMiscctl, 0x10);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u | kDmang) << "writing 0 does not clear it";
  b.osd_regs.write(kMiscctl, 0x10 | kDmang);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u);
  show(1);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u);
  // A chip that uses the bit for something else.
  b.params.miscctl_6.set("rgbwin");
  b.memory.latency = 5 * kPsPerMs;
  show(1);
  EXPECT_EQ(b.osd_regs.read(kMiscctl), 0x10u);
  b.diagnostics.clear();
  b.osd_regs.write(kMiscctl, kDmang);
  ASSERT_EQ(b.diagnostics.counts().size(), 1u);
  EXPECT_EQ(b.diagnostics.counts().begin()->first.second, "OSD MISCCTL.RGBWIN");
  b.diagnostics.clear();
  b.params.miscctl_6.set("dmang");
  b.osd_regs.write(kMiscctl, kDmang);
  b.venc_regs.write(VMOD, 0);
  run_for(25 * kPsPerMs);
}

TEST_F(DisplayTest, WhatIsLateAlreadyIsNotRead) {
  const Clock clock(kByteClock);
  const std::uint64_t origin = clock.edge_after(kernel_time());
  b.memory.latency = 300 * kPsPerUs;  // almost five lines; places for kOutstanding bursts
  show(1);
  EXPECT_GT(underflows(), 0u);
  const std::uint64_t first[2] = {kIs625 ? 22u : 16u, kIs625 ? 335u : 279u};
  std::size_t reads = 0;
  for (const auto& r : b.memory.log) {
    if (r.time >= b.frames[0].times.display_end) break;
    ++reads;
    const unsigned row = (r.address - kBuffer) / kPitch, byte = (r.address - kBuffer) % kPitch;
    const Picoseconds due = clock.edge(origin + (first[row % 2] + row / 2) * kStd.line_bytes +
                                       kStd.active_offset() + byte);
    ASSERT_LT(r.time, due) << "row " << row << " byte " << byte;
  }
  EXPECT_GT(reads, 100u);
  b.venc_regs.write(VMOD, 0);
  run_for(kPsPerMs);
}

TEST_F(DisplayTest, WrongClockIsCaughtByTheDisplay) {
  b.clock.write(Frequency(26'538'461));
  b.venc_regs.write(VMOD, kOn);
  run_for(2 * kField);
  EXPECT_GT(b.sink.stats.violations.count(), violations_ + 100);
  b.venc_regs.write(VMOD, 0);
  b.clock.write(kByteClock);
  run_for(kPsPerUs);
  violations_ = b.sink.stats.violations.count();
}

TEST_F(DisplayTest, WithTheHalvingSelectorEachLineLastsTwiceAsLong) {
  b.params.venc_clk_sel.set("halves");
  b.venc_regs.write(VMOD, kOn);
  while (b.edges.rises.size() < 3) run_for(kPsPerMs);
  const Picoseconds whole = b.edges.rises[2] - b.edges.rises[0];
  b.edges.rises.clear();
  b.clk_sel.write(true);
  while (b.edges.rises.size() < 4) run_for(kPsPerMs);
  EXPECT_NEAR(static_cast<double>(b.edges.rises[3] - b.edges.rises[1]),
              2 * static_cast<double>(whole), 2.0);
  b.venc_regs.write(VMOD, 0);
  b.params.venc_clk_sel.set("no_effect");
  b.clk_sel.write(false);
  run_for(kPsPerMs);
  violations_ = b.sink.stats.violations.count();  // the display expects the true rate
}

TEST_F(DisplayTest, ChangedClockMovesTheLineUnderWay) {
  b.venc_regs.write(VMOD, kOn);
  while (b.edges.rises.empty()) run_for(kPsPerUs);
  // In the middle of the line before the second field the clock becomes ten times slower: the rest
  // of that line, which ends with the interrupt, lasts ten times as long.
  const unsigned lines = kIs625 ? 312 : 262;
  const std::uint64_t half = kStd.line_bytes / 2;
  const Clock clock(kByteClock, b.edges.rises[0]);
  run_until(clock.edge((lines - 1) * kStd.line_bytes + half));
  const Picoseconds change = kernel_time();
  b.edges.rises.clear();
  b.clock.write(Frequency(2'700'000));
  while (b.edges.rises.empty()) run_for(kPsPerUs);
  const Picoseconds slow = kPsPerSecond / 2'700'000;
  EXPECT_NEAR(static_cast<double>(b.edges.rises[0] - change), static_cast<double>(half * slow),
              static_cast<double>(slow));
  b.venc_regs.write(VMOD, 0);
  b.clock.write(kByteClock);
  run_for(kPsPerMs);
  violations_ = b.sink.stats.violations.count();
}

}  // namespace
}  // namespace fovea::video
