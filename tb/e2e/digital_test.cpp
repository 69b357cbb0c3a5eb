// Progressive cameras at the digital port: what is displayed is, byte for byte, the host's remap of a frame that was
// sent, and the table maps a source of another size than the display's.
#include <gtest/gtest.h>

#include "tb/e2e/rig.h"
#include "tb/e2e/stamp_reader.h"

namespace fovea::e2e {
namespace {

struct Camera {
  const char* standard;
  unsigned width, height;              ///< of what the camera sends
  unsigned shown_width, shown_height;  ///< of the displayed region in this test; 0: all
  const char* kernel;
  double period_ms;  ///< of the display
  const char* clock = "0Hz";
};

/// The view that shows a whole 800x600 picture in 720x576: the scales of both sides, from the key's description.
oracle::Geometry whole_view(const Rig& rig) {
  oracle::Geometry g = rig.geometry();
  if (g.source_width != 800) return g;
  g.out_focal_px = oracle::lens_focal(g) * 0.9;
  g.out_aspect = 0.96 / 0.9;
  return g;
}

/// oracle::remap() for a result of another size: pair i is the source's pair at the offset, or black.
oracle::Frame remapped(const oracle::Frame& in, const std::vector<std::uint32_t>& lut, const oracle::Geometry& g) {
  oracle::Frame out{g.width, g.height, {}};
  for (const std::uint32_t entry : lut) {
    const std::uint32_t row = entry / g.pitch_bytes, byte = entry % g.pitch_bytes;
    static constexpr std::uint8_t kBlack[4] = {128, 16, 128, 16};
    const std::uint8_t* from = row == in.height ? kBlack : in.uyvy.data() + std::size_t{row} * in.width * 2 + byte;
    out.uyvy.insert(out.uyvy.end(), from, from + 4);
  }
  return out;
}

class DigitalTest : public testing::TestWithParam<Camera> {};
TEST_P(DigitalTest, EveryFrameIsShownByteForByteThroughTheTable) {
  const Camera& in = GetParam();
  Rig rig;
  rig.set("video.standard", in.standard).set("video.clock", in.clock).set("firmware.kernel", in.kernel);
  rig.set("video.width", std::to_string(in.shown_width)).set("video.height", std::to_string(in.shown_height));
  rig.set("run.frames", "4");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  const oracle::Geometry g = whole_view(rig);
  EXPECT_EQ(g.source_width, in.width);
  EXPECT_EQ(g.source_height, in.height);
  const auto lut = rig.lut();
  const oracle::LutCheck check = oracle::check_lut(lut, g, 0.02);
  EXPECT_EQ(check.wrong, 0u) << (check.first_wrong ? check.first_wrong->text() : "");
  std::uint64_t last = 0;
  for (const Shown& s : rig.shown()) {
    ASSERT_TRUE(s.record.captured);
    if (s.record.repeated) continue;
    const ShownFields stamp = read_stamps(s.frame, g, *rig.stamps(), 0, 0);
    ASSERT_TRUE(stamp.even && stamp.odd) << "frame " << s.record.index;
    EXPECT_EQ(*stamp.even, *stamp.odd) << "all rows are of one instant";
    const std::uint64_t number = *stamp.even / 2;
    if (s.record.index) {
      EXPECT_GT(number, last);
    }
    if (s.record.index && std::string(in.clock) == "0Hz") {
      EXPECT_EQ(number, last + 1) << "camera and display in step";
    }
    last = number;
    const auto difference = oracle::compare(remapped(rig.sent(number), lut, g), s.frame);
    EXPECT_FALSE(difference) << "frame " << s.record.index << ": " << difference->text();
  }
  const auto& frames = rig.shown();
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const auto period = frames[i].record.display_start - frames[i - 1].record.display_start;
    EXPECT_NEAR(static_cast<double>(period) / kPsPerMs, in.period_ms, 1e-6);
  }
  EXPECT_EQ(rig.state().torn, 0u);
  EXPECT_EQ(rig.board().dm365.isif.stats.overflows.count(), 0u);
  EXPECT_EQ(rig.board().decoder.lines_sent(), 0u);
}
INSTANTIATE_TEST_SUITE_P(
    Cameras, DigitalTest,
    testing::Values(Camera{"vga_progressive", 640, 480, 320, 240, "fastest", 1001 / 30.0},
                    Camera{"svga_progressive", 800, 600, 320, 240, "fastest", 40},
                    Camera{"svga_progressive", 800, 600, 240, 200, "engine", 40, "45MHz"}),
    [](const auto& i) { return std::string(i.param.standard) + "_" + i.param.kernel; });

INSTANTIATE_TEST_SUITE_P(NightlyWhole, DigitalTest,
                         testing::Values(Camera{"vga_progressive", 640, 480, 0, 0, "codes", 1001 / 30.0},
                                         Camera{"svga_progressive", 800, 600, 0, 0, "plain", 40},
                                         Camera{"svga_progressive", 800, 600, 0, 0, "gather", 40},
                                         Camera{"svga_progressive", 800, 600, 0, 0, "fastest", 40}),
                         [](const auto& i) { return std::string(i.param.standard) + "_" + i.param.kernel; });

}  // namespace
}  // namespace fovea::e2e
