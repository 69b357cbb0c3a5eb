// model/board/frame_log.h: which captured frame is on show, from the pins' eight-bit numbers.
#include "model/board/frame_log.h"

#include <gtest/gtest.h>

#include <array>

namespace fovea::board {
namespace {

struct Log : FrameLog {
  void captured_up_to(std::uint64_t last) {
    for (std::uint64_t i = 0; i <= last; ++i) capture(i, i * 100, i * 100 + 50);
  }
  void show(Phase phase, unsigned sequence, Picoseconds at = 0) {
    pins(static_cast<std::uint32_t>(phase) | sequence << 4, at);
  }
  /// What is on show when the firmware flips to `sequence`.
  std::optional<std::uint64_t> flipped_to(unsigned sequence) {
    show(Phase::kFlip, sequence);
    latch(address_ += 0x100, 0);
    return shown(0, 0).captured;
  }

 private:
  std::uint32_t address_ = 0x8000'0000;
};

TEST(FrameLogTest, ANumberMayBeOneAheadOfTheCapturesAndNotTwo) {
  Log none;
  EXPECT_EQ(none.flipped_to(1), std::nullopt);
  EXPECT_EQ(none.flipped_to(0), 0u);

  Log log;
  log.captured_up_to(254);
  EXPECT_EQ(log.flipped_to(255), 255u);
  EXPECT_EQ(log.flipped_to(254), 254u);
  EXPECT_EQ(log.flipped_to(0), 0u) << "256 would be two ahead";
}

TEST(FrameLogTest, NumbersAreUnrolledAgainstTheLatestCapture) {
  Log log;
  log.captured_up_to(255);
  EXPECT_EQ(log.flipped_to(255), 255u);
  EXPECT_EQ(log.flipped_to(0), 256u);
  EXPECT_EQ(log.flipped_to(1), 1u);

  Log later;
  later.captured_up_to(300);
  EXPECT_EQ(later.flipped_to(44), 300u);
  EXPECT_EQ(later.flipped_to(45), 301u);
  EXPECT_EQ(later.flipped_to(46), 46u) << "302 would be two ahead";
}

TEST(FrameLogTest, AfterAResetBothCountFromZeroAndTheLogGoesOn) {
  Log log;
  log.captured_up_to(300);
  EXPECT_EQ(log.flipped_to(44), 300u);
  log.restart();
  EXPECT_FALSE(log.latch(0x9000'0000, 0)) << "nothing is on show before the next flip";
  EXPECT_EQ(log.shown(0, 0).captured, std::nullopt);
  EXPECT_EQ(log.flipped_to(1), std::nullopt) << "ahead of all captures since the reset";
  log.captured_up_to(1);
  EXPECT_EQ(log.flipped_to(1), 302u);
  EXPECT_EQ(log.records().back().dropped, 0u) << "what the reset took is not dropped";
  EXPECT_EQ(log.flipped_to(2), 303u);
  EXPECT_EQ(log.records().back().capture_start, std::nullopt);
}

TEST(FrameLogTest, TimesOfTheLatest128CapturesAndRemapsAreKept) {
  Log log;
  for (unsigned i = 0; i < 129; ++i) {
    log.capture(i, i * 100, i * 100 + 50);
    log.show(Phase::kRemapStart, i, i * 100 + 60);
    log.show(Phase::kRemapEnd, i, i * 100 + 70);
  }
  const auto shown = [&log](unsigned n) {
    log.flipped_to(n);
    return log.records().back();
  };
  EXPECT_EQ(shown(0).capture_start, std::nullopt);
  EXPECT_EQ(shown(0).remap_start, 60u) << "the 129 remaps end behind the last capture";
  EXPECT_EQ(shown(1).capture_start, 100u);
  EXPECT_EQ(shown(1).capture_end, 150u);
  log.capture(129, 12'900, 12'950);
  EXPECT_EQ(shown(0).remap_start, std::nullopt);
  EXPECT_EQ(shown(1).remap_start, 160u);
  EXPECT_EQ(shown(1).remap_end, 170u);
  EXPECT_EQ(shown(1).capture_start, std::nullopt);
  EXPECT_EQ(shown(2).capture_start, 200u);
}

TEST(FrameLogTest, RepeatedAndDroppedFramesAreCounted) {
  Log log;
  log.captured_up_to(10);
  log.show(Phase::kFlip, 2);
  EXPECT_FALSE(FrameLog().latch(0x8000'0000, 0)) << "nothing was flipped to";
  EXPECT_TRUE(log.latch(0x8000'0000, 0));
  EXPECT_EQ(log.shown(1'000, 1'400).dropped, 0u);
  EXPECT_EQ(log.records()[0].index, 0u);
  EXPECT_EQ(log.records()[0].display_start, 1'000u);
  EXPECT_EQ(log.records()[0].display_end, 1'400u);
  EXPECT_FALSE(log.records()[0].repeated);
  // The same address again: the flip counts only with a new one.
  log.show(Phase::kFlip, 3);
  EXPECT_TRUE(log.latch(0x8000'0000, 0));
  EXPECT_TRUE(log.shown(0, 0).repeated);
  EXPECT_EQ(log.records()[1].captured, 2u);
  EXPECT_EQ(log.records()[1].index, 1u);
  EXPECT_EQ(log.flipped_to(3), 3u);
  EXPECT_EQ(log.records()[2].dropped, 0u) << "the next one";
  EXPECT_EQ(log.flipped_to(5), 5u);
  EXPECT_EQ(log.records()[3].dropped, 1u);
  EXPECT_EQ(log.flipped_to(9), 9u);
  EXPECT_EQ(log.records()[4].dropped, 3u);
  EXPECT_EQ(log.flipped_to(8), 8u);
  EXPECT_EQ(log.records()[5].dropped, 0u) << "backwards";
}

TEST(FrameLogTest, APhasesFirstTimeAndARemapsDurationAreKept) {
  Log log;
  EXPECT_EQ(log.first(Phase::kLut), std::nullopt);
  log.show(Phase::kLut, 0, 10);
  log.show(Phase::kIdle, 0, 20);
  log.show(Phase::kLut, 0, 30);
  EXPECT_EQ(log.first(Phase::kLut), 10u);
  EXPECT_EQ(log.phase(), Phase::kLut);
  log.show(Phase::kRemapEnd, 0, 40);
  EXPECT_TRUE(log.remaps().empty()) << "none was begun";
  log.show(Phase::kRemapStart, 0, 50);
  log.show(Phase::kRemapEnd, 0, 80);
  log.show(Phase::kRemapEnd, 0, 90);
  ASSERT_EQ(log.remaps().size(), 1u);
  EXPECT_EQ(log.remaps()[0].captured, 0u);
  EXPECT_EQ(log.remaps()[0].start, 50u);
  EXPECT_EQ(log.remaps()[0].end, 80u);
}

/// A display of 40 units a frame that shows frame 0, captured from 0 to 38, from 80 on; the decoder had found
/// its syncs at a given time when the display began each frame.
struct Display : FrameLog {
  Display() {
    capture(0, 0, 38);
    flip(0);
    frame(0);
  }
  void flip(unsigned n) {
    pins(static_cast<std::uint32_t>(Phase::kFlip) | n << 4, 0);
    latch(address += 0x100, 0);
  }
  /// Shows a frame; whether it is one that the decoder is to blame for.
  bool frame(Picoseconds synced_at) {
    decoder(synced_at);
    const video::FrameTimes& r = shown(now, now + 38);
    now += 40;
    EXPECT_TRUE(r.repeated || !r.relock);
    return r.relock;
  }
  std::uint32_t address = 0x8000'0000;
  Picoseconds now = 80;
};

TEST(FrameLogTest, AFrameIsShownAgainForTheDecodersSakeUntilAFrameAfterTheLockIsThere) {
  Display d;
  EXPECT_TRUE(d.frame(120)) << "still searching";
  EXPECT_TRUE(d.frame(140)) << "locked";
  EXPECT_TRUE(d.frame(140)) << "a frame that begins a period after the lock is not yet there";
  d.capture(1, 179, 217);
  EXPECT_TRUE(d.frame(140)) << "it is being corrected";
  d.capture(2, 219, 257);
  EXPECT_FALSE(d.frame(140)) << "another one has come meanwhile";
  d.flip(2);
  EXPECT_FALSE(d.frame(140)) << "a new frame";
  EXPECT_FALSE(d.frame(140)) << "the lock has held since";
  EXPECT_FALSE(d.frame(219)) << "up to its start";
  EXPECT_TRUE(d.frame(400)) << "and was lost then";
}

TEST(FrameLogTest, ADecoderThatHasLockedExcusesTwoFramePeriods) {
  Display at, behind;
  EXPECT_TRUE(at.frame(40)) << "80 before";
  EXPECT_FALSE(behind.frame(39));
}

TEST(FrameLogTest, ADecoderThatWasAlwaysLockedExcusesNothing) {
  Display d;
  EXPECT_FALSE(d.frame(0));
  d.capture(1, 79, 117);
  EXPECT_FALSE(d.frame(0));
}

TEST(FrameLogTest, WhatIsCapturedWithoutALockIsNoNewerFrame) {
  Display d;
  d.capture(1, 39, 77, video::kNoCamera);
  d.capture(2, 79, 117, video::kNoCamera);
  EXPECT_TRUE(d.frame(120));
  d.capture(3, 119, 157);
  EXPECT_TRUE(d.frame(120));
}

TEST(FrameLogTest, AFrameThatEndsBehindTheDisplaysStartIsNotThereYet) {
  for (const Picoseconds end : {120u, 121u}) {
    Display d;
    d.capture(1, 60, 98);
    d.capture(2, 100, end);
    EXPECT_EQ(d.frame(59), end > 120) << end;
  }
}

TEST(FrameLogTest, ForgetsTheOldestWhenThereAreTwiceAsMany) {
  Log log;
  unsigned gone = 0;
  const auto count = [&gone](const auto&) { ++gone; };
  log.captured_up_to(8);
  log.forget(5, count);
  EXPECT_EQ(gone, 0u);
  EXPECT_EQ(log.captures().size(), 9u);
  log.capture(9, 900, 950);
  log.forget(5, count);
  EXPECT_EQ(gone, 5u);
  ASSERT_EQ(log.captures().size(), 5u);
  EXPECT_EQ(log.captures().front(), 550u);
}

TEST(FrameLogTest, EachCapturedFrameHasOneFate) {
  Log log;
  // Camera 0, 1, 0, 1 ...; frame 6 began while no camera was locked.
  for (std::uint64_t i = 0; i < 9; ++i)
    log.capture(i, i * 100, i * 100 + 50, i == 6 ? video::kNoCamera : static_cast<unsigned>(i % 2));
  const auto remap = [&](unsigned n) {
    log.show(Phase::kRemapStart, n);
    log.show(Phase::kRemapEnd, n);
  };
  for (const unsigned n : {1u, 3u, 4u, 5u, 8u}) remap(n);
  log.flipped_to(1);  // what was before the first one on show does not count
  log.flipped_to(4);  // 2 was not corrected, 3 was
  EXPECT_EQ(log.shown(0, 0).camera, 0u);
  log.flipped_to(8);  // 5 was corrected, 6 is of no camera, 7 was not corrected
  const auto fates = [&](std::size_t camera) {
    const FrameLog::Fates& f = log.fates(camera);
    return std::array<std::uint64_t, 4>{f.captured, f.displayed, f.superseded, f.dropped};
  };
  EXPECT_EQ(fates(0), (std::array<std::uint64_t, 4>{3, 2, 0, 1}));
  EXPECT_EQ(fates(1), (std::array<std::uint64_t, 4>{4, 1, 2, 1}));
  EXPECT_EQ(fates(2), (std::array<std::uint64_t, 4>{0, 0, 0, 0}));
}

TEST(FrameLogTest, AtTheEndOldFramesHaveAFateAndYoungOnesArePending) {
  Log log;
  // Frame i is in memory at 100 i + 50. 1 is on show, 3 was corrected by 370, 5 is being corrected.
  for (std::uint64_t i = 0; i < 9; ++i)
    log.capture(i, i * 100, i * 100 + 50, i == 2 ? video::kNoCamera : static_cast<unsigned>(i % 2));
  const auto fates = [&](std::size_t camera) {
    const FrameLog::Fates& f = log.fates(camera);
    return std::array<std::uint64_t, 5>{f.captured, f.displayed, f.superseded, f.dropped, f.pending};
  };
  log.finish(10'000, 0);
  EXPECT_EQ(fates(0), (std::array<std::uint64_t, 5>{})) << "nothing was shown";
  log.flipped_to(1);
  log.show(Phase::kRemapStart, 3, 360);
  log.show(Phase::kRemapEnd, 3, 370);
  log.show(Phase::kRemapStart, 5, 860);
  log.finish(951, 200);  // 7 is 201 old, 8 is 101
  EXPECT_EQ(fates(0), (std::array<std::uint64_t, 5>{2, 0, 0, 2, 1})) << "4 and 6; 8 is young";
  EXPECT_EQ(fates(1), (std::array<std::uint64_t, 5>{3, 1, 1, 1, 1})) << "1, 3 and 7; 5 is in work";
  EXPECT_EQ(log.never_shown(), 5u) << "2, 3, 4, 6, 7";
}

TEST(FrameLogTest, AFrameOfTheVeryAgeIsPending) {
  Log log;
  log.captured_up_to(2);
  log.flipped_to(0);
  log.finish(450, 200);  // 2 is 200 old
  EXPECT_EQ(log.fates(0).dropped, 1u);
  EXPECT_EQ(log.fates(0).pending, 1u);
}

TEST(FrameLogTest, FramesAreCountedThatWereForgottenBeforeAnotherOneIsShown) {
  Log log;
  log.captured_up_to(0);
  log.flipped_to(0);
  for (std::uint64_t i = 1; i < 200; ++i) log.capture(i, i * 100, i * 100 + 50);
  EXPECT_EQ(log.never_shown(), 71u) << "1 to 71 are no longer among the latest 128";
  EXPECT_EQ(log.fates(0).dropped, 71u);
  log.flipped_to(199);
  EXPECT_EQ(log.fates(0).dropped, 198u);
  EXPECT_EQ(log.fates(0).captured, 200u);
  EXPECT_EQ(log.records().back().dropped, 198u);
  EXPECT_EQ(log.never_shown(), 0u);
}

}  // namespace
}  // namespace fovea::board
