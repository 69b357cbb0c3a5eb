// The recorder with hand-made events: what releases each record that it writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tb/replay/recorder_feed.h"

namespace fovea::replay {
namespace {

TEST(RecorderCoreTest, AReadIsFollowedByItsOwnWork) {
  Feed f;
  f.read(100, 102, 120, 130);
  f.read(141, 142, 160, 168);
  f.store(171, 172, 180);
  const auto r = f.records();
  ASSERT_EQ(r.size(), 3u);
  EXPECT_EQ(r[0].release, Release::kAt);
  EXPECT_EQ(r[0].at, 102 * kClock) << "nothing before it is known";
  expect(r[1], {Release::kAfter, true, 1, 0, 21}, "from the word at 120, to the clock it asked at");
  expect(r[2], {Release::kAfter, true, 1, 0, 11}, "from the word at 160");
}

// What the port makes of it does not matter: a store that waits for it has the clock of the store.
TEST(RecorderCoreTest, StoresFollowEachOtherAsTheProgramGaveThem) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.store(131, 132, 150);
  f.store(135, 150, 170);
  f.store(138, 170, 190);
  const auto r = f.records();
  expect(r[1], {Release::kAfter, true, 1, 0, 11}, "from the word");
  expect(r[2], {Release::kAfter, true, 1, 0, 4}, "from the store before, not from its end");
  expect(r[3], {Release::kAfter, true, 1, 0, 3}, "and again");
}

// The bursts of one store have one clock.
TEST(RecorderCoreTest, BurstsOfAStoreAreReleasedTogether) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.store(131, 132, 150, 16);
  f.store(131, 150, 160, 4);
  f.store(131, 160, 170, 4);
  const auto r = f.records();
  expect(r[2], {Release::kAfter, true, 1, 0, 0}, "with the first burst");
  expect(r[3], {Release::kAfter, true, 2, 0, 0}, "with the first burst");
}

// A read goes before the stores in the buffer: one that was there earlier does not wait for its word.
TEST(RecorderCoreTest, AStoreThatAReadHasPassedKeepsItsPlace) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.store(131, 132, 150);       // under way when
  f.read(140, 150, 170, 180);   // this is asked for; 134 and 140 wait in the buffer
  f.store(134, 180, 190);
  f.store(140, 190, 200);
  f.store(183, 200, 210);
  const auto r = f.records();
  expect(r[2], {Release::kAfter, true, 1, 0, 9}, "from the store at 131");
  expect(r[3], {Release::kAfter, true, 2, 0, 3}, "from the store at 131");
  expect(r[4], {Release::kAfter, true, 1, 0, 6}, "asked in the read's clock: before it");
  expect(r[5], {Release::kAfter, true, 3, 0, 13}, "from the word at 170");
}

// The clocks that the core waited for room are no work: what made them stands in `room`.
TEST(RecorderCoreTest, WaitsForRoomAreNoWork) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.core.room_waits = 7;  // it stood at clock 147 when it asked with 140
  f.read(140, 148, 160, 168);
  f.core.room_waits = 20;
  f.store(164, 184, 190);
  const auto r = f.records();
  expect(r[1], {Release::kAfter, true, 1, 0, 20}, "140 less the word's 120");
  expect(r[2], {Release::kAfter, true, 1, 0, 11}, "164 less the word's 160 - 7");
}

// The core counts from its reset on, through changes of its clock, and so do its waits.
TEST(RecorderCoreTest, ItsClocksCountFromTheStartOfItsClock) {
  Feed f;
  f.core.origin = 1'000;
  f.core.room_waits = 5'000;  // at the opening
  f.open(0);
  const std::uint64_t before = 1'000 - 5'000;  // of clock 0; unsigned, as the core's own
  f.read(before + 100, 100, 120, 130);
  f.core.room_waits += 4;
  f.store(before + 131, 136, 150);
  f.store(before + 135, 150, 170);
  const auto r = f.records();
  expect(r[1], {Release::kAfter, true, 1, 0, 11}, "from the word");
  expect(r[2], {Release::kAfter, true, 1, 0, 4}, "from the store before");
}

