// The recorder with hand-made transfers of the EDMA: what the core and they wait for, and when a recording begins.
#include <gtest/gtest.h>

#include "tb/replay/recorder_feed.h"

namespace fovea::replay {
namespace {

std::vector<BusRecorder::MasterSetup> core_and_edma() {
  return {{Master::kArmD, Pace::kCore, 1, 1, true},
          {edma_read(0), Pace::kTransfers, 4, 4, true, edma_write(0)},
          {edma_write(0), Pace::kTransfers, 4, 4, true, edma_read(0)}};
}

trace::Surroundings with_edma(trace::Surroundings s) {
  s.edma = {8, 128, 4, 2, 1, 40'000};
  return s;
}

class TransferFeed : public Feed {
 public:
  explicit TransferFeed(trace::Surroundings surroundings = {})
      : Feed(core_and_edma(), with_edma(std::move(surroundings))) {}

  /// A transfer is submitted at a hardware event.
  void transfer(std::uint64_t number, std::uint64_t clock) {
    TransferRequest t;
    t.acnt = t.bcnt = 4;
    t.number = number;
    recorder().requested(t, {}, 32, clock * kClock, clock * kClock);
  }
  /// Its last write is acknowledged, and its code sets a bit of IPR.
  void end_of(std::uint64_t number, std::uint64_t clock) {
    recorder().coded({.kind = TransferTrigger::Kind::kEnded, .number = number, .at = clock * kClock}, clock * kClock);
  }
  void interrupt_of(std::uint64_t number, std::uint64_t clock) {
    end_of(number, clock);
    recorder().completion_pulsed(clock * kClock);
    recorder().interrupt(clock * kClock);
  }
  /// After a read, the first of so many transfers wakes the core, which begins to serve its interrupt.
  void first_of(unsigned transfers) {
    read(100, 100, 120, 130);
    for (unsigned n = 0; n < transfers; ++n) transfer(n, 200 + 10 * n);
    interrupt_of(0, 300);
    sleep(150, 302);
    reg(false, 310, 316);
  }
  /// The core slept for so many clocks more, until `clock`.
  void sleep(std::uint64_t clocks, std::uint64_t clock) {
    core.idle += clocks;
    core.woke = clock;
  }
};

void expect_wait(const Record& r, std::uint64_t event, std::uint64_t gap, const char* what) {
  EXPECT_EQ(r.kind, trace::Kind::kStep) << what;
  EXPECT_EQ(r.release, Release::kWhen) << what;
  EXPECT_EQ(r.source, trace::kInterrupt) << what;
  EXPECT_EQ(r.event, event) << what;
  EXPECT_EQ(r.gap, gap) << what;
}

// Handlers whose code and data are in the caches make no request to the SDRAM: each sleep is there all the same.
TEST(RecorderTransferTest, EachSleepIsAStep) {
  TransferFeed f;
  f.first_of(2);
  f.interrupt_of(1, 500);
  f.sleep(140, 503);
  f.reg(true, 510, 516);
  f.read(520, 520, 530, 538);
  const auto r = f.records();
  ASSERT_EQ(r.size(), 6u);
  expect_wait(r[1], 0, 302 - 120 - 150, "the work before the first sleep");
  EXPECT_EQ(r[1].wake_gap, 2u);
  EXPECT_EQ(r[2].kind, trace::Kind::kAside);
  expect_wait(r[3], 1, 503 - 316 - 140, "and before the second one");
  EXPECT_EQ(r[3].wake_gap, 3u);
  EXPECT_EQ(r[5].kind, trace::Kind::kRequest);
}

// A transfer that ends while the core serves another interrupt would be slept for if it ended later.
TEST(RecorderTransferTest, WhatEndsWhileAnInterruptIsServedIsWaitedFor) {
  TransferFeed f;
  f.first_of(3);
  f.interrupt_of(1, 320);
  f.end_of(2, 322);  // while the first one's interrupt is pending, the line does not rise again
  f.reg(true, 330, 336);
  const auto r = f.records();
  ASSERT_EQ(r.size(), 6u);
  expect_wait(r[1], 0, 302 - 120 - 150, "the sleep");
  expect_wait(r[3], 1, 330 - 316, "the work up to the access that may see it");
  expect_wait(r[4], 2, 0, "the third one");
  EXPECT_EQ(r[3].wake_gap, 0u);
  EXPECT_EQ(r[5].kind, trace::Kind::kAside);
  const auto interrupts = f.info(1'000'000'000).interrupts;
  ASSERT_EQ(interrupts.size(), 3u);
  for (std::uint64_t n = 0; n < 3; ++n) {
    EXPECT_EQ(interrupts[n].source, 1u);
    EXPECT_EQ(interrupts[n].event, n);
    EXPECT_EQ(interrupts[n].after, 0u);
  }
}

// A core that woke long ago is at work, and does not wait for what ends meanwhile.
TEST(RecorderTransferTest, ACoreAtWorkWaitsForNothingThatEnds) {
  for (const std::uint64_t awake : {4096u, 4097u}) {
    TransferFeed f;
    f.first_of(2);
    f.end_of(1, 1'000);
    f.reg(true, 302 + awake, 302 + awake + 8);
    EXPECT_EQ(f.records().size(), awake == 4096 ? 5u : 4u) << awake;
  }
}

// A transfer of which a part came before the window would be played in part.
TEST(RecorderTransferTest, ARecordingBeginsWhenNoTransferIsUnderWay) {
  bool under_way = true;
  trace::Surroundings surroundings;
  surroundings.transfers_under_way = [&] { return under_way; };
  TransferFeed f(surroundings);
  f.read(100, 100, 120, 130);
  f.reg(false, 140, 150);
  under_way = false;
  f.read(200, 200, 220, 230);  // the core may be ahead of the kernel here
  f.reg(false, 240, 250);
  f.read(300, 300, 320, 330);
  EXPECT_EQ(f.records().size(), 2u);
  EXPECT_EQ(f.info(1'000'000'000).start, 240 * kClock);
}

TEST(RecorderTransferTest, ItDoesNotWaitForThatForEver) {
  trace::Surroundings surroundings;
  surroundings.transfers_under_way = [] { return true; };
  TransferFeed f(surroundings);
  const std::uint64_t latest = BusRecorder::kLongestDelay / kClock;
  f.read(latest - 1, latest - 1, latest, latest + 5);
  f.read(latest + 10, latest + 10, latest + 12, latest + 20);
  f.read(latest + 30, latest + 30, latest + 32, latest + 40);
  EXPECT_EQ(f.records(0, 30 * kPsPerMs).size(), 2u);
}

}  // namespace
}  // namespace fovea::replay
