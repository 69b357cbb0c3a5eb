// Buffer management, switches, overlay and the plain kernel, without hardware.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <numeric>
#include <set>

extern "C" {
#include "sw/firmware/app/capture.h"
#include "sw/firmware/app/capture_check.h"
#include "sw/firmware/app/config.h"
#include "sw/firmware/app/display_watch.h"
#include "sw/firmware/app/loop_watch.h"
#include "sw/firmware/app/open_frame.h"
#include "sw/firmware/app/output.h"
#include "sw/firmware/app/overlay.h"
#include "sw/lens/lens.h"
// C99's restrict is no C++ word.
#define restrict __restrict
#include "sw/firmware/kernels/remap.h"
#undef restrict

uint32_t mmio_read32(uint32_t) { return 0; }
void mmio_write32(uint32_t, uint32_t) {}
}

namespace {

TEST(CaptureTest, FramesTakenInTimeAreNeverDropped) {
  capture_t c;
  capture_init(&c, 3);
  std::uint32_t sequence = 99;
  EXPECT_EQ(capture_take(&c, &sequence), CAPTURE_NONE);
  for (std::uint32_t n = 0; n < 10; ++n) {
    const int filled = c.filling;
    const int next = capture_frame_done(&c);
    ASSERT_NE(next, CAPTURE_NONE);
    EXPECT_NE(next, filled);
    EXPECT_EQ(capture_take(&c, &sequence), filled);
    EXPECT_EQ(sequence, n);
    capture_release(&c, filled);
  }
  EXPECT_EQ(c.dropped, 0u);
}

TEST(CaptureTest, ABufferInWorkIsNeverFilled) {
  capture_t c;
  capture_init(&c, 3);
  std::uint32_t sequence;
  capture_frame_done(&c);
  const int busy = capture_take(&c, &sequence);
  for (int n = 0; n < 7; ++n) {
    const int next = capture_frame_done(&c);
    ASSERT_NE(next, CAPTURE_NONE);
    EXPECT_NE(next, busy);
    EXPECT_NE(next, c.ready);
  }
  EXPECT_EQ(c.dropped, 6u);  // seven waited, the newest still does
  EXPECT_NE(capture_take(&c, &sequence), CAPTURE_NONE);
  EXPECT_EQ(sequence, 7u);
}

TEST(CaptureTest, WithoutAFreeBufferTheNewFrameIsDropped) {
  capture_t c;
  capture_init(&c, 2);
  std::uint32_t sequence;
  capture_frame_done(&c);
  capture_take(&c, &sequence);
  EXPECT_EQ(capture_frame_done(&c), CAPTURE_NONE);
  EXPECT_EQ(c.dropped, 1u);
  EXPECT_EQ(c.ready, CAPTURE_NONE);
}

TEST(CaptureTest, SerialFlowReusesTheOneBuffer) {
  capture_t c;
  capture_init(&c, 1);
  std::uint32_t sequence;
  for (std::uint32_t n = 0; n < 3; ++n) {
    capture_single_done(&c);
    EXPECT_EQ(capture_take(&c, &sequence), 0);
    EXPECT_EQ(sequence, n);
    capture_release(&c, 0);
  }
  EXPECT_EQ(c.dropped, 0u);
}

// Four frames are held while a remap reads them; two more buffers are enough for the camera.
TEST(CaptureTest, HeldFramesAreNeverFilledAndTheOldestGoesFirst) {
  capture_t c;
  held_t held{};
  capture_init(&c, 6);
  std::uint32_t sequence, n = 0;
  for (std::uint32_t round = 0; round < 9; ++round) {
    for (std::uint32_t frames = 0; frames <= round % 3; ++frames, ++n) {
      const int next = capture_frame_done(&c);
      ASSERT_NE(next, CAPTURE_NONE);
      for (std::uint32_t age = 0; age < held.count; ++age) EXPECT_NE(next, held_of_age(&held, age));
    }
    const int taken = capture_take(&c, &sequence);
    EXPECT_EQ(sequence, n - 1);
    held_add(&held, taken);
    EXPECT_EQ(held_of_age(&held, 0), taken);
    if (held.count < 4) continue;
    // The camera goes on while the four are read.
    for (std::uint32_t frames = 0; frames < 5; ++frames, ++n) {
      const int next = capture_frame_done(&c);
      ASSERT_NE(next, CAPTURE_NONE);
      for (std::uint32_t age = 0; age < 4; ++age) EXPECT_NE(next, held_of_age(&held, age));
    }
    const int oldest = held_of_age(&held, 3), second = held_of_age(&held, 2);
    EXPECT_EQ(held_drop(&held), oldest);
    capture_release(&c, oldest);
    EXPECT_EQ(held.count, 3u);
    EXPECT_EQ(held_of_age(&held, 2), second);
    EXPECT_EQ(held_of_age(&held, 0), taken);
  }
}

TEST(CaptureTest, WithOneBufferLessTheCameraRunsOutOfThem) {
  capture_t c;
  capture_init(&c, 5);
  std::uint32_t sequence;
  for (int n = 0; n < 4; ++n) {
    EXPECT_NE(capture_frame_done(&c), CAPTURE_NONE);
    capture_take(&c, &sequence);
  }
  EXPECT_EQ(capture_frame_done(&c), CAPTURE_NONE);
}

// What an older frame has left in a buffer cannot be told from a new one.
TEST(CaptureTest, ABufferThatIsFilledAnewWithoutHavingBeenTakenIsKnown) {
  capture_t c;
  capture_init(&c, 3);
  EXPECT_EQ(capture_frame_done(&c), 1);
  EXPECT_EQ(c.reused, 0u);
  EXPECT_EQ(capture_frame_done(&c), 2) << "the frame in buffer 0 is replaced, and 2 is free without that";
  EXPECT_EQ(c.reused, 1u << 0);
  EXPECT_EQ(capture_frame_done(&c), 0) << "no other one is free";
  EXPECT_EQ(c.reused, 1u << 0 | 1u << 1);
  c.reused = 0;
  capture_frame_useless(&c);
  EXPECT_EQ(c.reused, 1u << 0) << "the one that is filled";
  capture_t two;
  capture_init(&two, 2);
  std::uint32_t sequence;
  EXPECT_EQ(capture_frame_done(&two), 1);
  capture_take(&two, &sequence);
  EXPECT_EQ(capture_frame_done(&two), CAPTURE_NONE);
  EXPECT_EQ(two.reused, 1u << 1);
}

TEST(CaptureCheckTest, EachUnitThatWasNotWrittenIsCountedAndNothingElse) {
  constexpr std::uint32_t kBytes = 72, kPitch = 96, kRows = 3;  // two whole units and a part of one
  alignas(4) std::uint8_t frame[kPitch * kRows];
  const auto capture = [&] {
    for (std::uint32_t r = 0; r < kRows; ++r)
      for (std::uint32_t i = 0; i < kBytes; ++i) frame[r * kPitch + i] = static_cast<std::uint8_t>(1 + (r + i) % 254);
  };
  std::memset(frame, 0x55, sizeof frame);
  capture_check_mark(frame, kBytes, kPitch, kRows);
  EXPECT_EQ(capture_check_lost(frame, kBytes, kPitch, kRows), 9u);
  for (std::uint32_t r = 0; r < kRows; ++r)
    for (std::uint32_t i = kBytes; i < kPitch; ++i) EXPECT_EQ(frame[r * kPitch + i], 0x55) << "no picture there";
  capture();
  EXPECT_EQ(capture_check_lost(frame, kBytes, kPitch, kRows), 0u);
  for (std::uint32_t unit = 0; unit < 9; ++unit) {
    capture_check_mark(frame, kBytes, kPitch, kRows);
    std::uint8_t marked[32];
    std::uint8_t* const lost = frame + unit / 3 * kPitch + unit % 3 * 32;
    std::memcpy(marked, lost, sizeof marked);
    capture();
    std::memcpy(lost, marked, sizeof marked);
    EXPECT_EQ(capture_check_lost(frame, kBytes, kPitch, kRows), 1u) << unit;
  }
}

// A frame of no use is followed by one that goes into a buffer with its marks.
TEST(CaptureTest, CaptureMovesOnToABufferThatWasNotFilledAnew) {
  capture_t c;
  capture_init(&c, 4);
  capture_frame_useless(&c);
  EXPECT_EQ(capture_move_on(&c), 1);
  EXPECT_EQ(c.filling, 1);
  EXPECT_EQ(capture_take_reused(&c), 0) << "to be marked again";
  EXPECT_EQ(capture_take_reused(&c), CAPTURE_NONE) << "it is busy meanwhile";
  capture_frame_broken(&c);
  EXPECT_EQ(c.dropped, 1u) << "a part of a frame is none";
  EXPECT_EQ(capture_move_on(&c), 2);
  EXPECT_EQ(capture_move_on(&c), 3);
  capture_frame_broken(&c);
  EXPECT_EQ(capture_move_on(&c), 2) << "2 was not filled";
  c.reused |= 1u << 3 | 1u << 2;
  EXPECT_EQ(capture_move_on(&c), CAPTURE_NONE) << "0 is busy, 1 and 3 have no marks";
  EXPECT_EQ(c.filling, 2);
  c.reused = 1u << 1;
  EXPECT_EQ(capture_frame_done(&c), 3) << "not 1, whose marks are gone";
  EXPECT_EQ(c.ready, 2);
  capture_release(&c, 0);
  c.busy |= 1u << 0;
  c.reused = 1u << 1 | 1u << 3;
  EXPECT_EQ(capture_take_reused(&c), 1) << "neither the one that is filled";
}

TEST(CaptureTest, AnOpenFrameWaitsForItsJudgementWhileTheNextOneIsFilled) {
  capture_t c;
  capture_init(&c, 4);
  open_frame_t open{CAPTURE_NONE, 0};
  EXPECT_EQ(open_frame_begin(&open, &c), 1);
  EXPECT_EQ(c.ready, CAPTURE_NONE) << "it is not there to be taken yet";
  open_frame_good(&open, &c);
  EXPECT_EQ(c.ready, 0);
  EXPECT_EQ(c.ready_sequence, 0u);
  EXPECT_EQ(open.buffer, CAPTURE_NONE);
  // The frame that waits is not touched before the open one is known to be good.
  EXPECT_EQ(open_frame_begin(&open, &c), 2);
  EXPECT_EQ(c.ready, 0);
  EXPECT_EQ(c.ready_sequence, 0u);
  open_frame_useless(&open, &c);
  EXPECT_EQ(c.ready, 0);
  EXPECT_EQ(c.dropped, 1u);
  EXPECT_EQ(c.reused, 1u << 1) << "its marks are gone";
  EXPECT_EQ(open_frame_begin(&open, &c), 3);
  open_frame_good(&open, &c);
  EXPECT_EQ(c.ready, 2);
  EXPECT_EQ(c.ready_sequence, 2u);
  EXPECT_EQ(c.dropped, 2u) << "the frame that waited";
  EXPECT_EQ(c.reused, 1u << 1 | 1u << 0);
  // One in work, one that waits, one open: the fourth one is filled, and there is no fifth.
  uint32_t sequence = 0;
  EXPECT_EQ(capture_take(&c, &sequence), 2);
  EXPECT_EQ(open_frame_begin(&open, &c), 0);
  open_frame_good(&open, &c);
  EXPECT_EQ(open_frame_begin(&open, &c), 1);
  EXPECT_EQ(c.busy, 1u << 2 | 1u << 0) << "in work, and open";
  open_frame_t fifth{CAPTURE_NONE, 0};
  EXPECT_EQ(open_frame_begin(&fifth, &c), CAPTURE_NONE);
  EXPECT_EQ(fifth.buffer, CAPTURE_NONE);
  EXPECT_EQ(c.ready, 3) << "still waiting";
  EXPECT_EQ(c.dropped, 3u);
}

TEST(DisplayWatchTest, EachChangeIsSaidOnceAndItIsFineAfterASecond) {
  display_watch_t w{};
  const auto fine = [&](unsigned fields) {
    for (unsigned n = 0; n < fields; ++n) display_watch_field(&w, 0);
  };
  fine(1);
  EXPECT_EQ(display_watch_take(&w), DISPLAY_NOTHING);
  display_watch_field(&w, 1);
  EXPECT_EQ(display_watch_take(&w), DISPLAY_LATE);
  display_watch_field(&w, 1);
  fine(DISPLAY_FINE_FIELDS - 1);
  display_watch_field(&w, 1);
  fine(DISPLAY_FINE_FIELDS - 1);
  EXPECT_EQ(display_watch_take(&w), DISPLAY_NOTHING) << "a second anew";
  fine(1);
  EXPECT_EQ(display_watch_take(&w), DISPLAY_FINE);
  fine(200);
  EXPECT_EQ(display_watch_take(&w), DISPLAY_NOTHING);
  EXPECT_EQ(w.late_fields, 3u);
}

// The main loop may be busy for longer than a second.
TEST(DisplayWatchTest, ChangesWaitUntilTheyAreSaid) {
  using Said = std::vector<display_event_t>;
  for (unsigned changes = 1; changes <= 6; ++changes) {
    display_watch_t w{};
    for (unsigned n = 0; n < changes; ++n)
      for (unsigned field = 0; field < (n % 2 ? DISPLAY_FINE_FIELDS : 1u); ++field) display_watch_field(&w, n % 2 == 0);
    Said said, want = changes % 2 ? Said{DISPLAY_LATE} : Said{};
    if (changes > 1) want.insert(want.begin(), {DISPLAY_LATE, DISPLAY_FINE});
    for (display_event_t e; (e = display_watch_take(&w)) != DISPLAY_NOTHING;) said.push_back(e);
    EXPECT_EQ(said, want) << changes;
  }
}

TEST(OutputTest, ABufferThatIsGivenBackIsTakenAgain) {
  output_t o;
  output_init(&o, 2);
  const int first = output_take(&o), second = output_take(&o);
  EXPECT_EQ(output_take(&o), OUTPUT_NONE);
  output_give_back(&o, first);
  EXPECT_EQ(o.queued, 0u) << "it is not displayed";
  EXPECT_EQ(output_take(&o), first);
  output_give_back(&o, second);
  EXPECT_EQ(output_take(&o), second);
}

TEST(OutputTest, ABufferIsNeverWrittenWhileItMayBeShown) {
  output_t o;
  output_init(&o, 4);
  std::uint32_t sequence, expected = 0;
  std::set<int> seen;
  int released;
  for (std::uint32_t n = 0; n < 20; ++n) {
    const int buffer = output_take(&o);
    ASSERT_NE(buffer, OUTPUT_NONE);
    EXPECT_NE(buffer, o.shown);
    EXPECT_NE(buffer, o.pending);
    output_queue(&o, buffer, n);
    const int next = output_next(&o, &sequence);  // second field
    EXPECT_EQ(next, buffer);
    EXPECT_EQ(sequence, expected++);
    EXPECT_EQ(output_next(&o, &sequence), OUTPUT_NONE) << "the display has not taken the last one";
    EXPECT_EQ(output_first_field(&o, &released), 1);
    EXPECT_EQ(o.shown, buffer);
    EXPECT_EQ(output_first_field(&o, &released), 0);
    seen.insert(buffer);
  }
  EXPECT_GE(seen.size(), 2u);
}

TEST(OutputTest, AQueueKeepsItsOrderAndBlocksWritersWhenFull) {
  output_t o;
  output_init(&o, 3);
  const int a = output_take(&o), b = output_take(&o), c = output_take(&o);
  EXPECT_EQ(output_take(&o), OUTPUT_NONE);
  output_queue(&o, b, 10);
  output_queue(&o, c, 11);
  output_queue(&o, a, 12);
  EXPECT_EQ(output_take(&o), OUTPUT_NONE);
  std::uint32_t sequence;
  int released;
  EXPECT_EQ(output_next(&o, &sequence), b);
  EXPECT_EQ(output_first_field(&o, &released), 1);
  EXPECT_EQ(released, OUTPUT_NONE);
  EXPECT_EQ(output_next(&o, &sequence), c);
  EXPECT_EQ(output_take(&o), OUTPUT_NONE) << "b is still shown until the next first field";
  EXPECT_EQ(output_first_field(&o, &released), 1);
  EXPECT_EQ(released, b);
  EXPECT_EQ(output_take(&o), b);
}

class ConfigTest : public testing::Test {
 protected:
  ConfigTest() {
    page.camera_count = 1;
    lens_view_default(&page.camera[0].view);
  }
  config_result_t read(std::uint32_t dip) { return config_read(&config, dip, &page); }
  param_page_t page{};
  config_t config;
};
constexpr std::uint32_t kNtsc = 3;  // both standards
/// A size for camera and display.
constexpr std::uint32_t size(std::uint32_t code) { return code << 2 | code << 5; }

TEST_F(ConfigTest, StandardsAndSizesGiveTheirPictures) {
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_TRUE(config.is_625);
  EXPECT_EQ(config.width, 720u);
  EXPECT_EQ(config.height, 576u);
  EXPECT_EQ(config.pitch_bytes, 1440u);
  ASSERT_EQ(read(size(1)), CONFIG_OK);
  EXPECT_EQ(config.height, 576u);
  ASSERT_EQ(read(kNtsc), CONFIG_OK);
  EXPECT_FALSE(config.is_625);
  EXPECT_EQ(config.height, 480u);
  ASSERT_EQ(read(kNtsc | size(4)), CONFIG_OK);
  EXPECT_EQ(config.width, 640u);
  EXPECT_EQ(config.left, 40u);
  EXPECT_EQ(config.pitch_bytes, 1280u);
  ASSERT_EQ(read(kNtsc | size(3)), CONFIG_OK) << "all lines of 525/60";
  EXPECT_EQ(config.height, 486u);
  EXPECT_EQ(config.top, 0u);
  page.height = 486;
  EXPECT_EQ(read(kNtsc), CONFIG_BAD_REGION) << "the switches alone say so";
  page.height = 0;
  ASSERT_EQ(read(size(2)), CONFIG_OK) << "480 lines of 576, in the middle";
  EXPECT_EQ(config.top, 48u);
}

TEST_F(ConfigTest, WhatTheBoardCannotDoIsRefused) {
  EXPECT_EQ(read(1), CONFIG_BAD_STANDARDS);
  EXPECT_EQ(read(2), CONFIG_BAD_STANDARDS);
  EXPECT_EQ(read(kNtsc | 1 << 2 | 2 << 5), CONFIG_BAD_SIZES) << "another size for the display";
  EXPECT_EQ(read(size(6)), CONFIG_BAD_SIZES);
  EXPECT_EQ(read(size(7)), CONFIG_BAD_SIZES);
  EXPECT_EQ(read(kNtsc | size(1)), CONFIG_BAD_REGION) << "576 lines in 525/60";
  EXPECT_EQ(read(size(3)), CONFIG_BAD_REGION) << "486 lines in 625/50";
  EXPECT_EQ(read(size(5)), CONFIG_BAD_REGION) << "800 pixels in a line of 720";
  EXPECT_EQ(read(3 << 11), CONFIG_BAD_SHIFT);
  EXPECT_EQ(read(3 << 13), CONFIG_BAD_SHIFT);
}

TEST_F(ConfigTest, ADigitalCameraIsCapturedWholeAndShownInAnotherSize) {
  page.flags = PARAM_DIGITAL;
  ASSERT_EQ(read(5 << 2 | 1 << 5), CONFIG_OK) << "800x600 as 720x576";
  EXPECT_EQ(config.source_width, 800u);
  EXPECT_EQ(config.source_height, 600u);
  EXPECT_EQ(config.source_left + config.source_top, 0u);
  EXPECT_EQ(config.width, 720u);
  EXPECT_EQ(config.height, 576u);
  EXPECT_EQ(config.pitch_bytes, 1600u) << "of both";
  page.width = 160;
  page.height = 120;
  ASSERT_EQ(read(5 << 2), CONFIG_OK) << "a region of the display alone";
  EXPECT_EQ(config.width, 160u);
  EXPECT_EQ(config.left, 280u);
  EXPECT_EQ(config.source_width, 800u);
  page.width = page.height = 0;
  ASSERT_EQ(read(kNtsc | size(4)), CONFIG_OK);
  EXPECT_EQ(config.source_left, 0u);
  EXPECT_EQ(config.left, 40u);
  EXPECT_EQ(config.pitch_bytes, 1280u);
  ASSERT_EQ(read(4 << 2), CONFIG_OK) << "640x480 in all of 625/50";
  EXPECT_EQ(config.pitch_bytes, 1440u) << "that of the display is longer";
  EXPECT_EQ(read(1 << 2 | 1 << 5), CONFIG_BAD_DIGITAL);
  EXPECT_EQ(read(5 << 2 | 5 << 5), CONFIG_BAD_REGION) << "800 pixels in a displayed line of 720";
  EXPECT_EQ(read(5 << 2 | 6 << 5), CONFIG_BAD_SIZES);
  page.flags = 0;
  EXPECT_EQ(read(5 << 2 | 1 << 5), CONFIG_BAD_SIZES) << "behind the decoder there is no such camera";
  ASSERT_EQ(read(kNtsc | size(4)), CONFIG_OK);
  EXPECT_EQ(config.source_left, 40u);
  EXPECT_EQ(config.source_width, 640u);
}

TEST_F(ConfigTest, RepeatsComeFromThePage) {
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_EQ(config.repeats, 1u);
  page.repeats = 7;
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_EQ(config.repeats, 7u);
}

TEST_F(ConfigTest, TablesAndSourcesComeFromThePage) {
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_EQ(config.tables, 1u) << "0 stands for one";
  EXPECT_EQ(config.sources, 1u);
  page.tables = 4;
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_EQ(config.tables, 4u);
  EXPECT_EQ(config.sources, 4u);
  page.flow = FLOW_SERIAL;
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_EQ(config.tables, 4u);
  EXPECT_EQ(config.sources, 1u) << "one input buffer";
}

TEST_F(ConfigTest, TheMappingOfTheSwitchesWins) {
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_EQ(config.view.mapping, std::uint32_t{LENS_EQUISOLID}) << "as the page says";
  for (std::uint32_t mapping = LENS_NONE; mapping <= LENS_TABLE; ++mapping) {
    ASSERT_EQ(read((mapping + 1) << 8), CONFIG_OK);
    EXPECT_EQ(config.view.mapping, mapping);
  }
}

TEST_F(ConfigTest, ShiftsAddToThoseOfThePage) {
  page.camera[0].view.shift_x = 5;
  page.camera[0].view.shift_y = -7;
  ASSERT_EQ(read(1 << 11 | 2 << 13), CONFIG_OK);
  EXPECT_EQ(config.view.shift_x, 37);
  EXPECT_EQ(config.view.shift_y, -39);
  ASSERT_EQ(read(2 << 11 | 1 << 13), CONFIG_OK);
  EXPECT_EQ(config.view.shift_x, -27);
  EXPECT_EQ(config.view.shift_y, 25);
}

TEST_F(ConfigTest, EachMemberOfThePageActs) {
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_FALSE(config.serial || config.overlay || config.self_patch || config.kernel ||
               config.table_builder);
  page.kernel = KERNEL_LDM;
  page.table_builder = BUILDER_FIXED;
  page.flow = FLOW_SERIAL;
  page.clocks.vpss_clk_ctrl = 0x38;
  page.priority[3] = 5;
  page.camera[0].view.fov_deg = 99;
  page.flags = PARAM_OVERLAY;
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_EQ(config.kernel, std::uint32_t{KERNEL_LDM});
  EXPECT_EQ(config.table_builder, std::uint32_t{BUILDER_FIXED});
  EXPECT_TRUE(config.serial);
  EXPECT_TRUE(config.overlay);
  EXPECT_FALSE(config.self_patch);
  EXPECT_EQ(config.vpss_clk_ctrl, 0x38u);
  EXPECT_EQ(config.priority[3], 5);
  EXPECT_EQ(config.view.fov_deg, 99);
  page.flags = PARAM_SELF_PATCH;
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_FALSE(config.overlay);
  EXPECT_TRUE(config.self_patch);
}

TEST_F(ConfigTest, UnknownCodesOfThePageAreRefused) {
  const auto with = [&](std::uint32_t param_page_t::*member, std::uint32_t value) {
    const std::uint32_t before = page.*member;
    page.*member = value;
    const config_result_t result = read(0);
    page.*member = before;
    return result;
  };
  EXPECT_EQ(with(&param_page_t::kernel, KERNEL_COUNT), CONFIG_BAD_KERNEL);
  EXPECT_EQ(with(&param_page_t::table_builder, BUILDER_FIXED + 1), CONFIG_BAD_BUILDER);
  EXPECT_EQ(with(&param_page_t::flow, FLOW_SERIAL + 1), CONFIG_BAD_FLOW);
  EXPECT_EQ(with(&param_page_t::tables, 4), CONFIG_OK);
  EXPECT_EQ(with(&param_page_t::tables, 5), CONFIG_BAD_TABLES);
  EXPECT_EQ(with(&param_page_t::camera_count, 2), CONFIG_BAD_CAMERAS);
  std::set<std::string> seen;
  for (int r = 0; r < CONFIG_RESULTS; ++r)
    seen.insert(config_result_text(static_cast<config_result_t>(r)));
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(CONFIG_RESULTS)) << "a sentence each";
  EXPECT_EQ(seen.count("unknown"), 0u);
}

