// The shipped experiments in full size with real footage. Every displayed frame is exact, its marks
// show the right order, no frame is dropped or repeated, the frame rate is that of the standard,
// and the run gives no warnings.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <systemc>

#include "model/common/check.h"
#include "tb/e2e/expectations.h"
#include "tb/e2e/rig.h"
#include "tb/e2e/stamp_reader.h"

namespace fovea::e2e {
namespace {

constexpr double kPal = 25, kNtsc = 30'000.0 / 1'001;

struct Experiment {
  const char* file;
  double rate;  ///< displayed frames a second, ITU-R BT.601
};

class ShippedTest : public testing::TestWithParam<Experiment> {
 protected:
  /// The number of the camera's frame that a displayed frame shows, read from its marks.
  std::optional<unsigned> frame_shown(const Rig& rig, const Shown& s) {
    const unsigned x = (rig.params.raster_width() - rig.params.width()) / 2;
    const unsigned y = (rig.params.raster_height() - rig.params.height()) / 2;
    const ShownFields f = read_stamps(s.frame, rig.geometry(), *rig.stamps(), x, y);
    EXPECT_TRUE(f.even && f.odd) << "frame " << s.record.index << ": the marks cannot be read";
    if (!f.even || !f.odd) return std::nullopt;
    EXPECT_EQ(*f.even % 2, 0) << "rows of the first field show the second one";
    EXPECT_EQ(*f.odd, *f.even + 1) << "a frame woven of fields that do not belong together";
    return *f.even / 2;
  }
};

TEST_P(ShippedTest, EveryFrameIsExactInOrderAndInTime) {
  Rig rig;
  rig.load(GetParam().file);
  rig.run(kLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), rig.params.run.frames()) << rig.board().uart_text();
  expect_lut_right(rig);
  expect_frames_right(rig);

  std::optional<unsigned> before;
  for (const Shown& s : rig.shown()) {
    const auto now = frame_shown(rig, s);
    ASSERT_TRUE(now);
    if (before) {
      EXPECT_EQ(*now, *before + 1) << "order of the frames, from their pixels";
    }
    before = now;
  }

  const board::FrameStats f = rig.board().frame_stats();
  ASSERT_TRUE(f.rate);
  EXPECT_NEAR(*f.rate, GetParam().rate, 0.01);
  EXPECT_EQ(f.displayed, rig.params.run.frames());
  EXPECT_EQ(f.dropped, 0u);
  EXPECT_EQ(f.repeated, 0u);
  EXPECT_EQ(rig.board().dm365.isif.stats.overflows.count(), 0u);
  EXPECT_EQ(rig.board().sink.stats.underflows.count(), 0u);
  expect_no_warnings(rig);
}

// Remaps without waiting for the camera: old frames are shown again. Four tables and four sources take
// turns; with nine remaps for each captured frame instead of 33, each table's picture is shown in four frames.
void expect_exact_in_turn(unsigned frames) {
  Rig rig;
  rig.load("throughput.yaml").set("firmware.repeat", "9").set("run.frames", std::to_string(frames));
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), rig.params.run.frames()) << rig.board().uart_text();
  expect_lut_right(rig);
  expect_frames_right(rig, 0);
  std::set<unsigned> views;
  for (const Shown& s : rig.shown()) views.insert(view_of(rig, s));
  EXPECT_EQ(views, (std::set<unsigned>{0, 1, 2, 3}));
  EXPECT_EQ(rig.board().dm365.isif.stats.overflows.count(), 0u);
  EXPECT_EQ(rig.board().sink.stats.underflows.count(), 0u);
  expect_no_warnings(rig);
}
TEST(ThroughputTest, EveryFrameIsExactAndNoneIsOlderThanTheOneBefore) { expect_exact_in_turn(5); }
TEST(ThroughputTest, NightlyTwentyFiveFramesAreExact) { expect_exact_in_turn(25); }

