// The crossbar core: arbitration and latencies in edges of its clock, computed by hand; then with
// the DDR controller behind it, where bytes and requests are conserved.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tb/dram/bench.h"
#include "tb/dram/path.h"
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
    EXPECT_EQ(b.sent[0]->in_path.priority, 1) << "the slave is told";
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
  EXPECT_EQ(order(3, 3), "AB") << "the lower number after the last winner, who is nobody";
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

// All on their ports at 5, through the bridge at 8. A's write has the lane from 8 to 16, B's read goes at
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
  EXPECT_EQ(w.ps[index(culprit(kA))] / kEdge, 2u) << "8 to 10, where the lane is free again";
}

TEST(CrossbarTest, RequestSurvivesAStoppedClock) {
  XbarBench b;
  b.submit(kA, 5);
  b.xbar.set_clock(Frequency{}, 6 * kEdge);
  EXPECT_EQ(b.xbar.next_decision(), kNever);
  b.xbar.set_clock(Frequency(100'000'000), 100 * kEdge);
  EXPECT_EQ(b.xbar.next_decision(), (100 + 2) * kEdge) << "edge 6 comes at 100, 8 at 102";
}

// A lone 32-byte read through both cores. DDR 250 MHz, crossbar 125 MHz (8 ns): submitted at 0,
// seen at edge 1, arbitrated at 3, at the controller at edge 4 = 32 ns = DDR edge 8; seen at 9, ACT
// at 17, RD at 22; first 8 bytes at 22 + 5 + 2 + 2 = 31 = 124 ns, so crossbar edge 16; last beat at
// 22 + 4 + 7 + 4 = 37 = 148 ns: edge 19; two edges back to the port.
TEST(PathTest, UnloadedReadLatency) {
  Path path;
  std::array<std::uint8_t, 32> data;
  PathRequest r;
  r.master = kA;
  r.bytes = 32;
  r.data = data.data();
  path.submit(r, 0);
  path.drain();
  EXPECT_EQ(r.first, (16 + 2) * 8'000u);
  EXPECT_EQ(r.last, (19 + 2) * 8'000u);
}

TEST(PathTest, RequestsAndBytesAreConserved) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    Path path;
    CommandChecker checker(sheet_of(mem::DdrConfig{}));
    const Subscription checking = path.ddr.observe_commands(
        [](void* self, mem::Cmd c, unsigned bank, std::uint32_t row, std::uint64_t clock) {
          static_cast<CommandChecker*>(self)->command(translate(c), bank, row, clock);
        },
        &checker);
    Rng rng(seed);
    for (std::size_t m = 0; m < kMasterCount; ++m)
      path.xbar.set_priority(static_cast<Master>(m), static_cast<unsigned>(rng.below(8)));
    struct Item {
      PathRequest r;
      std::array<std::uint8_t, 64> data{};
      Picoseconds at = 0;
    };
    std::vector<std::unique_ptr<Item>> all;
    std::array<std::vector<Item*>, kMasterCount> open;
    Picoseconds now = 0;
    for (unsigned i = 0; i < 8000; ++i) {
      auto item = std::make_unique<Item>();
      const auto m = static_cast<std::size_t>(rng.below(kMasterCount));
      item->r.master = static_cast<Master>(m);
      item->r.write = rng.below(2) != 0;
      item->r.bytes = static_cast<std::uint8_t>(4u << rng.below(5));
      item->r.address =
          at(static_cast<std::uint32_t>(rng.below(64)), static_cast<unsigned>(rng.below(8)),
             static_cast<std::uint32_t>(rng.below(32)) * 64u);
      item->r.data = item->data.data();
      if (rng.below(4) == 0) now += rng.below(60) * 1'000;
      path.run_before(now);
      // At most four outstanding of one master.
      for (;;) {
        std::erase_if(open[m], [](Item* x) { return x->r.responses != 0; });
        if (open[m].size() < 4) break;
        now = std::max(now, path.next_decision());
        path.step();
      }
      item->at = now;
      path.submit(item->r, now);
      open[m].push_back(item.get());
      all.push_back(std::move(item));
    }
    path.drain();
    std::uint64_t read = 0, written = 0;
    for (const auto& item : all) {
      EXPECT_EQ(item->r.responses, 1u);
      EXPECT_GT(item->r.first, item->at);
      EXPECT_GE(item->r.last, item->r.first);
      (item->r.write ? written : read) += item->r.bytes;
    }
    std::uint64_t bus_read = 0, bus_written = 0, transactions = 0;
    for (const auto& s : path.xbar.stats) {
      bus_read += s->ddr_read_bytes;
      bus_written += s->ddr_write_bytes;
      transactions += s->transactions.count();
    }
    std::uint64_t timeline_read = 0, timeline_written = 0;
    for (const auto& row : path.xbar.timeline.rows()) {
      for (const std::uint64_t bytes : row.read) timeline_read += bytes;
      for (const std::uint64_t bytes : row.write) timeline_written += bytes;
    }
    EXPECT_EQ(checker.total(), 0u) << checker.text();
    EXPECT_GT(checker.commands(), all.size());
    EXPECT_EQ(bus_read, read);
    EXPECT_EQ(bus_written, written);
    EXPECT_EQ(path.ddr.stats.read_bytes.count(), read);
    EXPECT_EQ(path.ddr.stats.write_bytes.count(), written);
    EXPECT_EQ(timeline_read, read);
    EXPECT_EQ(timeline_written, written);
    EXPECT_EQ(transactions, all.size());
    // Every picosecond from issue to outcome has one culprit.
    for (std::size_t m = 0; m < kMasterCount; ++m) {
      std::uint64_t reads = 0, writes = 0, tagged_reads = 0, tagged_writes = 0;
      for (const auto& item : all)
        if (index(item->r.master) == m)
          (item->r.write ? writes : reads) += item->r.first - item->at;
      for (std::size_t c = 0; c < kCulprits; ++c) {
        tagged_reads += path.xbar.waits[m].read.ps[c] + path.ddr.waits()[m].read.ps[c];
        tagged_writes += path.xbar.waits[m].write.ps[c] + path.ddr.waits()[m].write.ps[c];
      }
      EXPECT_EQ(tagged_reads, reads) << m;
      EXPECT_EQ(tagged_writes, writes) << m;
      EXPECT_LT(path.xbar.waits[m].read.ps[index(Culprit::kService)], reads);
    }
  }
}

