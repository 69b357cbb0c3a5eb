// The checks of the display: right frames from right lines, and a violation for each kind of error.
#include "model/video/core/frame_assembler.h"

#include <gtest/gtest.h>

#include "model/common/clock.h"

namespace fovea::video {
namespace {

/// Feeds a raster like an encoder's, with one fault where asked.
struct Feed {
  explicit Feed(const Standard& standard, Frequency f = kByteClock, Picoseconds start = 12'345)
      : s(standard), clock(f, start) {
    sink.on_frame = [this](const Frame& fr) {
      frames.push_back(fr);
      unchanged.push_back(sink.unchanged());
    };
  }
  DisplayLine make(std::uint64_t n) {
    const LinePosition p = locate(s, n);
    const std::uint64_t first = n * s.line_bytes + s.active_offset();
    for (unsigned i = 0; i < kActiveBytes; ++i)
      bytes[i] = static_cast<std::uint8_t>(p.line * 7 + i * 3 + salt);
    return {&s,
            p.line,
            p.field % 2 != 0,
            clock.edge(first),
            clock.edge(first + kActiveBytes),
            bytes.data()};
  }
  /// Sends the active lines of whole frames [from, to).
  template <typename Fault>
  void frames_from_to(unsigned from, unsigned to, Fault fault) {
    for (std::uint64_t n = std::uint64_t{from} * s.lines; n < std::uint64_t{to} * s.lines; ++n) {
      DisplayLine l = make(n);
      if (s.at(l.number).v) continue;
      if (fault(l)) sink.line(l);
    }
  }
  void run(unsigned frame_count) {
    frames_from_to(0, frame_count, [](DisplayLine&) { return true; });
  }
  const Standard& s;
  Clock clock;
  std::array<std::uint8_t, kActiveBytes> bytes{};
  std::uint8_t salt = 0;
  FrameAssembler sink;
  std::vector<Frame> frames;
  std::vector<bool> unchanged;  // of each frame, against the one before
};

class BothStandards : public testing::TestWithParam<const Standard*> {};
INSTANTIATE_TEST_SUITE_P(Standards, BothStandards, testing::Values(&k625, &k525));

TEST_P(BothStandards, FrameThatBeginsAnewIsBrokenOnce) {
  Feed feed(*GetParam());
  const unsigned first = GetParam()->active_first[0];
  // The raster runs to the middle of the first field and begins again.
  bool stop = false;
  feed.frames_from_to(0, 1, [&](DisplayLine& l) {
    stop |= l.number == first + 100;
    return !stop;
  });
  EXPECT_EQ(feed.sink.broken_frames(), 0u) << "not yet known";
  feed.frames_from_to(1, 2, [](DisplayLine&) { return true; });
  EXPECT_EQ(feed.sink.broken_frames(), 1u);
  EXPECT_EQ(feed.frames.size(), 1u);
}

TEST_P(BothStandards, CleanRasterGivesFramesWithoutComplaint) {
  Feed feed(*GetParam());
  feed.run(3);
  EXPECT_EQ(feed.sink.violations(), 0u);
  EXPECT_EQ(feed.sink.broken_frames(), 0u);
  ASSERT_EQ(feed.frames.size(), 3u);
  EXPECT_EQ(feed.frames[0].picture.height, GetParam()->rows);
  EXPECT_EQ(feed.unchanged, (std::vector<bool>{false, true, true}));
  // Row 1 is the first line of the second field.
  EXPECT_EQ(feed.frames[0].picture.row(1)[0],
            static_cast<std::uint8_t>(GetParam()->active_first[1] * 7));
  EXPECT_EQ(feed.frames[0].picture.row(2)[0],
            static_cast<std::uint8_t>((GetParam()->active_first[0] + 1) * 7));
}

// The lines 262 and 525 carry the last two rows.
TEST(FrameAssemblerTest, In525A486RowPictureHasAllLinesOfBothFields) {
  Feed feed(k525);
  feed.sink.rows_525 = 486;
  feed.run(2);
  EXPECT_EQ(feed.sink.violations() + feed.sink.broken_frames(), 0u);
  ASSERT_EQ(feed.frames.size(), 2u);
  ASSERT_EQ(feed.frames[0].picture.height, 486u);
  EXPECT_EQ(feed.frames[0].picture.row(484)[0], static_cast<std::uint8_t>(262 * 7));
  EXPECT_EQ(feed.frames[0].picture.row(485)[0], static_cast<std::uint8_t>(525 * 7));
}

TEST_P(BothStandards, MissingLineIsReportedAndBreaksTheFrame) {
  Feed feed(*GetParam());
  const unsigned lost = GetParam()->active_first[0] + 5;
  feed.frames_from_to(0, 1, [lost](DisplayLine& l) { return l.number != lost; });
  EXPECT_EQ(feed.sink.violations(), 1u);
  EXPECT_EQ(feed.sink.frames(), 0u);
  EXPECT_EQ(feed.sink.broken_frames(), 1u);
}

// One complaint for each property of a line that is not its own.
TEST_P(BothStandards, WrongFieldBitBlankingLineAndWrongLengthAreReported) {
  const unsigned odd_one = GetParam()->active_first[1] + 9;
  const auto complaints = [&](auto change) {
    Feed feed(*GetParam());
    feed.frames_from_to(0, 1, [&](DisplayLine& l) {
      if (l.number == odd_one) change(l);
      return true;
    });
    return feed.sink.violations();
  };
  EXPECT_EQ(complaints([](DisplayLine&) {}), 0u);
  EXPECT_EQ(complaints([](DisplayLine& l) { l.f = !l.f; }), 1u);
  // Two roundings to a picosecond are tolerated.
  EXPECT_EQ(complaints([](DisplayLine& l) { l.end += 1; }), 0u);
  EXPECT_EQ(complaints([](DisplayLine& l) { l.end += 4; }), 1u);
  EXPECT_EQ(complaints([](DisplayLine& l) { l.end -= 4; }), 1u);
  // A blanking line, out of order, of the other field; and the one behind it is out of order too.
  EXPECT_GE(complaints([](DisplayLine& l) { l.number = 1; }), 3u);
}

TEST_P(BothStandards, LateLineIsReported) {
  Feed feed(*GetParam());
  const unsigned late = GetParam()->active_first[1] + 9;
  feed.frames_from_to(0, 1, [late](DisplayLine& l) {
    if (l.number == late) l.start += 1000, l.end += 1000;
    return true;
  });
  EXPECT_EQ(feed.sink.violations(), 2u);  // late, and the next one early against it
}

TEST_P(BothStandards, WrongClockIsReportedOnEveryLine) {
  Feed feed(*GetParam(), Frequency(26'538'461));
  feed.run(1);
  EXPECT_GE(feed.sink.violations(), std::uint64_t{GetParam()->active_count[0]});
}

TEST_P(BothStandards, SlowDriftBelowOnePicosecondALineIsReported) {
  // 10 ppb off: 0.64 ps a line; only the unbroken count can see it.
  Feed feed(*GetParam(), Frequency(2'700'000'027, 100));
  feed.run(1);
  EXPECT_GT(feed.sink.violations(), 0u);
}

TEST_P(BothStandards, SwappedFieldsAreReported) {
  Feed feed(*GetParam());
  feed.frames_from_to(0, 1, [](DisplayLine& l) {
    l.f = !l.f;
    return true;
  });
  EXPECT_EQ(feed.sink.violations(), GetParam()->active_count[0] + GetParam()->active_count[1]);
}

TEST_P(BothStandards, ShortLineIsReported) {
  Feed feed(*GetParam());
  const unsigned number = GetParam()->active_first[0];
  feed.frames_from_to(0, 1, [number](DisplayLine& l) {
    if (l.number == number) l.end -= 37'037;
    return true;
  });
  EXPECT_EQ(feed.sink.violations(), 1u);
}

TEST(FrameAssemblerTest, BlankingLineIsReported) {
  Feed feed(k625);
  DisplayLine l = feed.make(0);  // line 1
  feed.sink.line(l);
  EXPECT_EQ(feed.sink.violations(), 1u);
}

TEST(FrameAssemblerTest, AFrameIsChangedByOneOtherPixelOrByOtherOnes) {
  Feed feed(k625);
  feed.run(1);
  feed.salt = 1;
  feed.frames_from_to(1, 2, [](DisplayLine&) { return true; });
  feed.frames_from_to(2, 3, [&feed](DisplayLine& l) {
    if (l.number == 623) feed.bytes.back() ^= 1;
    return true;
  });
  EXPECT_EQ(feed.unchanged, (std::vector<bool>{false, false, false}));
}

TEST(FrameAssemblerTest, RasterOffDropsTheFrameAndAllowsANewStart) {
  Feed feed(k625);
  feed.frames_from_to(0, 1, [](DisplayLine& l) { return l.number < 100; });
  feed.sink.raster_off();
  EXPECT_EQ(feed.sink.broken_frames(), 1u);
  Feed later(k625, kByteClock, 987'654'321);
  later.frames_from_to(0, 1, [&feed](DisplayLine& l) {
    feed.sink.line(l);
    return false;
  });
  EXPECT_EQ(feed.sink.violations(), 0u);
  EXPECT_EQ(feed.sink.frames(), 1u);
}

}  // namespace
}  // namespace fovea::video