TEST_F(ConfigTest, APageWithARegionIsCentred) {
  page.width = 352;
  page.height = 288;
  ASSERT_EQ(read(0), CONFIG_OK);
  EXPECT_EQ(config.left, 184u);
  EXPECT_EQ(config.top, 144u);
  EXPECT_EQ(config.pitch_bytes, 704u);
  ASSERT_EQ(read(size(1)), CONFIG_OK);
  EXPECT_EQ(config.width, 720u) << "the switches win";
}

TEST_F(ConfigTest, ARegionThatDoesNotFitIsRefused) {
  page.height = 576;
  EXPECT_EQ(read(kNtsc), CONFIG_BAD_REGION);
  page.height = 0;
  page.width = 722;
  EXPECT_EQ(read(0), CONFIG_BAD_REGION);
  page.width = 358;
  EXPECT_EQ(read(0), CONFIG_BAD_REGION);
}

TEST(LoopWatchTest, AStallIsSaidOnceAfterThePatienceAndEndsWithProgress) {
  constexpr std::uint32_t start = 0xFFFF'FF00;  // the counter wraps
  loop_watch_t w;
  loop_watch_init(&w, 1000, start);
  EXPECT_EQ(loop_watch_look(&w, start + 1000), 0);
  EXPECT_EQ(loop_watch_progress(&w, start + 1000), 0u) << "nothing was said";
  EXPECT_EQ(loop_watch_look(&w, start + 2000), 0);
  EXPECT_EQ(loop_watch_look(&w, start + 2001), 1);
  EXPECT_EQ(loop_watch_look(&w, start + 9000), 0) << "once";
  EXPECT_EQ(loop_watch_progress(&w, start + 9500), 8500u);
  EXPECT_EQ(loop_watch_progress(&w, start + 9600), 0u);
  EXPECT_EQ(loop_watch_look(&w, start + 10600), 0);
  EXPECT_EQ(loop_watch_look(&w, start + 10601), 1) << "and again";
}

