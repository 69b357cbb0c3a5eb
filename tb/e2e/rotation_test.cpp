// `firmware.tables`: remaps follow several look-up tables and read several source frames in turn. Which
// table and which source made a picture is predicted from the order of the remaps alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "tb/e2e/expectations.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

void small_in_turn(Rig& rig, const std::string& tables, const std::string& repeat) {
  rig.set("video.width", "160").set("video.height", "64").set("camera.stamp", "false");
  rig.set("firmware.tables", tables).set("firmware.repeat", repeat).set("run.frames", "5");
}

/// The output buffers at the end of a remap, and the captured frame after which it was made.
struct Result {
  std::uint64_t captured;
  std::vector<oracle::Frame> buffers;
};

std::uint32_t word(Rig& rig, const char* symbol) {
  const auto bytes = rig.board().peek(rig.elf().find(symbol)->address, 4);
  std::uint32_t value;
  std::memcpy(&value, bytes.data(), 4);
  return value;
}

std::vector<oracle::Frame> output_buffers(Rig& rig) {
  const oracle::Geometry g = rig.geometry();
  const std::uint32_t stride = word(rig, "frame_stride");
  const std::uint32_t base = rig.elf().find("frame_out")->address;
  std::vector<oracle::Frame> out;
  for (unsigned n = 0; n < rig.state().out_count; ++n)
    out.push_back({g.width, g.height,
                   rig.board().peek(base + n * stride, std::size_t{g.pitch_bytes} * g.height)});
  return out;
}

/// Runs, and keeps what each remap has left in memory.
std::vector<Result> run_and_keep(Rig& rig) {
  std::vector<Result> results;
  board::Board& board = rig.build();
  const Subscription pins = board.dm365.gpio.observe_outputs([&](unsigned bank, std::uint32_t out, Picoseconds) {
    if (bank != PHASE_BANK || board::phase_of(out) != board::Phase::kRemapEnd) return;
    results.push_back({board.log.remaps().back().captured, output_buffers(rig)});
  });
  rig.run(kLimit);
  EXPECT_EQ(rig.shown().size(), rig.params.run.frames()) << board.uart_text();
  return results;
}

/// The number of the frame that the camera sent while frame `captured` was captured.
std::uint64_t sent_number(Rig& rig, std::uint64_t captured) {
  // The first capture is that of the first displayed record, less the frames before it.
  const auto& record = rig.shown().front().record;
  std::uint64_t n = 0;
  while (rig.board().decoder.field_time(2 * n + 2) <= *record.capture_start) ++n;
  return n + captured - *record.captured;
}

// Seven remaps for each frame, with four tables: all four take their turn on the display, and each table
// meets several ages of sources.
class RotationOfKernelTest : public testing::TestWithParam<const char*> {};
TEST_P(RotationOfKernelTest, EachRemapFollowsTheNextTableAndReadsItsSource) {
  Rig rig;
  small_in_turn(rig, "4", "7");
  rig.set("firmware.kernel", GetParam());
  const std::vector<Result> results = run_and_keep(rig);
  ASSERT_GE(results.size(), 5u * 7);
  const std::string used = std::string("kernel: ") + GetParam() + ", ";
  const std::string& said = rig.board().uart_text();
  unsigned tables = 0;
  for (std::size_t at = said.find(used); at != std::string::npos; at = said.find(used, at + 1)) ++tables;
  EXPECT_EQ(tables, 4u) << said;
  expect_lut_right(rig);
  std::vector<std::vector<std::uint32_t>> luts;
  for (unsigned k = 0; k < 4; ++k) luts.push_back(rig.lut(k));
  const std::uint32_t pitch = rig.geometry().pitch_bytes;
  const auto predicted = [&](unsigned view, std::uint64_t captured) {
    return oracle::remap(rig.sent(sent_number(rig, captured)), luts[view], pitch);
  };

  EXPECT_EQ(results.front().captured, 3u) << "three frames are sources before the first remap";
  for (std::size_t n = 0; n < results.size(); ++n) {
    const Result& r = results[n];
    EXPECT_EQ(r.captured, 3 + n / 7) << "small remaps wait for the camera";
    const std::uint64_t age = (7 - 1 - n % 7) % 4;
    const oracle::Frame expected = predicted(n % 4, r.captured - age);
    const auto made = std::count_if(r.buffers.begin(), r.buffers.end(), [&](const auto& frame) {
      return !oracle::compare(expected, frame);
    });
    EXPECT_EQ(made, 1) << "remap " << n << ": not made with table " << n % 4 << " from frame "
                       << r.captured - age;
  }

  // The last remap of each frame is shown: table 6, 13, 20, ... modulo 4 of the newest frame.
  const unsigned order[] = {2, 1, 0, 3, 2};
  for (std::size_t i = 0; i < rig.shown().size(); ++i) {
    const Shown& s = rig.shown()[i];
    EXPECT_EQ(view_of(rig, s), order[i]);
    for (unsigned view = 0; view < 4; ++view) {
      const auto d = oracle::compare(predicted(view, *s.record.captured), s.frame);
      EXPECT_EQ(!d, view == order[i]) << "frame " << i << ", view " << view;
    }
  }
  expect_frames_right(rig);
}

