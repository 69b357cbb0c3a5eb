// The log of register accesses: names from the declarations, pattern, ring, warnings.
#include "sw/fovea/tools/register_log.h"

#include <gtest/gtest.h>

#include "model/common/check.h"

namespace fovea::app {
namespace {

struct Bank : RegBank {
  struct Ctrl : Reg {
    using Reg::Reg;
    Field go{*this, "GO", 0, 1, Mode::kRw, "start"};
    Field mode{*this, "MODE", 8, 3, Mode::kRw, "what"};
  } ctrl{*this, "CTRL", 0x00, "control", 0x8000'0000};
  Reg data{*this, "DATA", 0x08, Mode::kRw, "data"};
  Bank() : RegBank("BANK") {}
};

struct RegisterLogTest : testing::Test {
  Bank one, two;
  RegisterObserver* seen_one = nullptr;
  RegisterObserver* seen_two = nullptr;
  static std::function<Subscription(RegisterObserver&)> seen_by(RegisterObserver*& one) {
    return [&one](RegisterObserver& o) {
      one = &o;
      return Subscription([&one] { one = nullptr; });
    };
  }
  Picoseconds now = 0;
  Master master = Master::kArmD;
  RegisterLog log{{{"one", &one, nullptr, seen_by(seen_one)},
                   {"two", &two, nullptr, seen_by(seen_two)}},
                  {[this] { return now += 1'000; }, [this] { return master; },
                   [] { return 0x8000u; }, [](std::uint32_t) { return std::string("main+0x4"); }}};
  void access(std::uint32_t offset, unsigned bytes, bool write, std::uint32_t value,
              bool gated = false) {
    seen_one->accessed({&one, one.register_at(offset), offset, bytes, write, gated, value});
  }
};

TEST_F(RegisterLogTest, NamesFieldsAndWarnings) {
  EXPECT_EQ(seen_one, nullptr) << "no observer before the start";
  log.start({.pattern = "."});
  access(0, 4, true, 0x8000'0701);
  access(1, 1, true, 0x0D);
  access(8, 4, false, 0x1234);
  access(8, 2, true, 5, true);
  access(0x20, 4, false, 0);
  master = Master::kEdmaTc0Read;
  access(8, 4, false, 7);
  EXPECT_EQ(
      log.text(),
      "1.000 ns  pc 0x00008000 (main+0x4) arm_d wrote one.CTRL = 0x80000701 GO=1 MODE=7\n"
      "2.000 ns  pc 0x00008000 (main+0x4) arm_d wrote one.CTRL byte 1 = 0x0d MODE=5  reserved "
      "bits 0x00000800\n"
      "3.000 ns  pc 0x00008000 (main+0x4) arm_d read one.DATA = 0x00001234\n"
      "4.000 ns  pc 0x00008000 (main+0x4) arm_d wrote one.DATA byte 0-1 = 0x0005  clock gated\n"
      "5.000 ns  pc 0x00008000 (main+0x4) arm_d read one.0x20 (no register) = 0x00000000\n"
      "6.000 ns  edma_tc0_read read one.DATA = 0x00000007\n");
}

TEST_F(RegisterLogTest, TakesWhatMatches) {
  log.start({.pattern = "^one\\.D|two"});
  access(0, 4, true, 1);
  access(8, 4, true, 2);
  seen_two->accessed({&two, &two.ctrl, 0, 4, true, false, 3});
  EXPECT_EQ(log.text(),
            "1.000 ns  pc 0x00008000 (main+0x4) arm_d wrote one.DATA = 0x00000002\n"
            "2.000 ns  pc 0x00008000 (main+0x4) arm_d wrote two.CTRL = 0x00000003 GO=1 "
            "MODE=0  reserved bits 0x00000002\n");
  EXPECT_THROW(log.start({.pattern = "(open"}), UserError);
  EXPECT_TRUE(log.running()) << "what ran before runs on";
  log.stop();
  EXPECT_EQ(seen_one, nullptr);
}

TEST_F(RegisterLogTest, TheRingKeepsTheLast) {
  log.start({.pattern = "DATA", .kept = 3});
  for (std::uint32_t k = 0; k < 8; ++k) access(8, 4, true, k);
  EXPECT_EQ(log.text(),
            "(5 earlier accesses are not shown)\n"
            "6.000 ns  pc 0x00008000 (main+0x4) arm_d wrote one.DATA = 0x00000005\n"
            "7.000 ns  pc 0x00008000 (main+0x4) arm_d wrote one.DATA = 0x00000006\n"
            "8.000 ns  pc 0x00008000 (main+0x4) arm_d wrote one.DATA = 0x00000007\n");
  EXPECT_EQ(log.text(1),
            "(7 earlier accesses are not shown)\n"
            "8.000 ns  pc 0x00008000 (main+0x4) arm_d wrote one.DATA = 0x00000007\n");
}

// A loop that waits: one entry, whatever a handler did in between is one of its own.
TEST_F(RegisterLogTest, WhatFollowsItselfIsOneLine) {
  log.start({.pattern = ".", .kept = 3});
  for (int i = 0; i < 1000; ++i) access(8, 4, false, 0);
  access(8, 4, false, 1);
  access(8, 4, false, 0);
  access(8, 4, false, 0, true);
  access(8, 4, false, 0, true);
  EXPECT_EQ(log.text(),
            "(1000 earlier accesses are not shown)\n"
            "1001.000 ns  pc 0x00008000 (main+0x4) arm_d read one.DATA = 0x00000001\n"
            "1002.000 ns  pc 0x00008000 (main+0x4) arm_d read one.DATA = 0x00000000\n"
            "1003.000 ns  pc 0x00008000 (main+0x4) arm_d read one.DATA = 0x00000000  clock gated  2 times, the last at "
            "1004.000 ns\n");
  log.start({.pattern = "."});
  for (int i = 0; i < 3; ++i) access(8, 4, false, 0);
  master = Master::kEdmaTc0Read;
  access(8, 4, false, 0);
  EXPECT_EQ(log.text(1), "(3 earlier accesses are not shown)\n1008.000 ns  edma_tc0_read read one.DATA = 0x00000000\n");
}

TEST_F(RegisterLogTest, APatternThatMatchesNothingIsRefused) {
  log.start({.pattern = "DATA"});
  for (const char* nothing : {"^ONE", "nosuch", "one\\.CTRLS", "^one\\.0x8$"}) {
    try {
      log.start({.pattern = nothing});
      ADD_FAILURE() << nothing;
    } catch (const UserError& e) {
      EXPECT_EQ(e.what(), "'" + std::string(nothing) +
                              "' matches no register; names are BLOCK.REGISTER, and the blocks are one, two");
    }
  }
  access(8, 4, false, 0);
  EXPECT_EQ(log.text().find("1.000 ns"), 0u) << "what ran before runs on";
}

TEST_F(RegisterLogTest, TheRingsSizeChangesWithWhatItHolds) {
  const auto values = [this] {
    std::string out, text = log.text();
    for (std::size_t at = 0; (at = text.find("= 0x0000000", at)) != std::string::npos; at += 12)
      out += text[at + 11];
    return out;
  };
  log.keep(3);
  log.start({.pattern = "DATA", .kept = log.kept()});
  for (std::uint32_t k = 1; k < 6; ++k) access(8, 4, true, k);
  EXPECT_EQ(values(), "345");
  log.keep(4);
  EXPECT_EQ(values(), "345");
  access(8, 4, true, 6);
  access(8, 4, true, 7);
  EXPECT_EQ(values(), "4567");
  log.keep(2);
  EXPECT_EQ(values(), "67");
  access(8, 4, true, 8);
  access(8, 4, true, 9);
  access(8, 4, true, 1);
  EXPECT_EQ(values(), "91");
  EXPECT_EQ(log.text().find("(8 earlier accesses"), 0u) << log.text();
}

}  // namespace
}  // namespace fovea::app