TEST(RecorderCoreTest, FourStoresFillTheBuffer) {
  Feed f;
  f.read(100, 100, 120, 130);
  for (unsigned n = 0; n < 6; ++n) f.store(131 + n, 132 + 20 * n, 150 + 20 * n);
  const auto r = f.records();
  for (unsigned n = 1; n <= 4; ++n) EXPECT_EQ(r[n].room, 0u) << n;
  EXPECT_EQ(r[5].room, 4u) << "the first must be out";
  EXPECT_EQ(r[6].room, 4u) << "the second";
}

TEST(RecorderCoreTest, SixteenWordsFillTheBuffer) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.store(131, 132, 140, 32);
  f.store(132, 140, 150, 16);  // seven words: 4, 1, 1, 1
  for (unsigned n = 0; n < 3; ++n) f.store(132, 150 + 10 * n, 160 + 10 * n, 4);
  f.store(133, 180, 190, 2);   // the sixteenth
  f.store(134, 190, 200, 4);
  const auto r = f.records();
  ASSERT_EQ(r.size(), 8u);
  for (unsigned n = 1; n <= 6; ++n) EXPECT_EQ(r[n].room, 0u) << n;
  EXPECT_EQ(r[7].room, 6u) << "the eight words";
}

// Room is asked for once, for all bursts of a store.
TEST(RecorderCoreTest, AStoreOfSeveralBurstsAsksForRoomAtItsFirst) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.store(131, 132, 140, 32);
  f.store(132, 140, 150, 16);
  f.store(133, 150, 160, 16);
  f.store(133, 160, 170, 4);   // with it seventeen words
  const auto r = f.records();
  EXPECT_EQ(r[3].room, 2u);
  EXPECT_EQ(r[4].room, 0u);
}

TEST(RecorderCoreTest, TheVictimBufferHasOnePlace) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.core.victim = true;
  f.store(131, 132, 150, 32);
  f.core.victim = false;
  for (unsigned n = 0; n < 4; ++n) f.store(140 + n, 150 + 10 * n, 160 + 10 * n);
  f.core.victim = true;
  f.store(150, 190, 200, 32);
  const auto r = f.records();
  EXPECT_EQ(r[1].room, 0u);
  EXPECT_EQ(r[5].room, 0u) << "a victim takes no place of the write buffer";
  EXPECT_EQ(r[6].room, 5u) << "the victim before";
}

// After a drain the core goes on with the end of the last write.
TEST(RecorderCoreTest, ADrainIsFollowedFromTheLastEnd) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.store(131, 132, 150);
  f.core.drains = 1;
  f.store(163, 164, 180);
  f.store(170, 180, 190);
  f.read(172, 190, 200, 208);
  f.core.drains = 2;
  f.read(225, 226, 240, 248);
  const auto r = f.records();
  expect(r[2], {Release::kAfter, false, 1, 0, 13}, "from the end at 150");
  expect(r[3], {Release::kAfter, true, 1, 0, 7}, "as ever");
  expect(r[5], {Release::kAfter, true, 1, 0, 25}, "the last was a read: from its word, 200");
}

// A register access that the program waits for is a record like any other.
TEST(RecorderCoreTest, ARegisterAccessIsARecord) {
  for (const bool write : {false, true}) {
    Feed f;
    f.read(100, 100, 120, 130);
    f.store(131, 132, 150);
    f.reg(write, 152, 160);
    f.store(163, 164, 180);
    f.reg(false, 190, 200);
    f.read(230, 230, 240, 248);
    const auto r = f.records();
    ASSERT_EQ(r.size(), 6u);
    for (const std::size_t n : {2u, 4u}) {
      EXPECT_EQ(r[n].kind, trace::Kind::kAside);
      EXPECT_EQ(r[n].write, write && n == 2);
    }
    expect(r[2], {Release::kAfter, false, 1, 0, 2}, "from the store's end");
    expect(r[3], {Release::kAfter, !write, 1, 0, 3}, "from its end");
    expect(r[4], {Release::kAfter, false, 1, 0, 10}, "from the store's end");
    expect(r[5], {Release::kAfter, true, 1, 0, 30}, "from its end");
  }
}

