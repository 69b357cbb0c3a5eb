// What is typed on the console, and the watch over the lengths of the fields.
#include <gtest/gtest.h>

#include <string>
#include <vector>

extern "C" {
#include "sw/firmware/app/console.h"
#include "sw/firmware/app/field_watch.h"
}

namespace {

std::vector<std::string> typed(const std::string& text) {
  console_line_t line{};
  std::vector<std::string> out;
  for (const char c : text)
    if (console_feed(&line, c)) out.emplace_back(line.text);
  return out;
}
using Lines = std::vector<std::string>;

TEST(ConsoleTest, LinesEndWithEitherKeyAndBackspaceTakesBack) {
  EXPECT_EQ(typed("zoom\rhelp\n"), (Lines{"zoom", "help"}));
  EXPECT_EQ(typed("hex\b\x7Flp\b\b\b\b\bhelp\r"), Lines{"help"});
  EXPECT_EQ(typed("unfinished"), Lines{});
  const std::string longest(CONSOLE_LINE_MAX, 'a');
  EXPECT_EQ(typed(longest + "\r"), Lines{longest});
  EXPECT_EQ(typed(longest + "ab\rhelp\r"), (Lines{"?", "help"})) << "too long: no command";
  EXPECT_EQ(typed(longest + "ab\b\b\rhelp\r"), (Lines{"?", "help"})) << "and it stays too long";
}

command_t parsed(const std::string& line, uint32_t cameras = 3) {
  command_t c;
  const char* wrong = command_parse(line.c_str(), cameras, &c);
  EXPECT_EQ(wrong, nullptr) << line << ": " << wrong;
  return c;
}
std::string refusal(const std::string& line, uint32_t cameras = 3) {
  command_t c;
  const char* wrong = command_parse(line.c_str(), cameras, &c);
  return wrong ? wrong : "";
}
std::vector<unsigned> list(const command_t& c) { return {c.list, c.list + c.count}; }

TEST(ConsoleTest, CommandsMeanWhatTheHelpSays) {
  EXPECT_EQ(parsed("").kind, COMMAND_NOTHING);
  EXPECT_EQ(parsed(" \t").kind, COMMAND_NOTHING);
  EXPECT_EQ(parsed(" help ").kind, COMMAND_HELP);
  EXPECT_EQ(parsed("status").kind, COMMAND_STATUS);
  EXPECT_EQ(parsed("camera all").kind, COMMAND_CAMERAS);
  EXPECT_EQ(list(parsed("camera all")), (std::vector<unsigned>{0, 1, 2}));
  EXPECT_EQ(list(parsed("camera 2  0 2")), (std::vector<unsigned>{2, 0, 2}));
  command_t c = parsed("zoom 1 400");
  EXPECT_EQ(c.kind, COMMAND_ZOOM);
  EXPECT_EQ(c.camera, 1u);
  EXPECT_EQ(c.value[0], 400);
  EXPECT_EQ(parsed("zoom 0 25").value[0], 25);
  c = parsed("shift 2 -1000 1000");
  EXPECT_EQ(c.kind, COMMAND_SHIFT);
  EXPECT_EQ(c.camera, 2u);
  EXPECT_EQ(c.value[0], -1000);
  EXPECT_EQ(c.value[1], 1000);
  c = parsed("roi 1 20 0 80 92");
  EXPECT_EQ(c.kind, COMMAND_ROI);
  EXPECT_EQ(c.camera, 1u);
  EXPECT_EQ((std::vector<int32_t>{c.value, c.value + 4}), (std::vector<int32_t>{20, 0, 80, 92}));
  c = parsed("mapping 1 linear");
  EXPECT_EQ(c.kind, COMMAND_MAPPING);
  EXPECT_EQ(c.mapping, unsigned{LENS_LINEAR});
  EXPECT_EQ(parsed("mapping 1 none").mapping, unsigned{LENS_NONE});
  EXPECT_EQ(parsed("mapping 1 page").mapping, CONSOLE_MAPPING_OF_PAGE);
  for (uint32_t n = 0; n <= LENS_TABLE; ++n)
    EXPECT_EQ(parsed(std::string("mapping 0 ") + console_mapping_word(n)).mapping, n);
}

TEST(ConsoleTest, WhatIsWrongIsSaid) {
  EXPECT_EQ(refusal("zom 0 100"), "unknown; help lists the commands");
  EXPECT_EQ(refusal("helpme"), "unknown; help lists the commands");
  EXPECT_EQ(refusal("help me"), "unknown; help lists the commands");
  for (const char* line : {"camera 3", "camera 0 3", "camera -1", "camera x", "zoom 3 100", "zoom", "mapping", "roi",
                           "roi 3 0 0 8 8"})
    EXPECT_EQ(refusal(line), "no such camera") << line;
  EXPECT_EQ(refusal("camera"), "camera needs numbers, or all");
  std::string most = "camera";
  for (unsigned n = 0; n < TURNS_SEQUENCE_MAX; ++n) most += " 0";
  EXPECT_EQ(refusal(most), "");
  EXPECT_EQ(refusal(most + " 0"), "at most 16 cameras in a sequence");
  for (const char* line : {"zoom 0 24", "zoom 0 401", "zoom 0", "zoom 0 100 1", "zoom 0 1000000", "zoom 0 1e2"})
    EXPECT_EQ(refusal(line), "zoom is 25 to 400 percent") << line;
  for (const char* line : {"shift 0 1", "shift 0 1001 0", "shift 0 0 -1001", "shift 0 1 2 3", "shift 0 9999999 0"})
    EXPECT_EQ(refusal(line), "shift is -1000 to 1000 pixels, twice") << line;
  for (const char* line : {"roi 0", "roi 0 1 2 3", "roi 0 1 2 3 4 5", "roi 0 1 2 3 x", "roi 0 1 2 3 4000000"})
    EXPECT_EQ(refusal(line), "roi is left, top, width and height in pixels") << line;
  EXPECT_EQ(refusal("mapping 0 fisheye"), "no such mapping");
  EXPECT_EQ(refusal("mapping 0 linear 1"), "no such mapping");
}

/// A camera's field starts, on the lines of the standard at 24 MHz.
struct Fields {
  field_watch_t watch;
  double at = 4.29e9;  // the counter wraps soon
  bool is_625, second = false;
  uint32_t camera = 0;
  /// The first field start is over.
  explicit Fields(bool standard_625) : is_625(standard_625) {
    field_watch_init(&watch, standard_625);
    next();
  }
  /// The next field start, so many ticks and parts per million late.
  watch_event_t next(int late = 0, double ppm = 0) {
    const double line = (is_625 ? 1728 : 1716) * 24.0 / 27.0;
    // From the first active line of the first field to that of the second one, and back.
    const unsigned there = is_625 ? 336 - 23 : 283 - 20, all = is_625 ? 625 : 525;
    at += (second ? there : all - there) * line * (1 + ppm * 1e-6) + late;
    const auto event = field_watch_field(&watch, camera, second, static_cast<uint32_t>(static_cast<uint64_t>(at)));
    second = !second;
    return event;
  }
};

TEST(FieldWatchTest, TheFieldsOfBothStandardsAreRegular) {
  for (const bool is_625 : {true, false}) {
    Fields f(is_625);
    for (unsigned n = 0; n < 200; ++n) EXPECT_EQ(f.next(), WATCH_NOTHING) << n;
    EXPECT_FALSE(f.watch.irregular);
    EXPECT_EQ(f.watch.camera[0].ppm, 0);
  }
}

TEST(FieldWatchTest, AFieldThatIsATickBeyondTheToleranceIsNot) {
  for (const int sign : {-1, 1}) {
    Fields f(true);
    f.next();
    f.next(sign * static_cast<int>(FIELD_TOLERANCE_TICKS));
    EXPECT_FALSE(f.watch.irregular);
    f.next(sign * static_cast<int>(FIELD_TOLERANCE_TICKS + 1));
    EXPECT_TRUE(f.watch.irregular);
    f.next();
    EXPECT_TRUE(f.watch.irregular) << "until the next frame";
    field_watch_frame(&f.watch);
    f.next();
    EXPECT_FALSE(f.watch.irregular);
  }
}

TEST(FieldWatchTest, AFieldStartThatCameLateDoesNotSpoilTheNextFrame) {
  const int line = 1536;
  Fields f(true);
  f.next();
  f.next(line);  // the second field of a frame
  EXPECT_TRUE(f.watch.irregular);
  field_watch_frame(&f.watch);
  f.next(-line);
  f.next();
  EXPECT_FALSE(f.watch.irregular) << "both field starts of the next frame are where they should be";
  // If all are short, each frame has one that is.
  for (unsigned frame = 0; frame < 5; ++frame) {
    field_watch_frame(&f.watch);
    f.next(-line);
    f.next(-line);
    EXPECT_TRUE(f.watch.irregular) << frame;
  }
}

TEST(FieldWatchTest, TheDistanceFromAnotherRasterIsNotJudged) {
  Fields f(true);
  f.next(123456);
  EXPECT_FALSE(f.watch.irregular);
  f.next();
  field_watch_restart(&f.watch);
  for (unsigned n = 0; n < 2; ++n) f.next(-54321);
  EXPECT_FALSE(f.watch.irregular);
  f.next(-54321);
  EXPECT_TRUE(f.watch.irregular);
}

/// Cameras 0 and 1 in turn, a frame each; camera 1 is next.
struct TwoInTurn : Fields {
  explicit TwoInTurn(bool standard_625) : Fields(standard_625) {
    frame();
    frame();
  }
  /// A frame of the camera that is next, whose fields begin late. @return what was said at them
  std::pair<watch_event_t, watch_event_t> frame(int late_first = 0, int late_second = 0) {
    camera = 1 - camera;
    field_watch_frame(&watch);
    second = false;
    const auto first = next(late_first);
    return {first, next(late_second)};
  }
};
constexpr std::pair kNothingSaid{WATCH_NOTHING, WATCH_NOTHING};

// What is early after a change began early; what is late may have followed a field that ended early.
TEST(FieldWatchTest, AFieldThatLacksLinesIsNotTheFaultOfTheCameraThatFollows) {
  const int line = 1536;
  for (const bool is_625 : {true, false})
    for (const int lines : {1, 4, 100}) {
      TwoInTurn f(is_625);
      EXPECT_EQ(f.frame(), kNothingSaid);
      EXPECT_EQ(f.camera, 1u);
      EXPECT_EQ(f.frame(lines * line), std::pair(WATCH_NOTHING, WATCH_SUSPECT_SHORT));
      EXPECT_EQ(f.watch.suspect, 1u);
      EXPECT_FALSE(f.watch.irregular) << "camera 0's frame is as it should be";
      EXPECT_EQ(f.frame(), kNothingSaid);
      EXPECT_FALSE(f.watch.irregular);
      // A first line that was missed is late itself, and what follows is early.
      EXPECT_EQ(f.frame(lines * line, -lines * line), kNothingSaid);
      EXPECT_TRUE(f.watch.irregular);
      EXPECT_EQ(f.frame(), kNothingSaid);
      EXPECT_FALSE(f.watch.irregular) << "nor is the next one to blame";
      EXPECT_EQ(f.frame(-lines * line), kNothingSaid) << "camera 0 is out of step";
      EXPECT_TRUE(f.watch.irregular);
    }
}

TEST(FieldWatchTest, OfOneCameraALateFieldIsItsOwnFault) {
  Fields f(true);
  f.next();
  f.next();
  f.next(1536);
  EXPECT_TRUE(f.watch.irregular);
  // So it is in the second field after a change: a first field was not seen.
  TwoInTurn other(true);
  other.camera = 0;
  other.next();
  other.second = true;
  other.camera = 1;
  field_watch_frame(&other.watch);
  other.next(1536);
  EXPECT_TRUE(other.watch.irregular);
}

/// How often the watch says something in so many fields, and what it said last.
std::pair<unsigned, watch_event_t> said(Fields& f, unsigned fields, double ppm) {
  std::pair<unsigned, watch_event_t> out{0, WATCH_NOTHING};
  for (unsigned n = 0; n < fields; ++n)
    if (const auto e = f.next(0, ppm); e != WATCH_NOTHING) out = {out.first + 1, e};
  return out;
}
using Said = std::pair<unsigned, watch_event_t>;

TEST(FieldWatchTest, AClockThatIsOffIsSaidOnceAndSoIsOneThatIsRightAgain) {
  for (const bool is_625 : {true, false})
    for (const double sign : {-1.0, 1.0}) {
      Fields f(is_625);
      EXPECT_EQ(said(f, 1 + FIELD_DRIFT_FIELDS, sign * 199), Said(0, WATCH_NOTHING));
      EXPECT_NEAR(f.watch.camera[0].ppm, sign * 199, 1);
      EXPECT_EQ(said(f, FIELD_DRIFT_FIELDS - 1, sign * 202), Said(0, WATCH_NOTHING));
      EXPECT_EQ(said(f, 1, sign * 202), Said(1, WATCH_CLOCK_OFF)) << "after a second";
      EXPECT_EQ(said(f, 4 * FIELD_DRIFT_FIELDS, sign * 182), Said(0, WATCH_NOTHING));
      EXPECT_EQ(said(f, FIELD_DRIFT_FIELDS, sign * 178), Said(1, WATCH_CLOCK_RIGHT));
      EXPECT_EQ(said(f, 2 * FIELD_DRIFT_FIELDS, 0), Said(0, WATCH_NOTHING));
      EXPECT_FALSE(f.watch.irregular);
    }
}

}  // namespace
