// The crossbar core: arbitration and latencies in edges of its clock, computed by hand.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tb/dram/bench.h"
#include "tb/dram/xbar_bench.h"

namespace fovea::dram {
namespace {

constexpr Master kA = Master::kVpfe, kB = Master::kVpbe, kC = Master::kRemapEngine;

std::string winners(const XbarBench& b) {
  std::string s;
  for (const Event& e : b.events) s += e.master == kA ? 'A' : e.master == kB ? 'B' : 'C';
  return s;
}

// Put on the port at edge 5, seen at 6, through the bridge in 2: arbitrated at 8. A read's command
// takes one edge.
TEST(CrossbarTest, RequestLatencyMovesTheGrantByItsEdges) {
  for (const unsigned latency : {0u, 2u, 3u, 16u}) {
    XbarBench b({{"bus.vpfe.request_latency", std::to_string(latency) + " cycles"}});
    b.submit(kA, 5);
    b.run();
    ASSERT_EQ(b.events.size(), 1u);
    EXPECT_EQ(b.events[0].granted, 6 + latency);
    EXPECT_EQ(b.events[0].arrival, 7 + latency);
  }
}

TEST(CrossbarTest, ResponseLatencyMovesReadDataAndAcknowledgeByItsEdges) {
  for (const unsigned latency : {0u, 2u, 3u}) {
    XbarBench b({{"bus.vpfe.response_latency", std::to_string(latency) + " cycles"}});
    b.submit(kA, 5);
    b.submit(kB, 5, true, 64);
    b.run();
    b.xbar.slave_done(b, *b.sent[0], {30 * kEdge, 37 * kEdge});
    b.xbar.slave_done(b, *b.sent[0], {40 * kEdge + 1, 40 * kEdge + 1, 0, true});
    ASSERT_EQ(b.answers.size(), 3u);
    EXPECT_EQ(b.answers[1].first, 30 + latency);
    EXPECT_EQ(b.answers[1].last, 37 + latency);
    EXPECT_FALSE(b.answers[1].error);
    EXPECT_EQ(b.answers[2].first, 41 + latency) << "between two edges: the next one";
    EXPECT_TRUE(b.answers[2].error);
    // The write of master B keeps its own latency of 2: granted at 9, after A; its eight words are
    // there at 17, acknowledged at 19.
    EXPECT_EQ(b.answers[0].first, 19u);
  }
}

// What registers answer comes back through the same bridge, a burst's last word as late as its first.
TEST(CrossbarTest, ResponseLatencyMovesTheAnswersOfRegistersByItsEdges) {
  for (const unsigned latency : {0u, 2u, 3u}) {
    XbarBench b({{"bus.vpfe.response_latency", std::to_string(latency) + " cycles"}});
    b.submit(kA, 5, false, 32, Slave::kConfig);
    b.run();
    b.xbar.slave_done(b, *b.sent[0], {30 * kEdge, 37 * kEdge + 1});
    ASSERT_EQ(b.answers.size(), 1u);
    EXPECT_EQ(b.answers[0].first, 30 + latency);
    EXPECT_EQ(b.answers[0].last, 38 + latency);
  }
}

// Who runs ahead of the crossbar relies on it: no request ends earlier. The quickest is a write of one beat without
// contention, issued 1 ps before an edge; 2 ps are for times that are rounded down.
TEST(CrossbarTest, TheLeastLatencyIsThatOfAWriteIssuedJustBeforeAnEdge) {
  for (const unsigned request : {0u, 2u, 5u})
    for (const unsigned response : {0u, 3u}) {
      XbarBench b({{"bus.vpfe.request_latency", std::to_string(request) + " cycles"},
                   {"bus.vpfe.response_latency", std::to_string(response) + " cycles"}});
      EXPECT_EQ(b.xbar.least_latency(kA), (request + 1 + response) * kEdge - 2) << request << ' ' << response;
      MemRequest write;
      write.master = kA;
      write.write = true;
      write.bytes = 8;
      write.issued = 6 * kEdge - 1;
      b.xbar.submit(write, Slave::kDdr);
      b.run();
      ASSERT_EQ(b.answers.size(), 1u);
      EXPECT_EQ(write.last - write.issued, b.xbar.least_latency(kA) + 3) << "at most 3 ps more";
    }
}
TEST(CrossbarTest, AStoppedClockHasNoLeastLatency) {
  XbarBench b;
  b.xbar.set_clock(Frequency(0), 0);
  EXPECT_EQ(b.xbar.least_latency(kA), 0u);
}

TEST(CrossbarTest, WriteOccupiesTheSlaveForItsWordsAndReadForOne) {
  for (const unsigned bytes : {4u, 8u, 16u, 64u}) {
    XbarBench b;
    b.submit(kA, 5, true, bytes);
    b.submit(kB, 5);
    b.submit(kC, 5);
    b.run();
    const std::uint64_t words = (bytes + 7) / 8;
    EXPECT_EQ(winners(b), "ABC");
    EXPECT_EQ(b.events[0].granted, 8u);
    EXPECT_EQ(b.events[0].arrival, 8 + words);
    EXPECT_EQ(b.events[1].granted, 8 + words);
    EXPECT_EQ(b.events[2].granted, 8 + words + 1);
  }
}

TEST(CrossbarTest, PriorityWinsWhateverTheOrderOfArrivalInTheInstant) {
  for (const bool a_first : {true, false}) {
    XbarBench b;
    b.xbar.set_priority(kA, 4);
    b.xbar.set_priority(kB, 1);
    if (a_first) b.submit(kA, 5);
    b.submit(kB, 5);
    if (!a_first) b.submit(kA, 5);
    b.run();
    EXPECT_EQ(winners(b), "BA");
    EXPECT_EQ(b.sent[0]->in_path.priority, 1) << "the slave sees the priority of the grant";
    EXPECT_EQ(b.sent[1]->in_path.priority, 4);
  }
}

// A burst is not broken up: the more urgent request waits for its end.
TEST(CrossbarTest, MoreUrgentRequestWaitsForTheBurstUnderWay) {
  XbarBench b;
  b.xbar.set_priority(kB, 0);
  b.submit(kA, 5, true, 64);
  b.submit(kA, 5, true, 64);
  b.run(9);
  b.submit(kB, 9);
  b.run();
  EXPECT_EQ(winners(b), "ABA");
  EXPECT_EQ(b.events[1].granted, 16u);
}

TEST(CrossbarTest, EqualPrioritiesTakeTurns) {
  XbarBench b;
  for (unsigned i = 0; i < 3; ++i)
    for (const Master m : {kA, kB, kC}) b.submit(m, 5);
  b.run();
  EXPECT_EQ(winners(b), "ABCABCABC");
  XbarBench c;  // starts behind the last one served
  c.submit(kB, 1);
  c.run();
  for (const Master m : {kA, kB, kC}) c.submit(m, 20);
  c.run();
  EXPECT_EQ(winners(c), "BCAB");
}

// Two slaves have a winner each at the same edge: these are granted by priority too, then by turn.
TEST(CrossbarTest, WinnersOfTwoSlavesAtOneEdgeAreGrantedByPriority) {
  const auto order = [](unsigned of_a, unsigned of_b) {
    XbarBench b;
    b.xbar.set_priority(kA, of_a);
    b.xbar.set_priority(kB, of_b);
    b.submit(kA, 5, false, 4, Slave::kConfig);
    b.submit(kB, 5);
    b.run();
    EXPECT_EQ(b.events.at(0).granted, b.events.at(1).granted);
    return winners(b);
  };
  EXPECT_EQ(order(4, 1), "BA");
  EXPECT_EQ(order(1, 4), "AB");
  EXPECT_EQ(order(2, 3), "AB");
  EXPECT_EQ(order(3, 2), "BA");
  EXPECT_EQ(order(3, 3), "AB") << "the lower number, as there is no last winner";
}

TEST(CrossbarTest, PriorityChangeActsOnTheNextArbitrationInEitherOrder) {
  for (const bool change_first : {true, false}) {
    XbarBench b;
    if (change_first) b.xbar.set_priority(kB, 0);
    b.submit(kA, 5);
    b.submit(kB, 5);
    if (!change_first) b.xbar.set_priority(kB, 0);
    b.run();
    EXPECT_EQ(winners(b), "BA");
  }
}

TEST(CrossbarTest, BlockedSlaveStopsItsRequestsAndTheirFollowersOnly) {
  XbarBench b;
  b.ddr_accepts = false;
  b.submit(kA, 5, true, 8);                   // granted to the DDR: 8, there at 9
  b.submit(kB, 5, false, 8);                  // waits for the DDR
  b.submit(kB, 5, false, 4, Slave::kConfig);  // waits behind its master's own head
  b.submit(kC, 5, false, 4, Slave::kConfig);  // goes
  b.run(50);
  ASSERT_EQ(b.events.size(), 2u);
  EXPECT_EQ(winners(b), "AC");
  EXPECT_EQ(b.events[1].slave, Slave::kConfig);
  EXPECT_TRUE(b.answers.empty()) << "no acknowledge before the slave has the write";
  b.ddr_accepts = true;
  b.xbar.slave_accepted(b, *b.sent[0], 49 * kEdge + 3, Master::kArmD);
  b.run();
  ASSERT_EQ(b.answers.size(), 1u);
  EXPECT_EQ(b.answers[0].first, 52u) << "taken before edge 50, two edges back";
  ASSERT_EQ(b.events.size(), 4u);
  EXPECT_EQ(b.events[2].granted, 50u);
  EXPECT_EQ(b.events[3].slave, Slave::kConfig);
  EXPECT_EQ(b.events[3].granted, 51u) << "the next in line shows itself one edge later";
}

// The DDR's decision that makes room may come before the write's last beat is there.
TEST(CrossbarTest, WriteIsNotAcknowledgedBeforeItsLastBeat) {
  XbarBench b;
  b.ddr_accepts = false;
  b.submit(kA, 5, true, 64);
  b.run();
  b.xbar.slave_accepted(b, *b.sent[0], 10 * kEdge, Master::kArmD);
  ASSERT_EQ(b.answers.size(), 1u);
  EXPECT_EQ(b.answers[0].first, 8u + 8u + 2u);
}

TEST(CrossbarTest, RefusedRequestIsAnsweredOnceWithAnError) {
  for (const bool write : {false, true}) {
    XbarBench b;
    b.refuses = true;
    b.submit(kA, 5, write, 8);
    b.run();
    ASSERT_EQ(b.answers.size(), 1u);
    EXPECT_TRUE(b.answers[0].error);
    EXPECT_EQ(b.answers[0].last, 8u + 1 + 2) << "granted at 8, there at 9, back in 2";
    b.refuses = false;
    b.submit(kA, 20, write, 8);
    b.run();
    ASSERT_EQ(b.events.size(), 2u) << "the slave is not blocked";
    EXPECT_EQ(b.events[1].granted, 23u);
  }
}

TEST(CrossbarTest, LockedReadKeepsTheSlaveUntilItsMastersNextRequest) {
  for (const bool locked : {false, true}) {
    XbarBench b;
    b.submit(kA, 5, false, 4, Slave::kDdr, locked);
    b.submit(kB, 5);
    b.submit(kC, 5, false, 4, Slave::kConfig);
    b.run();
    EXPECT_EQ(winners(b), locked ? "AC" : "ACB") << "the lock is the slave's own";
    b.submit(kA, 40, true, 4, Slave::kDdr, locked);
    b.submit(kA, 41);
    b.run();
    EXPECT_EQ(winners(b), locked ? "ACABA" : "ACBAA");
    if (locked) {
      EXPECT_EQ(b.events[3].granted, b.events[2].arrival) << "as soon as it is free";
    }
  }
}

// The same where the slave takes the read and finds the error later.
TEST(CrossbarTest, LockedReadThatFailsLateGivesTheSlaveFree) {
  XbarBench b;
  b.submit(kA, 5, false, 4, Slave::kConfig, true);
  b.submit(kB, 6, false, 4, Slave::kConfig);
  b.run();
  ASSERT_EQ(winners(b), "A");
  b.xbar.slave_done(b, *b.sent[0], {40 * kEdge, 40 * kEdge, 0, true});
  b.run();
  EXPECT_EQ(winners(b), "AB");
}

// The read of an SWP that ends in a bus error is not followed by a write: the slave is free for others.
TEST(CrossbarTest, LockedReadThatFailsGivesTheSlaveFree) {
  XbarBench b;
  b.refuses = true;
  b.submit(kA, 5, false, 4, Slave::kDdr, true);
  b.submit(kB, 6);
  b.run();
  ASSERT_EQ(winners(b), "AB");
  EXPECT_EQ(b.events[1].granted, b.events[0].arrival) << "as soon as it is free";
  ASSERT_EQ(b.answers.size(), 2u);
  EXPECT_TRUE(b.answers[0].error);
  b.refuses = false;
  b.submit(kC, 30);
  b.run();
  EXPECT_EQ(winners(b), "ABC");
}

// For every other master, whatever its number.
TEST(CrossbarTest, LockedReadThatFailsGivesTheSlaveToAnyMaster) {
  for (const MasterInfo& m : kMasters.rows) {
    if (m.id == kA) continue;
    XbarBench b;
    b.refuses = true;
    b.submit(kA, 5, false, 4, Slave::kDdr, true);
    b.submit(m.id, 6);
    b.run();
    EXPECT_EQ(b.events.size(), 2u) << m.name;
  }
}

// Video ports put requests on their port ahead of time; the clock may change before.
TEST(CrossbarTest, RequestToComeSeesTheEdgesAfterAClockChange) {
  XbarBench b;
  b.submit(kA, 50);  // 500 ns
  b.xbar.set_clock(Frequency(50'000'000), 10 * kEdge);  // edges every 20 ns from 100 ns on
  b.run();
  ASSERT_EQ(b.events.size(), 1u);
  EXPECT_EQ(b.events[0].granted, 56u) << "seen at 520, through the bridge in 2: 560 ns";
}

// All on their ports at 5, through the bridge at 8. A's write has the data bus from 8 to 16, B's read goes at
// 16, C's at 17, A's second request at 18: it is through the bridge at 8 as well.
TEST(CrossbarTest, WaitsAreTaggedWithTheMasterThatHadTheLane) {
  XbarBench b;
  b.xbar.set_priority(kB, 1);
  b.xbar.set_priority(kA, 0);
  b.submit(kA, 5, true, 64);
  b.xbar.set_priority(kC, 2);
  b.submit(kB, 5);
  b.submit(kC, 5);
  b.run(9);
  b.xbar.set_priority(kA, 3);
  b.submit(kA, 10, false, 8);
  b.run();
  ASSERT_EQ(winners(b), "ABCA");
  for (const Event& e : b.events) EXPECT_EQ(e.slave, Slave::kDdr);
  const auto edges = [](const Waits& w, Culprit c) { return w.ps[index(c)] / kEdge; };
  const auto sum = [](const Waits& w) {
    std::uint64_t t = 0;
    for (const auto ps : w.ps) t += ps;
    return t / kEdge;
  };
  const Waits& write = b.xbar.waits[index(kA)].write;
  EXPECT_EQ(edges(write, Culprit::kBridge), 3u + 2u) << "5 to 8, and the acknowledgement's 2";
  EXPECT_EQ(edges(write, Culprit::kService), 8u);
  EXPECT_EQ(sum(write), 18u - 5u);
  const Waits& first = b.xbar.waits[index(kB)].read;
  EXPECT_EQ(edges(first, Culprit::kBridge), 3u);
  EXPECT_EQ(edges(first, culprit(kA)), 8u);
  EXPECT_EQ(edges(first, Culprit::kService), 1u);
  EXPECT_EQ(sum(first), 17u - 5u);
  const Waits& second = b.xbar.waits[index(kC)].read;
  EXPECT_EQ(edges(second, culprit(kA)), 8u);
  EXPECT_EQ(edges(second, culprit(kB)), 1u);
  EXPECT_EQ(sum(second), 18u - 5u);
  const Waits& own = b.xbar.waits[index(kA)].read;  // through the bridge at 13
  EXPECT_EQ(edges(own, culprit(kA)), 3u) << "its own write, to 16";
  EXPECT_EQ(edges(own, culprit(kB)), 1u);
  EXPECT_EQ(edges(own, culprit(kC)), 1u);
  EXPECT_EQ(sum(own), 19u - 10u);
}

TEST(CrossbarTest, WaitsBehindOnesOwnRequestAreOnesOwn) {
  XbarBench b;
  b.submit(kA, 5, true, 16);
  b.submit(kA, 5, true, 8);
  b.run();
  const Waits& w = b.xbar.waits[index(kA)].write;
  EXPECT_EQ(w.ps[index(culprit(kA))] / kEdge, 2u) << "8 to 10, where the data bus is free again";
}

TEST(CrossbarTest, RequestSurvivesAStoppedClock) {
  XbarBench b;
  b.submit(kA, 5);
  b.xbar.set_clock(Frequency{}, 6 * kEdge);
  EXPECT_EQ(b.xbar.next_decision(), kNever);
  b.xbar.set_clock(Frequency(100'000'000), 100 * kEdge);
  EXPECT_EQ(b.xbar.next_decision(), (100 + 2) * kEdge) << "edge 6 comes at 100, 8 at 102";
}

TEST(CrossbarTest, LatenciesOfABridgeAreSixteenEdgesAtMost) {
  bus::CrossbarParams params;
  ParamSet set;
  set.add(params);
  for (const char* key : {"bus.vpfe.request_latency", "bus.vpfe.response_latency", "bus.arm_d.request_latency"}) {
    EXPECT_NO_THROW(set.set(key, "0 cycles")) << key;
    EXPECT_NO_THROW(set.set(key, "16 cycles")) << key;
    EXPECT_THROW(set.set(key, "17 cycles"), UserError) << key;
  }
}

TEST(CrossbarTest, StatisticsSayWhoseTheyAre) {
  const bus::MasterStats stats(Master::kVpfe);
  EXPECT_EQ(stats.prefix(), "bus.vpfe");
  EXPECT_EQ(stats.read_bytes.sentence(), "bytes that vpfe read");
  EXPECT_EQ(stats.write_bytes.sentence(), "bytes that vpfe wrote");
  EXPECT_EQ(stats.transactions.sentence(), "bursts and single accesses of vpfe");
}

}  // namespace
}  // namespace fovea::dram
