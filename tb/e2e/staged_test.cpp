// The remap that is staged by the EDMA: the displayed pictures are those of the look-up table, whatever the
// D-cache holds, and a table that it cannot use is left to another kernel.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tb/e2e/expectations.h"
#include "tb/e2e/rig.h"

namespace fovea::e2e {
namespace {

constexpr const char* kUsed = "kernel: staged, ";

void staged(Rig& rig, unsigned width, unsigned height, unsigned frames) {
  rig.set("video.width", std::to_string(width)).set("video.height", std::to_string(height));
  rig.set("camera.stamp", "false").set("run.frames", std::to_string(frames));
  rig.set("firmware.kernel", "staged");
}

bool said(Rig& rig, const std::string& text) {
  return rig.board().uart_text().find(text) != std::string::npos;
}

/// Sizes whose last strip and last row of tiles overlap their neighbours, and that are whole tiles; widths
/// that are no multiple of 16 pixels are rounded up to the pitch.
class StagedSizeTest : public testing::TestWithParam<std::pair<unsigned, unsigned>> {};
TEST_P(StagedSizeTest, PictureIsExact) {
  Rig rig;
  staged(rig, GetParam().first, GetParam().second, 4);
  rig.run(kLimit);
  ASSERT_EQ(rig.board().dm365.arm.failure(), "");
  ASSERT_EQ(rig.shown().size(), 4u) << rig.board().uart_text();
  EXPECT_TRUE(said(rig, kUsed)) << rig.board().uart_text();
  expect_frames_right(rig);
  expect_no_warnings(rig);
}
INSTANTIATE_TEST_SUITE_P(Sizes, StagedSizeTest,
                         testing::Values(std::pair{160u, 48u}, std::pair{172u, 100u},
                                         std::pair{80u, 28u}),
                         [](const auto& i) {
                           return std::to_string(i.param.first) + "x" + std::to_string(i.param.second);
                         });

TEST(StagedTest, ShippedLensAtFullSizeIsExact) {
  Rig rig;
  rig.load("default.yaml");
  rig.set("firmware.kernel", "staged").set("run.frames", "2");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 2u) << rig.board().uart_text();
  EXPECT_TRUE(said(rig, kUsed)) << rig.board().uart_text();
  expect_frames_right(rig);
  expect_no_warnings(rig);
}

/// The status box goes through the D-cache into a result that the EDMA has written, and stays in a cache that
/// never evicts: a line that was read too early, or kept too long, would show an older picture.
TEST(StagedTest, BoxInTheResultIsCoherent) {
  Rig rig;
  staged(rig, 160, 64, 8);
  rig.set("firmware.flow", "serial").set("firmware.overlay", "true");
  rig.set("cpu.dcache.size", "128KiB");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 8u) << rig.board().uart_text();
  EXPECT_TRUE(said(rig, kUsed)) << rig.board().uart_text();
  for (const Shown& s : rig.shown()) {
    std::uint64_t n = 0;
    while (rig.board().decoder.field_time(2 * n + 2) <= *s.record.capture_start) ++n;
    oracle::Frame expected = oracle::remap(rig.sent(n), rig.lut(), rig.geometry().pitch_bytes);
    for (unsigned y = 32; y < 48; ++y)
      for (unsigned x = 32; x < 96; ++x) {
        std::uint8_t& luma = expected.uyvy[(std::size_t{y} * expected.width + x) * 2 + 1];
        luma = static_cast<std::uint8_t>((luma + 0x50) / 2);
      }
    const auto d = oracle::compare(expected, s.frame);
    EXPECT_FALSE(d) << "frame " << s.record.index << ": " << d->text();
  }
}

TEST(StagedTest, BlackRimIsPainted) {
  Rig rig;
  staged(rig, 256, 64, 3);
  rig.set("lens.mapping", "rectilinear").set("lens.fov", "60deg").set("lens.out_focal", "170px");
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 3u) << rig.board().uart_text();
  EXPECT_TRUE(said(rig, kUsed)) << rig.board().uart_text();
  const auto lut = rig.lut();
  EXPECT_GT(std::count(lut.begin(), lut.end(), 64u * 512), 800);
  expect_frames_right(rig);
  expect_no_warnings(rig);
}

struct Refused {
  const char *name, *key, *value, *why;
  unsigned width, height;
};
void PrintTo(const Refused& r, std::ostream* out) { *out << r.name; }
class StagedRefusalTest : public testing::TestWithParam<Refused> {};
TEST_P(StagedRefusalTest, AnotherKernelTakesOverAndSaysWhy) {
  const Refused& r = GetParam();
  Rig rig;
  staged(rig, r.width, r.height, 2);
  if (*r.key) rig.set(r.key, r.value);
  rig.run(kLimit);
  ASSERT_EQ(rig.shown().size(), 2u) << rig.board().uart_text();
  EXPECT_TRUE(said(rig, r.why)) << rig.board().uart_text();
  EXPECT_FALSE(said(rig, kUsed));
  expect_frames_right(rig);
}
INSTANTIATE_TEST_SUITE_P(
    Lenses, StagedRefusalTest,
    testing::Values(Refused{"Narrow", "", "", "smaller than two tiles", 64, 48},
                    Refused{"Far", "lens.out_focal", "12px", "does not fit into internal RAM", 720, 576}),
    [](const auto& i) { return i.param.name; });

}  // namespace
}  // namespace fovea::e2e