// Kernels that keep a part of a table in internal RAM or in the EDMA must bring the right one.
INSTANTIATE_TEST_SUITE_P(Kernels, RotationOfKernelTest,
                         testing::Values("plain", "deltas4", "codes", "staged", "runs"),
                         [](const auto& i) { return std::string(i.param); });

// Four tables of one lens are four tables: less than one entry in twenty is the same in two of them.
TEST(RotationTest, TablesDifferInNearlyAllEntries) {
  Rig rig;
  small_in_turn(rig, "4", "1");
  rig.set("run.frames", "1");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 1u) << rig.board().uart_text();
  const auto bytes = rig.lut().size() * 4;
  std::set<std::uint32_t> places;
  for (unsigned a = 0; a < 4; ++a) {
    const auto one = rig.lut(a);
    places.insert(rig.state().table_address[a]);
    for (unsigned b = 0; b < a; ++b) {
      const auto other = rig.lut(b);
      std::size_t same = 0;
      for (std::size_t i = 0; i < one.size(); ++i) same += one[i] == other[i];
      EXPECT_LT(same * 20, one.size()) << a << " and " << b;
    }
  }
  ASSERT_EQ(places.size(), 4u);
  for (auto i = std::next(places.begin()); i != places.end(); ++i)
    EXPECT_GE(*i - *std::prev(i), bytes) << "tables overlap";
}

TEST(RotationTest, OneTableIsTheViewOfThePage) {
  Rig rig;
  small_in_turn(rig, "1", "3");
  const std::vector<Result> results = run_and_keep(rig);
  expect_lut_right(rig);
  expect_frames_right(rig);
  const FwState state = rig.state();
  EXPECT_EQ(state.tables, 1u);
  EXPECT_EQ(state.in_count, 3u);
  ASSERT_FALSE(results.empty());
  EXPECT_EQ(results.front().captured, 0u) << "nothing is kept back";
}

TEST(RotationTest, TheSerialFlowHasTablesInTurnAndOneSource) {
  Rig rig;
  small_in_turn(rig, "3", "4");
  rig.set("firmware.flow", "serial");
  const std::vector<Result> results = run_and_keep(rig);
  expect_lut_right(rig);
  EXPECT_EQ(rig.state().in_count, 1u);
  const std::uint32_t pitch = rig.geometry().pitch_bytes;
  ASSERT_GE(results.size(), 8u);
  for (std::size_t n = 0; n < 8; ++n) {
    // The camera goes on while a frame is in work: every second frame is captured here.
    const auto& records = rig.shown();
    const auto of = std::find_if(records.begin(), records.end(), [&](const Shown& s) {
      return s.record.captured == results[n].captured;
    });
    ASSERT_NE(of, records.end());
    const auto sent = sent_as(rig, *of);
    ASSERT_TRUE(sent);
    const oracle::Frame expected = oracle::remap(rig.sent(*sent), rig.lut(n % 3), pitch);
    const auto& buffers = results[n].buffers;
    EXPECT_TRUE(std::any_of(buffers.begin(), buffers.end(), [&](const auto& frame) {
      return !oracle::compare(expected, frame);
    })) << n;
  }
}

// frame.remap_rate, from the marks on the pins.
TEST(RotationTest, TheRateOfRemapsIsThoseThatEndedInTheWindow) {
  Rig rig;
  small_in_turn(rig, "2", "3");
  rig.run(kLimit);
  board::Board& board = rig.board();
  ASSERT_TRUE(board.window_start() && board.window_end());
  unsigned ended = 0;
  for (const auto& remap : board.log.remaps())
    ended += remap.end > *board.window_start() && remap.end <= *board.window_end();
  // Five frames of 40 ms with three remaps each.
  EXPECT_EQ(*board.window_end() - *board.window_start(), 200 * kPsPerMs);
  EXPECT_EQ(ended, 15u);
  EXPECT_DOUBLE_EQ(board.frame_stats().remap_rate, 75.0);
}

}  // namespace
}  // namespace fovea::e2e
