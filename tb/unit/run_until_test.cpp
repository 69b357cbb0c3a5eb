// The syntax of end conditions, dialogues and limits.
#include "sw/fovea/config/run_until.h"

#include <gmock/gmock.h>

#include "model/common/check.h"
#include "sw/fovea/console/dialogue.h"
#include "sw/fovea/files/run_limits.h"

namespace fovea::app {
namespace {

using Kind = EndCondition::Kind;
using testing::HasSubstr;

std::vector<EndCondition> parse(const std::string& text) { return parse_run_until(text, Symbols()); }

std::string refused(const std::string& text) {
  try {
    parse(text);
  } catch (const UserError& e) {
    return e.what();
  }
  ADD_FAILURE() << text << " is taken";
  return "";
}

TEST(RunUntil, EveryConditionAlone) {
  EXPECT_EQ(parse("frames").at(0).kind, Kind::kFrames);
  EXPECT_EQ(parse("exit").at(0).kind, Kind::kExit);
  EXPECT_EQ(parse("halt").at(0).kind, Kind::kHalt);
  EXPECT_EQ(parse("reset").at(0).kind, Kind::kReset);
  EXPECT_EQ(parse("time:1500us").at(0).time, 1500 * kPsPerUs);
  EXPECT_EQ(parse("pc:0x80008001").at(0).address, 0x8000'8000u);  // Thumb's bit is no address
  EXPECT_EQ(parse("pc:32").at(0).address, 32u);
  EXPECT_EQ(parse("uart:login: ").at(0).text, "login:");
  EXPECT_EQ(parse("uart:a\\x20\\r\\n\\\\").at(0).text, "a \r\n\\");
}

TEST(RunUntil, ListsKeepTheirOrderAndCommasInQuotes) {
  const auto list = parse("[ uart:a , \"uart:b, \\\"c\\\"\",time:2s,halt]");
  ASSERT_EQ(list.size(), 4u);
  EXPECT_EQ(list[0].text, "a");
  EXPECT_EQ(list[1].text, "b, \"c\"");
  EXPECT_EQ(list[2].time, 2 * kPsPerSecond);
  EXPECT_EQ(list[2].written, "time:2s");
  EXPECT_EQ(list[3].kind, Kind::kHalt);
}

TEST(RunUntil, WhatIsWrongIsSaidWithWhatIsAllowed) {
  for (const char* text : {"", "[]", "frame", "time", "time:", "time:2", "time:-1s", "pc:", "pc:main",
                           "pc:0x123456789", "uart:", "uart:\\q", "uart:\\x1", "exit:0", "[exit",
                           "[exit,,halt]", "[\"exit]", "EXIT"})
    EXPECT_THAT(refused(text), HasSubstr("run.until")) << text;
  EXPECT_THAT(refused("frame"), HasSubstr("allowed: frames, time:2s, pc:main"));
  EXPECT_THAT(refused("pc:main"), HasSubstr("--symbols"));
}

TEST(RunUntil, WithoutAProgramOnlyItsSymbolsAreLeftOpen) {
  EXPECT_NO_THROW(check_run_until("[frames, pc:main, pc:main+0x10, time:2s]"));
  for (const char* text : {"frame", "pc:", "pc:main+x", "[exit,,halt]"})
    EXPECT_THROW(check_run_until(text), UserError) << text;
}

TEST(Escapes, AreTheirOwnReverse) {
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  EXPECT_EQ(unescape("test", escape(all)), all);
  EXPECT_EQ(escape("a\x01\r\n\\\x7f"), "a\\x01\\r\\n\\\\\\x7f");
}

TEST(Limits, TimeIsMetExactlyAndInstructionsWithinAMicrosecond) {
  RunLimits limits;
  EXPECT_EQ(limits.reached(kNever - 1, ~0ull - 1), "");
  limits.time = 7 * kPsPerMs;
  EXPECT_EQ(limits.next_slice(5 * kPsPerMs, 0, 0), 5 * kPsPerMs);
  EXPECT_EQ(limits.next_slice(5 * kPsPerMs, 5 * kPsPerMs, 0), 2 * kPsPerMs);
  EXPECT_EQ(limits.reached(7 * kPsPerMs - 1, 0), "");
  EXPECT_EQ(limits.reached(7 * kPsPerMs, 0), "--max-time");
  limits = {};
  limits.instructions = 1'000'000;
  EXPECT_EQ(limits.next_slice(kPsPerMs, 0, 0), kPsPerMs);
  EXPECT_EQ(limits.next_slice(kPsPerMs, 0, 600'000), 800 * kPsPerUs);
  EXPECT_EQ(limits.next_slice(kPsPerMs, 0, 999'999), kPsPerUs);
  EXPECT_EQ(limits.reached(0, 999'999), "");
  EXPECT_EQ(limits.reached(0, 1'000'000), "--max-instructions");
}

std::string typed(Dialogue& d, Picoseconds now) {
  std::string out;
  while (const auto byte = d.next(now)) out += static_cast<char>(*byte);
  return out;
}
void hear(Dialogue& d, const std::string& text) {
  for (const char c : text) d.received(static_cast<std::uint8_t>(c));
}

TEST(DialogueTest, WaitsSendsAndWaitsForATime) {
  Dialogue d = Dialogue::parse("f", "# comment\nwait login: \nsend root\\n\n\nwait #\nat 2ms\nsend x\n");
  EXPECT_EQ(typed(d, 0), "");
  hear(d, "login:");
  EXPECT_EQ(typed(d, 0), "");
  hear(d, " ");
  EXPECT_EQ(typed(d, 0), "root\n");
  EXPECT_EQ(d.position(), "f:5: wait #");
  EXPECT_FALSE(d.waits_until());
  hear(d, "motd #");
  EXPECT_EQ(d.waits_until(), 2 * kPsPerMs);
  EXPECT_EQ(typed(d, 2 * kPsPerMs - 1), "");
  EXPECT_EQ(typed(d, 2 * kPsPerMs), "x");
  EXPECT_TRUE(d.over());
  EXPECT_EQ(d.position(), "");
}

TEST(DialogueTest, HearsOnlySinceTheStepBefore) {
  Dialogue d = Dialogue::parse("f", "send a\nwait ok\nsend b\nwait ok\nsend c\n");
  hear(d, "ok");  // before anything was sent
  EXPECT_EQ(typed(d, 0), "a");
  hear(d, "oook");
  EXPECT_EQ(typed(d, 0), "b");
  EXPECT_EQ(typed(d, 0), "");
}

TEST(DialogueTest, WhatAPersonTypedTypesTheSameAgain) {
  const std::string keys("l\x03\r\\", 4);
  Dialogue d = Dialogue::parse("f", dialogue_lines(12'345, keys));
  EXPECT_EQ(typed(d, 12'344), "");
  EXPECT_EQ(typed(d, 12'345), keys);
}

TEST(DialogueTest, WrongStepsNameTheirLine) {
  for (const char* text : {"say a", "send", "wait ", "at 3", "at", "send \\q"}) {
    try {
      Dialogue::parse("f", std::string("send a\n") + text + "\n");
      ADD_FAILURE() << text << " is taken";
    } catch (const UserError& e) {
      EXPECT_THAT(e.what(), HasSubstr("f:2")) << text;
    }
  }
}

}  // namespace
}  // namespace fovea::app