// Looks at one register, one behind the other, are a loop from the ninth on: that is not recorded.
TEST(RecorderCoreTest, ALoopOfLooksIsNotRecorded) {
  for (const unsigned looks : {8u, 9u, 20u}) {
    Feed f;
    for (unsigned n = 0; n < looks; ++n) f.reg(false, 100 + 10 * n, 106 + 10 * n, n > 0);
    f.read(400, 400, 410, 418);
    const auto r = f.records();
    ASSERT_EQ(r.size(), 9u) << looks;
    EXPECT_EQ(r[7].kind, trace::Kind::kAside);
    expect(r[8], {Release::kAfter, true, 1, 0, 400 - 176}, "from the eighth look's end");
  }
}

// Registers of others are not the core's.
TEST(RecorderCoreTest, ARegisterAccessOfAnotherMasterIsNoDrain) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.store(131, 132, 150);
  f.put(Master::kVpbe, false, 152 * kClock, 4, false);
  f.store(163, 164, 180);
  expect(f.records()[2], {Release::kAfter, true, 1, 0, 32}, "from the store before");
}

// The program stands at a write that no buffer takes.
TEST(RecorderCoreTest, AnUnbufferedWriteIsWaitedFor) {
  Feed f;
  f.core.room_waits = 5;
  f.read(95, 100, 120, 130);
  f.store(0, 140, 160);
  f.store(166, 172, 180);  // at clock 171
  const auto r = f.records();
  expect(r[1], {Release::kAfter, true, 1, 0, 20}, "from the word to the clock at which it went out");
  expect(r[2], {Release::kAfter, false, 1, 0, 11}, "from its end");
}

TEST(RecorderCoreTest, TheSleeperIsWokenByTheInterrupt) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.recorder().interrupt(400 * kClock);
  f.recorder().interrupt(500 * kClock);
  f.core.idle = 340;
  f.read(520, 520, 540, 548);
  f.core.idle = 340;
  f.read(550, 550, 560, 568);
  const auto r = f.records();
  ASSERT_EQ(r.size(), 3u);
  expect(r[1], {Release::kWhen, true, 1, 0, 40}, "520 - 120, less 340 of sleep, 20 after it");
  EXPECT_EQ(r[1].event, 1u) << "the last that came";
  EXPECT_EQ(r[1].source, trace::kInterrupt);
  EXPECT_EQ(r[1].wake_gap, 20u);
  expect(r[2], {Release::kAfter, true, 1, 0, 10}, "awake");
}

// Before it slept the core saw its writes out.
TEST(RecorderCoreTest, TheSleeperWaitedForItsWrites) {
  for (const bool by_drain : {false, true}) {
    Feed f;
    f.read(100, 100, 120, 130);
    f.store(131, 132, 150);
    f.recorder().interrupt(500 * kClock);
    f.core.idle = 300;
    ++(by_drain ? f.core.drains : f.core.room_waits);
    f.read(509, 510, 540, 548);
    expect(f.records()[2], {Release::kWhen, false, 1, 0, 50}, "from the end at 150");
  }
}

TEST(RecorderCoreTest, AnInterruptToComeEndsNoSleep) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.recorder().interrupt(522 * kClock);
  f.core.idle = 300;
  f.read(520, 520, 540, 548);
  EXPECT_EQ(f.records()[1].release, Release::kAfter);
}

TEST(RecorderCoreTest, MarksFollowTheLastRequest) {
  Feed f;
  f.read(100, 100, 120, 130);
  f.recorder().mark(7, 141 * kClock);
  f.store(150, 150, 160);
  f.recorder().mark(9, 171 * kClock);
  const auto r = f.records();
  ASSERT_EQ(r.size(), 4u);
  EXPECT_EQ(r[1].kind, trace::Kind::kMark);
  EXPECT_EQ(r[1].address, 7u);
  expect(r[1], {Release::kAfter, true, 1, 0, 20}, "from the word, in whole AHB clocks");
  expect(r[3], {Release::kAfter, false, 1, 0, 10}, "from the end of the store");
}

