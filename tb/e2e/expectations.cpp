#include "tb/e2e/expectations.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <optional>

namespace fovea::e2e {

void expect_no_warnings(const Rig& rig) {
  for (const auto& [kind, count] : rig.diagnostics.counts())
    ADD_FAILURE() << "warning: " << kind.second << " (" << count << " times)";
}

void expect_lut_right(Rig& rig) {
  for (unsigned k = 0; k < rig.params.firmware.tables(); ++k) {
    const auto lut = rig.lut(k);
    const oracle::Geometry g = rig.geometry(k);
    ASSERT_EQ(lut.size(), std::size_t{g.width} / 2 * g.height);
    const oracle::LutCheck c = oracle::check_lut(lut, g, 0.02);
    EXPECT_EQ(c.wrong, 0u) << "table " << k << ": " << c.first_wrong->text();
    // Two roundings that are both right may differ at a boundary, but only there.
    EXPECT_LE(c.near_boundary, c.entries / 1000);
    std::printf("LUT: %zu entries, %zu wrong, %zu within 0.02 px of a boundary and different\n",
                c.entries, c.wrong, c.near_boundary);
  }
}

unsigned view_of(Rig& rig, const Shown& s) {
  const auto tables = static_cast<std::size_t>(rig.params.firmware.tables());
  const auto& remaps = rig.board().log.remaps();
  std::size_t count = 0;
  for (std::size_t n = 0; n < remaps.size(); ++n)
    if (remaps[n].captured == s.record.captured) count = n + 1;
  EXPECT_GT(count, 0u) << "frame " << s.record.index << " was not remapped";
  return static_cast<unsigned>((count - 1) % tables);
}

std::optional<std::uint64_t> sent_as(Rig& rig, const Shown& s, std::string* difference) {
  const auto lut = rig.lut(view_of(rig, s));
  const std::uint32_t pitch = rig.geometry().pitch_bytes;
  // Which frame the camera sent is found from the pixels, near the time of the capture.
  const double period = rig.params.video.format().is_625 ? 0.04 : 1001.0 / 30000;
  const auto guess =
      static_cast<std::uint64_t>(static_cast<double>(*s.record.capture_start) * 1e-12 / period);
  for (std::uint64_t n = guess > 1 ? guess - 2 : 0; n <= guess + 2; ++n) {
    const auto d = oracle::compare(oracle::remap(rig.sent(n), lut, pitch), s.frame);
    if (!d) return n;
    if (n == guess && difference) *difference = d->text();
  }
  return std::nullopt;
}

void expect_frames_right(Rig& rig, std::uint64_t step) {
  ASSERT_FALSE(rig.shown().empty());
  std::uint64_t last = 0;
  for (const Shown& s : rig.shown()) {
    ASSERT_TRUE(s.record.captured && s.record.capture_start);
    EXPECT_EQ(s.underflows, 0u);
    std::string difference;
    const auto found = sent_as(rig, s, &difference);
    ASSERT_TRUE(found) << "frame " << s.record.index << " is no remap of a sent frame: "
                       << difference;
    if (&s != &rig.shown().front()) {
      if (step > 0) {
        EXPECT_EQ(*found, last + (s.record.repeated ? 0 : step)) << "order of frames";
      }
      EXPECT_GE(*found, last) << "an older frame than the one before";
    }
    last = *found;
  }
}

}  // namespace fovea::e2e