INSTANTIATE_TEST_SUITE_P(Experiments, ShippedTest,
                         testing::Values(Experiment{"default.yaml", kPal},
                                         Experiment{"paper-pal.yaml", kPal},
                                         Experiment{"paper-vga.yaml", kNtsc},
                                         Experiment{"paper-ntsc.yaml", kNtsc}),
                         [](const auto& of) {
                           std::string name = of.param.file;
                           name.resize(name.find('.'));
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// The reader must be able to see what it looks for.

TEST(StampReaderTest, SwappedFieldsAndTornFramesAreSeen) {
  const video::StampLayout layout = video::StampLayout::at(720, 576, 359.5, 287.5);
  oracle::Geometry flat;
  flat.mapping = oracle::Mapping::kNone;
  const auto woven = [&](unsigned even, unsigned odd) {
    video::Picture a(720, 576, 100), b(720, 576, 100);
    video::stamp(a, layout, even);
    video::stamp(b, layout, odd);
    for (unsigned y = 1; y < a.height; y += 2) std::copy_n(b.row(y), a.row_bytes(), a.row(y));
    return crop(a, 0, 0, 720, 576);
  };
  const ShownFields right = read_stamps(woven(1000, 1001), flat, layout, 0, 0);
  EXPECT_EQ(right.even, 1000);
  EXPECT_EQ(right.odd, 1001);
  const ShownFields swapped = read_stamps(woven(1001, 1000), flat, layout, 0, 0);
  EXPECT_EQ(swapped.even, 1001);
  EXPECT_EQ(swapped.odd, 1000);
  const ShownFields torn = read_stamps(woven(1000, 1003), flat, layout, 0, 0);
  EXPECT_EQ(torn.odd, 1003);
  const ShownFields none = read_stamps(crop(video::Picture(720, 576), 0, 0, 720, 576), flat, layout,
                                       0, 0);
  EXPECT_FALSE(none.even || none.odd);
}

TEST(StampReaderTest, APictureThatIsShiftedByACellIsNotRead) {
  const video::StampLayout layout = video::StampLayout::at(720, 576, 359.5, 287.5);
  oracle::Geometry flat;
  flat.mapping = oracle::Mapping::kNone;
  video::Picture p(720, 576, 100);
  video::stamp(p, layout, 1234);
  flat.shift_x = video::StampLayout::kCellPixels;
  const ShownFields f = read_stamps(crop(p, 0, 0, 720, 576), flat, layout, 0, 0);
  EXPECT_FALSE(f.even || f.odd);
}

// A cell without a displayed pixel in its middle is not dark but unknown, even where dark is what the
// code would need.
TEST(StampReaderTest, ACellThatIsNotShownIsNotRead) {
  const video::StampLayout layout = video::StampLayout::at(720, 576, 359.5, 287.5);
  oracle::Geometry flat;
  flat.mapping = oracle::Mapping::kNone;
  constexpr unsigned kCell = video::StampLayout::kCellPixels;
  // The middle half of the first column of cells ends three quarters of a cell behind its left edge.
  const unsigned last = layout.code_x + kCell * 3 / 4;
  const auto from = [&](const video::Picture& p, unsigned x) {
    return read_stamps(crop(p, x, 0, 720 - x, 576), flat, layout, x, 0);
  };
  unsigned tried = 0;
  for (unsigned counter = 0; counter < 128 && tried < 8; ++counter) {
    video::Picture p(720, 576, 100);
    video::stamp(p, layout, counter);
    bool dark = true;
    for (unsigned row = 0; row < video::StampLayout::kCodeRows; ++row) {
      const std::uint8_t* const line = p.row(layout.code_y + row * kCell + kCell / 2);
      dark &= line[2 * (layout.code_x + kCell / 2) + 1] < 126;
    }
    if (!dark) continue;
    ++tried;
    const ShownFields seen = from(p, last), cut = from(p, last + 1);
    EXPECT_EQ(seen.even, counter);
    EXPECT_EQ(seen.odd, counter);
    EXPECT_FALSE(cut.even || cut.odd) << counter;
  }
  EXPECT_EQ(tried, 8u);
}

}  // namespace
}  // namespace fovea::e2e