/// DDR clocks of 4 ns that the reads of a master waited for a culprit in the controller.
std::uint64_t clocks(const Path& p, Master m, Culprit c) {
  return p.ddr.waits()[index(m)].read.ps[index(c)] / 4'000;
}

class WaitsTest : public testing::Test {
 protected:
  PathRequest& go(Master m, bool write, std::uint32_t address, unsigned bytes, Picoseconds when) {
    requests_.push_back(std::make_unique<PathRequest>());
    PathRequest& r = *requests_.back();
    r.master = m;
    r.write = write;
    r.address = address;
    r.bytes = static_cast<std::uint8_t>(bytes);
    r.data = data_.data();
    path.submit(r, when);
    return r;
  }
  WaitsTest() {
    path.xbar.set_priority(kA, 0);
    path.xbar.set_priority(kB, 1);
  }
  static constexpr Picoseconds kLater = 1'000'000;
  const mem::DdrTiming t;  // the controller's default
  Path path;

 private:
  std::array<std::uint8_t, 64> data_{};
  std::vector<std::unique_ptr<PathRequest>> requests_;
};

TEST_F(WaitsTest, QueuedClocksAndBanksOfLoneReads) {
  const mem::DdrParams p;
  const std::uint64_t hit = p.request_latency() + 1;  // from its arrival to behind its column
  go(kA, false, at(1, 0, 0), 16, 0);
  path.drain();
  EXPECT_EQ(path.ddr.stats.queued_clocks.count(), hit + t.nRCD);
  go(kA, false, at(1, 0, 16), 16, kLater);
  path.drain();
  EXPECT_EQ(path.ddr.stats.queued_clocks.count(), 2 * hit + t.nRCD);
  go(kA, false, at(2, 3, 16), 16, 2 * kLater);
  go(kA, false, at(2, 0, 16), 16, 3 * kLater);
  path.drain();
  const auto& bank = path.ddr.stats.bank;
  EXPECT_EQ(bank[0].row_misses, 1u);
  EXPECT_EQ(bank[0].row_hits, 1u);
  EXPECT_EQ(bank[0].row_conflicts, 1u);
  EXPECT_EQ(bank[3].row_misses, 1u);
}

