#include "tb/e2e/fault_counts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>

#include "tb/e2e/signal_oracle.h"

namespace fovea::e2e {
namespace {

double in_ms(Picoseconds t) { return static_cast<double>(t) / kPsPerMs; }

SignalStory story_of(const CamerasRig& rig) {
  using Kind = SignalStory::Kind;
  const board::FaultParams& f = rig.params.fault;
  SignalStory out;
  out.kind = f.kind.is("unplugged")        ? Kind::kUnplugged
             : f.kind.is("wrong_standard") ? Kind::kOtherStandard
             : f.kind.is("sync_noise")     ? Kind::kNoise
             : f.kind.is("missing_lines")  ? Kind::kMissingLines
             : f.kind.is("short_lines")    ? Kind::kShortLines
             : f.kind.is("clock_drift")    ? Kind::kDrift
                                           : Kind::kNone;
  out.start_ms = in_ms(f.start());
  out.end_ms = in_ms(f.end());
  out.wrong_bits = static_cast<unsigned>(f.wrong_bits());
  out.every = static_cast<unsigned>(f.every());
  out.lines = static_cast<unsigned>(f.lines());
  out.samples = static_cast<unsigned>(f.samples());
  if (out.kind == Kind::kDrift) out.drift_ppm = f.drift();
  out.relock_fields = static_cast<unsigned>(rig.params.decoder.relock_fields());
  out.rows = rig.params.height();
  out.display_ms = in_ms(rig.shown().front().record.display_start);
  out.sent_until_ms = in_ms(rig.shown().back().record.display_end);
  return out;
}

/// The newest good frame that is corrected in `correction_ms` and flipped to at least 1 ms before the display frame.
std::optional<unsigned> newest(const SignalFates& fates, double display_ms, double correction_ms) {
  std::optional<unsigned> out;
  for (const CapturedFrame& f : fates.captured)
    if (f.good && f.handed_on_ms + correction_ms <= display_ms - 1) out = f.number;
  return out;
}

}  // namespace

void expect_exact_counts(CamerasRig& rig) {
  ASSERT_FALSE(rig.shown().empty());
  const SignalFates fates = fates_of(story_of(rig));
  std::set<unsigned> displayed;
  for (const CamerasRig::Shown& s : rig.shown()) {
    const double at = in_ms(s.record.display_start);
    // The small picture takes some milliseconds. That any time from 0.3 to 8 ms leads to the same frame is asserted,
    // so that the oracle need not know the firmware's speed.
    const auto expected = newest(fates, at, 0.3);
    ASSERT_TRUE(expected && s.stamp) << "display frame " << s.record.index;
    ASSERT_EQ(expected, newest(fates, at, 8)) << "display frame " << s.record.index;
    EXPECT_EQ(s.stamp->number, *expected) << "display frame " << s.record.index << " at " << at << " ms";
    displayed.insert(*expected);
  }
  std::uint64_t dropped = 0, superseded = 0, pending = 0;
  for (const CapturedFrame& f : fates.captured) {
    if (f.number < *displayed.begin() || displayed.contains(f.number)) continue;
    if (f.number > *displayed.rbegin())
      ++pending;
    else
      ++(f.good ? superseded : dropped);
  }
  const board::CameraFrameStats stats = rig.board().camera_stats().front();
  EXPECT_EQ(stats.displayed, displayed.size());
  EXPECT_EQ(stats.dropped, dropped);
  EXPECT_EQ(stats.superseded, superseded);
  EXPECT_EQ(stats.pending, pending);
  EXPECT_EQ(stats.captured, displayed.size() + dropped + superseded);
  EXPECT_EQ(rig.board().dm365.isif.stats.bad_codes.count(), fates.bad_codes);
  EXPECT_EQ(rig.board().dm365.isif.stats.corrected_codes.count(), fates.corrected_codes);
}

}  // namespace fovea::e2e