TEST(OverlayTest, HalvesTowardsItsLumaInsideTheBoxOnly) {
  std::vector<std::uint8_t> frame(1440 * 64);
  std::iota(frame.begin(), frame.end(), std::uint8_t{0});
  const std::vector<std::uint8_t> before = frame;
  overlay_draw(frame.data(), 1440, 0xC0);
  for (unsigned v = 0; v < 64; ++v)
    for (unsigned i = 0; i < 1440; ++i) {
      const bool luma = i % 2 == 1, inside = v >= 32 && v < 48 && i >= 64 && i < 192;
      const unsigned old = before[v * 1440 + i];
      ASSERT_EQ(frame[v * 1440 + i], luma && inside ? (old + 0xC0) / 2 : old) << v << ' ' << i;
    }
}

TEST(OverlayTest, BlinksEightFramesOnEightOff) {
  for (std::uint32_t n = 0; n < 64; ++n) EXPECT_EQ(overlay_visible(n) != 0, n / 8 % 2 == 0);
}

TEST(RemapTest, CopiesTheWordAtEachOffset) {
  const std::array<std::uint32_t, 6> in{10, 11, 12, 13, 14, 15};
  const std::array<std::uint32_t, 5> lut{20, 0, 4, 4, 16};
  std::array<std::uint32_t, 6> out{};
  remap_plain(out.data(), in.data(), lut.data(), 5);
  EXPECT_EQ(out, (std::array<std::uint32_t, 6>{15, 10, 11, 11, 14, 0}));
  remap_plain(out.data() + 5, in.data(), lut.data(), 0);
  EXPECT_EQ(out[5], 0u);
}

}  // namespace