TEST_F(WaitsTest, SleepIsCountedUpToWhereSomebodyLooks) {
  mem::DdrConfig c;
  c.refresh_interval = 0;
  c.low_power = mem::LowPower::kPowerDown;
  path.ddr.configure(c, 0);
  path.ddr.catch_up(kLater);
  const std::uint64_t first = path.ddr.stats.power_down_clocks.count();
  EXPECT_GT(first, kLater / 4'000 - 10);
  path.ddr.catch_up(2 * kLater);
  EXPECT_EQ(path.ddr.stats.power_down_clocks.count() - first, kLater / 4'000);
  EXPECT_EQ(path.ddr.stats.self_refresh_clocks.count(), 0u);
}

TEST_F(WaitsTest, ClosedBankCostsTheActivation) {
  go(kA, false, at(1, 0, 0), 32, 0);
  path.drain();
  EXPECT_EQ(clocks(path, kA, Culprit::kRowMiss), t.nRCD);
  go(kA, false, at(1, 0, 64), 32, kLater);
  path.drain();
  EXPECT_EQ(clocks(path, kA, Culprit::kRowMiss), t.nRCD) << "the row is open now";
  EXPECT_EQ(path.ddr.waits()[index(kA)].read.ps[index(Culprit::kRowConflict)], 0u);
}

TEST_F(WaitsTest, OtherRowCostsPrechargeAndActivation) {
  go(kA, false, at(1, 0, 0), 32, 0);
  go(kB, false, at(2, 0, 0), 32, kLater);
  path.drain();
  EXPECT_EQ(clocks(path, kB, Culprit::kRowConflict), t.nRP + t.nRCD);
  EXPECT_EQ(clocks(path, kB, Culprit::kRowMiss), 0u);
}

TEST_F(WaitsTest, ReadBehindAnothersBurstWaitsForThatMaster) {
  go(kA, false, at(1, 0, 0), 4, 0);
  path.drain();
  // Both cross in a clock of 8 ns each; A's columns are at c, c + 4, c + 8, c + 12; B is ready at c + 2.
  go(kA, false, at(1, 0, 0), 64, kLater);
  go(kB, false, at(1, 0, 64), 16, kLater);
  path.drain();
  EXPECT_EQ(clocks(path, kB, culprit(kA)), 4u * 4 - 2);
  EXPECT_EQ(clocks(path, kA, culprit(kB)), 0u);
}

TEST_F(WaitsTest, ReadAfterAnothersWriteWaitsForBurstAndTurnaround) {
  go(kA, false, at(1, 0, 0), 4, 0);
  path.drain();
  go(kA, true, at(1, 0, 0), 4, kLater);
  go(kB, false, at(1, 0, 64), 16, kLater);
  path.drain();
  // WR at w; its data end at w + WL + 4; RD at w + WL + 4 + tWTR. B is ready at w + 2.
  EXPECT_EQ(clocks(path, kB, culprit(kA)), t.WL() + 4u - 2);
  EXPECT_EQ(clocks(path, kB, Culprit::kTurnaround), t.nWTR);
}

TEST_F(WaitsTest, ReadOfASleepingMemoryWaitsForItsWaking) {
  mem::DdrConfig c;
  c.low_power = mem::LowPower::kSelfRefresh;
  path.ddr.configure(c, 0);
  go(kA, false, at(1, 0, 0), 16, kLater);
  path.drain();
  // CKE rises at the arrival; the pipeline's clocks run meanwhile.
  const mem::DdrParams p;
  EXPECT_EQ(clocks(path, kA, Culprit::kPowerDown) + clocks(path, kA, Culprit::kRowMiss),
            std::max(c.timing.nXSNR + c.timing.nRCD, c.timing.nXSRD) - p.request_latency());
  EXPECT_GE(clocks(path, kA, Culprit::kPowerDown), c.timing.nXSNR - p.request_latency());
}

TEST_F(WaitsTest, ReadDuringARefreshWaitsForIt) {
  mem::DdrConfig c;
  c.refresh_interval = 500;
  path.ddr.configure(c, 0);
  // The interval ends at clock 500, when nothing is queued: PREA is not needed, REF at once. The read
  // is ready some clocks later.
  const Picoseconds when = 500 * 4'000 - 3 * 8'000;
  PathRequest& r = go(kA, false, at(1, 0, 0), 16, when);
  path.drain();
  const std::uint64_t refresh = clocks(path, kA, Culprit::kRefresh);
  EXPECT_GT(refresh, 0u);
  EXPECT_LT(refresh, c.timing.nRFC);
  Path calm;
  PathRequest same;
  same.master = kA;
  same.address = at(1, 0, 0);
  same.bytes = 16;
  std::array<std::uint8_t, 16> data{};
  same.data = data.data();
  calm.submit(same, when);
  calm.drain();
  // Reads come at edges of 8 ns: 2 clocks.
  EXPECT_NEAR(static_cast<double>(r.first - same.first), static_cast<double>(refresh) * 4'000, 8'000);
}

}  // namespace
}  // namespace fovea::dram