TEST(RecorderCoreTest, OffTheBusClockItCountsItsOwn) {
  for (const std::uint64_t second : {141u, 142u}) {
    Feed f;
    f.read(100, 100, 120, 130);
    f.read(140, second, 160, 168);
    const trace::StreamInfo s = f.info(1'000'000'000).streams[0];
    EXPECT_EQ(s.align, second % 2 ? 1u : 2u);
    EXPECT_EQ(s.phase, 0u);
  }
}

TEST(RecorderTest, WhatLiesOutsideIsLeftOut) {
  Feed f(Picoseconds{1'000'000});
  MemRequest& before = f.put(Master::kVpfe, true, 999'999);
  MemRequest& in = f.put(Master::kVpfe, true, 1'000'000);
  MemRequest& failed = f.put(Master::kVpfe, true, 1'500'000);
  MemRequest& last = f.put(Master::kVpfe, true, 1'999'999);
  MemRequest& after = f.put(Master::kVpfe, true, 2'000'000);
  MemRequest& unfinished = f.put(Master::kVpfe, true, 1'999'998);
  (void)unfinished;
  for (MemRequest* r : {&before, &in, &last, &after}) f.end(*r, 3'000'000, 3'000'000);
  f.end(failed, 3'000'000, 3'000'000, true);
  const auto r = f.records(1, 2'000'000);
  ASSERT_EQ(r.size(), 2u);
  EXPECT_EQ(r[0].at, 1'000'000u);
  EXPECT_EQ(r[1].at, 1'999'999u);
}

TEST(RecorderTest, InterruptsAreThoseOfTheRecording) {
  Feed f(Picoseconds{1'000});
  f.recorder().interrupt(1'999);
  f.recorder().interrupt(2'000);
  EXPECT_EQ(f.info(2'000).interrupts, std::vector<trace::Interrupt>{{1'999}});
}

// A display has two places: what goes out when another's last beat comes has taken its place.
TEST(RecorderTest, ALinesBurstsTakeEachOthersPlaces) {
  Feed f;
  MemRequest& a = f.put(Master::kVpbe, false, 10'000, 64);
  MemRequest& b = f.put(Master::kVpbe, false, 10'000, 64);
  f.end(a, 40'000, 50'000);
  MemRequest& c = f.put(Master::kVpbe, false, 50'000, 64);
  f.end(b, 45'000, 60'000);
  MemRequest& d = f.put(Master::kVpbe, false, 60'001, 64);
  f.end(c, 70'000, 80'000);
  f.end(d, 75'000, 80'000);
  MemRequest& e = f.put(Master::kVpbe, false, 80'000, 64);
  MemRequest& g = f.put(Master::kVpbe, false, 80'000, 64);
  MemRequest& h = f.put(Master::kVpbe, false, 80'000, 64);
  for (MemRequest* r : {&e, &g, &h}) f.end(*r, 90'000, 95'000);
  const auto r = f.records(2);
  ASSERT_EQ(r.size(), 7u);
  EXPECT_EQ(r[0].release, Release::kAt);
  EXPECT_EQ(r[1].release, Release::kAt);
  expect(r[2], {Release::kAfter, false, 2, 0, 0}, "in the first's place");
  EXPECT_EQ(r[3].release, Release::kAt) << "a picosecond late: of its own";
  expect(r[4], {Release::kAfter, false, 2, 0, 0}, "c");
  expect(r[5], {Release::kAfter, false, 2, 0, 0}, "d: each place is taken once");
  EXPECT_EQ(r[6].release, Release::kAt) << "no place is left";
}

// A load asks again after the latest completion of either side; of equals, its partner's and the first.
TEST(RecorderTest, ALoadRepeatsAfterTheLatestCompletion) {
  Feed f(copy_of(Pace::kRepeating));
  MemRequest& a = f.put(edma_read(0), false, 10'000, 64);
  MemRequest& b = f.put(edma_read(0), false, 10'000, 64);
  MemRequest& w = f.put(edma_write(0), true, 10'000, 64);
  f.end(a, 20'000, 30'000);
  f.end(b, 20'000, 30'000);
  MemRequest& c = f.put(edma_read(0), false, 31'500, 64);  // two of its own at 30000
  f.end(w, 30'000, 30'000);
  MemRequest& d = f.put(edma_read(0), false, 33'000, 64);  // and its partner's at the same time
  f.end(c, 40'000, 50'000);
  MemRequest& e = f.put(edma_read(0), false, 49'999, 64);  // c ends a picosecond later
  MemRequest& g = f.put(edma_read(0), false, 50'000, 64);
  for (MemRequest* r : {&d, &e, &g}) f.end(*r, 60'000, 60'000);
  const auto r = f.records(1);
  ASSERT_EQ(r.size(), 6u);
  EXPECT_EQ(r[0].release, Release::kAt);
  expect(r[2], {Release::kAfter, false, 2, 0, 1'500}, "the first of two that ended together");
  EXPECT_EQ(r[3].release, Release::kWhen) << "the partner's";
  EXPECT_EQ(r[3].source, 2u);
  EXPECT_EQ(r[3].event, 0u);
  EXPECT_EQ(r[3].wake_gap, 3'000u);
  EXPECT_EQ(r[4].release, Release::kWhen);
  EXPECT_EQ(r[4].wake_gap, 19'999u);
  expect(r[5], {Release::kAfter, false, 3, 0, 0}, "its own is the later one");
}

// The gap behind a partner's completion has 32 bits.
TEST(RecorderTest, APartnersCompletionIsRememberedFor32Bits) {
  for (const Picoseconds late : {0xFFFF'FFFFull, 0x1'0000'0000ull}) {
    Feed f(copy_of(Pace::kRepeating));
    f.end(f.put(edma_write(0), true, 10'000, 64), 20'000, 20'000);
    f.end(f.put(edma_write(0), true, 10'000, 64), 30'000, 30'000);
    f.end(f.put(edma_read(0), false, 30'000 + late, 64), 30'000 + late, 40'000 + late);
    const auto r = f.records(1, 10'000'000'000);
    ASSERT_EQ(r.size(), 1u);
    if (late >> 32) {
      EXPECT_EQ(r[0].release, Release::kAt);
      EXPECT_EQ(r[0].at, 30'000 + late);
    } else {
      EXPECT_EQ(r[0].release, Release::kWhen);
      EXPECT_EQ(r[0].event, 1u) << "the second of the partner's";
      EXPECT_EQ(r[0].wake_gap, late);
    }
  }
}

TEST(RecorderTest, EachReadReleasesOneWriteOfACopy) {
  Feed f(copy_of(Pace::kData));
  MemRequest& a = f.put(edma_read(0), false, 10'000, 64);
  MemRequest& b = f.put(edma_read(0), false, 10'000, 64);
  f.end(a, 20'000, 30'000);
  f.end(b, 20'000, 30'000);
  std::vector<MemRequest*> writes;
  for (unsigned n = 0; n < 3; ++n) writes.push_back(&f.put(edma_write(0), true, 30'000, 64));
  MemRequest& c = f.put(edma_read(0), false, 31'000, 64);
  f.end(c, 40'000, 50'000);
  writes.push_back(&f.put(edma_write(0), true, 50'001, 64));
  for (MemRequest* w : writes) f.end(*w, 60'000, 60'000);
  const auto r = f.records(2);
  ASSERT_EQ(r.size(), 4u);
  for (unsigned n = 0; n < 2; ++n) {
    EXPECT_EQ(r[n].release, Release::kWhen);
    EXPECT_EQ(r[n].source, 1u);
    EXPECT_EQ(r[n].event, n);
    EXPECT_EQ(r[n].wake_gap, 0u);
  }
  EXPECT_EQ(r[2].release, Release::kAt) << "both reads have had their write";
  EXPECT_EQ(r[3].release, Release::kAt) << "a picosecond behind its data";
}

}  // namespace
}  // namespace fovea::replay
