// The player of bus traces: release rules, windows, and times compared with the cores driven
// directly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <deque>
#include <map>

#include "tb/dram/path.h"
#include "tb/replay/played.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using trace::Record;
using trace::Release;

TEST(ReplayPathTest, TimesAreThoseOfTheCoresDrivenByHand) {
  Rng rng(1);
  std::string text = master_lines(3, 16);
  dram::Path hand(Frequency(243'000'000), Frequency(121'500'000));
  mem::DdrConfig config;
  for (const unsigned interval : {0u, mem::DdrConfig{}.refresh_interval}) {
    config.refresh_interval = interval;  // counts from time 0, as in a replay
    hand.ddr.configure(config, 0);
  }
  struct Sent {
    dram::PathRequest request;
    std::array<std::uint8_t, 64> data;
  };
  std::deque<Sent> sent;
  Picoseconds at = 1'000;
  for (int n = 0; n < 3000; ++n) {
    at += 20'000 + rng.below(300'000);  // seldom more than a few under way
    Sent& s = sent.emplace_back();
    dram::PathRequest& r = s.request;
    r.data = s.data.data();
    const auto m = static_cast<unsigned>(rng.below(3));
    r.master = trace::TextTrace::port(m);
    r.write = rng.below(3) == 0;
    r.bytes = static_cast<std::uint8_t>(8u << rng.below(4));
    r.address = static_cast<std::uint32_t>(rng.below(1u << 20) * 64);
    text += fmt::format("{} {} {} 0x{:x} {}\n", at, m, r.write ? 'W' : 'R', r.address,
                        r.bytes);
    hand.run_before(at);
    hand.submit(r, at);
  }
  hand.drain();
  trace::TextTrace trace("t", text);
  // The hand-driven cores have the bench's parameters: those of masters are the crossbar's defaults.
  Played played(trace);
  std::array<Histogram, 3> expected;
  Picoseconds last = 0;
  for (const Sent& s : sent) {
    if (!s.request.write)
      expected[index(s.request.master) - index(trace::TextTrace::port(0))].add(
          s.request.first - s.request.issued);
    last = std::max(last, s.request.last);
  }
  for (unsigned m = 0; m < 3; ++m) {
    const Histogram& got = played.path->latency(trace::TextTrace::port(m)).histogram;
    EXPECT_EQ(got.count(), expected[m].count());
    EXPECT_EQ(got.mean(), expected[m].mean());
    EXPECT_EQ(got.min(), expected[m].min());
    EXPECT_EQ(got.max(), expected[m].max());
  }
  EXPECT_EQ(played.path->duration(), last);
}

std::string random_reads(unsigned masters, unsigned window, int count, unsigned bytes) {
  Rng rng(2);
  std::string text = master_lines(masters, window);
  for (int n = 0; n < count; ++n)
    text += fmt::format("0 {} R 0x{:x} {}\n", rng.below(masters), rng.below(1u << 20) * 64, bytes);
  return text;
}

class WindowTest : public testing::TestWithParam<bool> {};
TEST_P(WindowTest, OneReadAtATimeTakesTheSumOfItsLatencies) {
  trace::TextTrace one("t", random_reads(1, 1, 500, 8));
  const Played alone(one, GetParam());
  const Histogram& h = alone.path->latency(trace::TextTrace::port(0)).histogram;
  EXPECT_EQ(h.count(), 500u);
  // Eight bytes: the first beat is the last, and the next read goes out with it.
  EXPECT_NEAR(static_cast<double>(alone.path->duration()), h.mean() * 500, 1);
  trace::TextTrace four("t", random_reads(1, 4, 500, 8));
  const Played many(four, GetParam());
  EXPECT_LT(many.path->duration(), alone.path->duration() * 3 / 4);
}
/// Little's law: latencies over time are how many were under way, all the time the whole window.
TEST_P(WindowTest, TheWholeWindowIsUnderWay) {
  for (const unsigned window : {1u, 4u, 16u, 48u}) {
    trace::TextTrace text("t", random_reads(1, window, 5000, 32));
    const Played p(text, GetParam());
    const Histogram& h = p.path->latency(trace::TextTrace::port(0)).histogram;
    // A latency ends with the first beat of the data, the place is free with the last.
    const double under_way = h.mean() * 5000 / static_cast<double>(p.path->duration());
    EXPECT_LE(under_way, window);
    EXPECT_GT(under_way, window * 0.9 - 0.5) << window;
  }
}
TEST_P(WindowTest, AllBytesAreMoved) {
  Rng rng(3);
  std::string text = master_lines(10, 5);
  std::uint64_t read = 0, written = 0;
  for (int n = 0; n < 4000; ++n) {
    const bool write = rng.below(2);
    const std::uint64_t bytes = 1 + rng.below(200);
    (write ? written : read) += bytes;
    text += fmt::format("0 {} {} 0x{:x} {}\n", rng.below(10), write ? 'W' : 'R',
                        rng.below(100'000'000), bytes);
  }
  trace::TextTrace t("t", text);
  Played p(t, GetParam());
  EXPECT_EQ(p.path->memory().read_bytes.count(), read);
  EXPECT_EQ(p.path->memory().write_bytes.count(), written);
}
INSTANTIATE_TEST_SUITE_P(MemoryOnly, WindowTest, testing::Bool());

TEST(ReplayPathTest, TheCrossbarCostsTime) {
  trace::TextTrace a("t", random_reads(1, 1, 500, 32)), b("t", random_reads(1, 1, 500, 32));
  EXPECT_GT(Played(a).path->duration(), Played(b, true).path->duration());
}

Record after(std::uint32_t back, bool first, std::uint64_t gap, std::uint32_t address) {
  Record r = read_at(0, address);
  r.release = Release::kAfter;
  r.back = back;
  r.from_first = first;
  r.gap = gap;
  return r;
}

/// Outcomes, by direction.
struct Outcomes : MemObserver {
  std::array<std::vector<Picoseconds>, 2> issued, last;
  void submitted(const MemRequest& r, bool) override { issued[r.write].push_back(r.issued); }
  void responded(const MemRequest& r) override { last[r.write].push_back(r.last); }
};

TEST(ReplayPathTest, AGapCountsInTheStreamsClock) {
  const trace::TraceInfo info = board_info();
  const Clock core(info.streams[0].clock, info.streams[0].clock_start);
  std::map<std::uint64_t, Picoseconds> second;
  for (const std::uint64_t gap : {400u, 402u, 440u}) {
    Listed l;
    l.records[0] = {read_at(2'000'000, 0x1000), after(1, true, gap, 0x9000)};
    second[gap] = Played(info, l).issued[0].at(1);
    EXPECT_EQ(core.edge_at_or_after(second[gap]) % 2, 1u) << "an AHB edge";
    EXPECT_EQ(core.edge(core.edge_at_or_after(second[gap])), second[gap]);
  }
  EXPECT_EQ(core.edge_at_or_after(second[402]), core.edge_at_or_after(second[400]) + 2);
  EXPECT_EQ(core.edge_at_or_after(second[440]), core.edge_at_or_after(second[400]) + 40);
}

// The port is taken until the read's last beat, somewhere between two edges of the AHB.
TEST(ReplayPathTest, WhoWaitsForThePortGoesOutWithAnAhbEdge) {
  for (const unsigned align : {2u, 3u, 5u}) {
    trace::TraceInfo info = board_info();
    info.streams[0].align = align;
    info.streams[0].phase = align - 1;
    const Clock core(info.streams[0].clock, info.streams[0].clock_start);
    Listed l;
    Record second = after(1, true, 0, 0x9000);  // its word comes long before the last beat
    l.records[0] = {read_at(2'000'000, 0x1000), second};
    Outcomes seen;
    const Picoseconds at = Played(info, l, false, {}, &seen).issued[0].at(1);
    ASSERT_EQ(seen.last[0].size(), 2u);
    const std::uint64_t edge = core.edge_at_or_after(at);
    EXPECT_EQ(core.edge(edge), at);
    EXPECT_EQ(edge % align, align - 1) << "not with the AHB's edge";
    EXPECT_GE(at, seen.last[0][0]);
    EXPECT_LT(edge, core.edge_at_or_after(seen.last[0][0]) + align) << "the next edge";
  }
}

// A store takes its place in the program when it enters the buffer, not when its port is free.
TEST(ReplayPathTest, AStoreFollowsTheOneBeforeInTheProgram) {
  const trace::TraceInfo info = board_info();
  const Clock core(info.streams[0].clock, info.streams[0].clock_start);
  const auto store = [](std::uint32_t back, std::uint64_t gap, std::uint32_t room) {
    Record r = after(back, true, gap, 0x9000);
    r.write = true;
    r.critical = 0;
    r.room = room;
    return r;
  };
  const auto issued = [&](std::uint32_t room, std::uint64_t far) {
    Listed l;
    // Three stores three clocks apart, and one `far` clocks behind the third.
    l.records[0] = {read_at(2'000'000, 0x1000), store(1, 1'000, 0), store(1, 3, 0), store(1, 3, 0),
                    store(1, far, room)};
    Outcomes seen;
    const Played p(info, l, false, {}, &seen);
    std::vector<std::uint64_t> clocks;
    for (std::size_t n = 1; n < 5; ++n) clocks.push_back(core.edge_at_or_after(p.issued[0].at(n)));
    clocks.push_back(core.edge_at_or_after(seen.last[1].at(0)));
    return clocks;
  };
  const auto near = issued(0, 3), far = issued(0, 1'001), later = issued(0, 1'003);
  EXPECT_GT(near[1], near[0] + 4) << "the port is taken much longer than the program needs";
  EXPECT_EQ(near[0], far[0]);
  // At least 1007 clocks behind the first: 1000 for the first's AHB edge, and an edge that is odd.
  EXPECT_LE(far[3], far[0] + 3 + 3 + 1'001 + 1);
  EXPECT_GE(far[3], far[0] + 3 + 3 + 1'001 - 1);
  EXPECT_EQ(later[3], far[3] + 2) << "however long the others were on the way";
  // With no room before the first is out, the program comes to the last at that end, and goes on.
  EXPECT_EQ(issued(3, 3)[3], near[3]) << "it waits for the port longer than for room";
}

// What follows a store that waited for room waits as well.
TEST(ReplayPathTest, AWaitForRoomMovesTheProgram) {
  const trace::TraceInfo info = board_info();
  const Clock core(info.streams[0].clock, info.streams[0].clock_start);
  for (const std::uint32_t room : {0u, 1u}) {
    Listed l;
    Record a = after(1, true, 1'001, 0x9000), b = a, c = a;
    a.write = b.write = true;
    b.gap = 1;
    b.room = room;
    c.gap = 401;
    l.records[0] = {read_at(2'000'000, 0x1000), a, b, c};
    Outcomes seen;
    const Played p(info, l, false, {}, &seen);
    const std::uint64_t first = core.edge_at_or_after(p.issued[0].at(1));
    std::uint64_t end = core.edge_at_or_after(seen.last[1].at(0));
    end += end % 2 == 0;  // the AHB's next edge
    ASSERT_GT(end, first + 4);
    const std::uint64_t last = core.edge_at_or_after(p.issued[0].at(3));
    if (room)
      EXPECT_EQ(last, end + 401 + (end + 401 + 1) % 2);
    else
      EXPECT_LE(last, first + 1 + 401 + 1);
  }
}

TEST(ReplayPathTest, AnInterruptReleasesASleeper) {
  const trace::TraceInfo info = board_info();
  const Clock core(info.streams[0].clock, info.streams[0].clock_start);
  const auto issued = [&](std::uint64_t work) {
    Listed l;
    Record r = after(1, true, work, 0x9000);
    r.release = Release::kWhen;
    r.event = 1;  // at 5 us
    r.wake_gap = 20;
    l.records[0] = {read_at(2'000'000, 0x1000), r};
    return core.edge_at_or_after(Played(info, l).issued[0].at(1));
  };
  const std::uint64_t wake = core.edge_at_or_after(info.interrupts[1]) + 20;
  EXPECT_EQ(issued(10), wake + (wake % 2 == 0));  // asleep long before
  EXPECT_GT(issued(2'000), wake + 1'000);         // still at work when it came
}

Record when(std::uint8_t stream, std::uint64_t record, std::uint32_t gap, bool write,
            std::uint32_t address) {
  Record r = read_at(0, address);
  r.master = write ? Master::kVpfe : Master::kVpbe;
  r.write = write;
  r.release = Release::kWhen;
  r.source = stream;
  r.event = record;
  r.wake_gap = gap;
  return r;
}
// A copy with two places: each write waits for its read's data, each read for the write before the
// last one, and 700 ps. Streams 1 and 2 count picoseconds.
TEST(ReplayPathTest, ACompletionElsewhereReleasesARecord) {
  const trace::TraceInfo info = board_info();
  Listed l;
  constexpr unsigned kCount = 9'000;  // more than the player remembers
  for (unsigned n = 0; n < kCount; ++n) {
    const std::uint32_t address = n % 1'000 * 64;
    l.records[1].push_back(when(2, n, 0, true, address));
    l.records[2].push_back(when(1, n < 2 ? 0 : n - 2, 700, false, 0x100'0000 + address));
    if (n < 2) {
      l.records[2].back().release = Release::kAt;
      l.records[2].back().at = 2'000'000;
    }
  }
  app::ReplayParams params;
  app::ReplayPath path("t", info, l, params, false);
  Outcomes o;
  path.observe(&o);
  EXPECT_TRUE(path.run_before(kNever));
  ASSERT_EQ(o.last[1].size(), kCount);
  for (unsigned n = 0; n < kCount; ++n) {
    ASSERT_EQ(o.issued[1][n], o.last[0][n]) << n;
    if (n >= 2) {
      ASSERT_EQ(o.issued[0][n], o.last[1][n - 2] + 700) << n;
    }
  }
}

TEST(ReplayPathTest, ACompletionLongAgoHoldsNobodyUp) {
  const trace::TraceInfo info = board_info();
  Listed l;
  for (unsigned n = 0; n < 6'000; ++n) {
    l.records[2].push_back(read_at(1'000'000, n * 64));
    l.records[2].back().master = Master::kVpbe;
  }
  l.records[1] = {read_at(800'000'000, 0), when(2, 5, 0, true, 64)};
  l.records[1][0].master = Master::kVpfe;
  const Played p(info, l);
  EXPECT_EQ(p.issued[1].at(1), 800'000'000u) << "as soon as its stream comes to it";
}

TEST(ReplayPathTest, RecordsThatWaitForEachOtherAreAnError) {
  const trace::TraceInfo info = board_info();
  Listed l;
  l.records[1] = {when(2, 0, 0, true, 64)};
  l.records[2] = {when(1, 0, 0, false, 64)};
  app::ReplayParams params;
  app::ReplayPath path("t", info, l, params, false);
  try {
    path.run_before(kNever);
    FAIL() << "a deadlock that nobody sees";
  } catch (const UserError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("stops before its end"));
  }
}

TEST(ReplayPathTest, TheTimelineHasAllBytesInTheirTime) {
  for (const bool memory_only : {false, true}) {
    trace::TextTrace t("t", "# dramtrace 1\n# master 7 window 4 left\n# master 9 window 4 right\n"
                            "5000000 7 R 0x0 256\n2500000000 9 W 0x40000 64\n"
                            "2600000000 7 R 0x0 64\n3000000000 9 W 0x0 4\n");
    const Played p(t, memory_only);
    EXPECT_EQ(p.path->labels(), (std::vector<std::string>{"left", "right"}));
    const auto rows = p.path->timeline();  // of 1 ms; the fourth is not whole
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[3].start, 3'000'000'000u);
    EXPECT_EQ(rows[3].end, p.path->duration());
    EXPECT_EQ(rows[3].write_bytes, (std::vector<std::uint64_t>{0, 4}));
    EXPECT_EQ(rows[0].start, 0u);
    EXPECT_EQ(rows[2].end, 3'000'000'000u);
    EXPECT_EQ(rows[0].read_bytes, (std::vector<std::uint64_t>{256, 0}));
    EXPECT_EQ(rows[1].read_bytes, (std::vector<std::uint64_t>{0, 0}));
    EXPECT_EQ(rows[2].read_bytes, (std::vector<std::uint64_t>{64, 0}));
    EXPECT_EQ(rows[2].write_bytes, (std::vector<std::uint64_t>{0, 64}));
  }
}

// Writes are complete before the memory has them: the figures are of the time that it needs.
TEST(ReplayPathTest, TimeEndsWithTheMemorysLastData) {
  for (const bool memory_only : {false, true})
    for (const unsigned writes : {1u, 2u, 7u, 20u}) {
      std::string text = master_lines(1, 4);
      for (unsigned i = 0; i < writes; ++i) text += fmt::format("0 0 W 0x{:x} 16\n", i * 16);
      trace::TextTrace t("t", text);
      const Played p(t, memory_only);
      const auto value = figures(p);
      const double clocks = value.at("replay.time") * 243e6;
      EXPECT_NEAR(value.at("replay.bandwidth") * value.at("replay.time"), writes * 16, 1e-6);
      EXPECT_NEAR(value.at("ddr.utilisation"), writes * 4 / clocks, 1e-9);
      EXPECT_GT(value.at("ddr.headroom"), 0);
      // First edge, pipeline, ACT, data without a gap, WL behind their WR.
      if (memory_only) {
        EXPECT_NEAR(clocks, 1 + 8 + 5 + writes * 4 + 4, 1e-3) << writes;
      }
    }
}

// SDRAM and crossbar have one PLL: with other clocks a trace plays as one that was recorded with these,
// each edge of the crossbar's being one of the SDRAM's.
TEST(ReplayPathTest, ChangedClocksAreThoseOfOnePll) {
  const auto play = [](const trace::TraceInfo& info, const Keys& keys) {
    Listed l;
    Rng rng(9);
    for (unsigned n = 0; n < 2'000; ++n)
      for (const unsigned s : {1u, 2u}) {
        Record r = read_at(1'500'000 + n * 60'000 + rng.below(50'000),
                           static_cast<std::uint32_t>(rng.below(1u << 20) * 64));
        r.master = s == 1 ? Master::kVpfe : Master::kVpbe;
        r.write = rng.below(3) == 0;
        l.records[s].push_back(r);
      }
    struct : MemObserver {
      std::vector<Picoseconds> times;
      void submitted(const MemRequest&, bool) override {}
      void responded(const MemRequest& r) override { times.insert(times.end(), {r.first, r.last}); }
    } seen;
    const Played p(info, l, false, keys, &seen);
    return seen.times;
  };
  for (const auto& [ddr, scr] : {std::pair{"270MHz", "135MHz"}, std::pair{"340MHz", "170MHz"},
                                 std::pair{"333333333Hz", "166666667Hz"}}) {
    const Keys keys = {{"ddr.clock", ddr}, {"bus.clock", scr}, {"ddr.tREFI", "0cycles"}};
    const trace::TraceInfo recorded = board_info();
    trace::TraceInfo like = recorded;
    const std::uint64_t hertz = std::stoull(ddr) < 1'000 ? std::stoull(ddr) * 1'000'000
                                                         : std::stoull(ddr);
    const Clock crossbar(Frequency(hertz, 2), recorded.scr.start);
    like.scr = {Frequency(hertz, 2), crossbar.next_edge_at_or_after(recorded.start)};
    like.ddr = {Frequency(hertz), like.scr.start};
    EXPECT_EQ(play(recorded, keys), play(like, keys)) << ddr;
  }
}

// A write that waits in the memory's input register is acknowledged when it goes through, not before.
TEST(ReplayPathTest, AWriteIsAcknowledgedAtTheDoor) {
  trace::TraceInfo info = board_info();
  info.streams[0] = {};  // counts picoseconds
  for (auto& m : info.masters) m.writes = m.reads = 24;
  Listed l;
  constexpr unsigned kWrites = 24;
  for (unsigned n = 0; n < kWrites; ++n) {
    Record w = read_at(1'000'000, n * 64);
    w.master = Master::kVpfe;
    w.write = true;
    w.bytes = 64;
    l.records[1].push_back(w);
    Record mark = read_at(0, 0);
    mark.mark = true;
    mark.release = Release::kWhen;
    mark.source = 1;
    mark.event = n;
    l.records[0].push_back(mark);
  }
  const Played p(info, l, true, {{"ddr.tREFI", "0cycles"}});
  ASSERT_EQ(p.issued[0].size(), kWrites);
  // The write FIFO of 88 bytes takes one at once, and one in the place of each whose 16 clocks of data
  // have gone out.
  EXPECT_EQ(p.issued[0][0], 1'000'000u);
  const double clock = 1e12 / 243e6;
  for (unsigned n = 2; n < kWrites; ++n)
    EXPECT_GE(static_cast<double>(p.issued[0][n] - p.issued[0][n - 1]), 16 * clock - 1) << n;
  EXPECT_GE(p.issued[0][1], 1'000'000u);
  EXPECT_GE(static_cast<double>(p.path->duration()),
            static_cast<double>(p.issued[0].back() - info.start));
}

// The write FIFO of 88 bytes takes a burst of 64; the next one waits at the door, and behind it another
// master's word. When the burst goes in there is room for the word too: both are acknowledged then.
TEST(ReplayPathTest, AWordBehindTheDoorIsAcknowledgedWhenTheDoorOpens) {
  trace::TraceInfo info = board_info();
  info.streams[0] = {};  // counts picoseconds
  Listed l;
  const auto write = [&](unsigned stream, Master master, Picoseconds at, unsigned bytes) {
    Record w = read_at(at, static_cast<std::uint32_t>(l.records[stream].size() * 64));
    w.master = master;
    w.write = true;
    w.bytes = static_cast<std::uint8_t>(bytes);
    l.records[stream].push_back(w);
  };
  write(1, Master::kVpfe, 1'000'000, 64);
  write(1, Master::kVpfe, 1'000'000, 64);
  write(2, Master::kVpbe, 1'002'000, 8);
  // Marks that wait for the first burst, the word, the second burst.
  for (const auto& [stream, n] : {std::pair{1, 0}, {2, 0}, {1, 1}}) {
    Record mark = read_at(0, 0);
    mark.mark = true;
    mark.release = Release::kWhen;
    mark.source = static_cast<std::uint8_t>(stream);
    mark.event = static_cast<unsigned>(n);
    l.records[0].push_back(mark);
  }
  for (auto& m : info.masters) m.writes = m.reads = 4;
  const Played p(info, l, true, {{"ddr.tREFI", "0cycles"}});
  ASSERT_EQ(p.issued[0].size(), 3u);
  EXPECT_EQ(p.issued[0][0], 1'000'000u);
  // Not before the 16 clocks of the first burst's data.
  EXPECT_GT(p.issued[0][1], 1'000'000u + 16 * 4'115u);
  EXPECT_EQ(p.issued[0][2], p.issued[0][1]);
}

// Without the crossbar nothing but the SDRAM's bus moves the data: four bytes a clock and edge of it.
TEST(ReplayPathTest, MemoryOnlyReadsAtTheRateOfTheSdram) {
  for (const char* scheduler : {"ti", "fcfs", "frfcfs"})
    for (const std::uint64_t mhz : {270u, 340u})
      for (const char* bus : {"10MHz", "121500000Hz", "1GHz"}) {
        const auto time = [&](unsigned reads) {
          std::string text = master_lines(1, 8);
          for (unsigned n = 0; n < reads; ++n) text += fmt::format("0 0 R 0x{:x} 64\n", n % 32 * 64);
          trace::TextTrace t("t", text);
          const Played p(t.info(), t, true,
                         {{"ddr.clock", fmt::format("{}MHz", mhz)}, {"bus.clock", bus},
                          {"ddr.tREFI", "0cycles"}, {"ddr.scheduler", scheduler}});
          return figures(p).at("replay.time");
        };
        // An open row: 16 clocks a read, and no other.
        const double bandwidth = 64 * 1000 / (time(2000) - time(1000));
        EXPECT_NEAR(bandwidth, 4e6 * static_cast<double>(mhz), 1e3) << scheduler << ' ' << bus;
      }
}

TEST(ReplayPathTest, MemoryOnlyHasNoFigureOfTheCrossbar) {
  const auto all = [](const char* bus, const char* fifo) {
    trace::TextTrace t("t", random_reads(3, 4, 2'000, 64));
    return figures(Played(t.info(), t, true, {{"bus.clock", bus}, {"ddr.read_fifo", fifo}}));
  };
  const auto one = all("121500000Hz", "136B");
  EXPECT_EQ(one, all("1MHz", "136B"));
  EXPECT_EQ(one, all("1GHz", "64B"));
}

// Eight masters with a bank each keep the data bus busy however many requests wait at the door: equals
// take turns there as in the crossbar (TheoryTest has the formula).
TEST(ReplayPathTest, EqualsTakeTurnsAtTheDoor) {
  for (const unsigned window : {2u, 4u, 8u, 48u}) {
    constexpr unsigned kEach = 500;
    std::string text = master_lines(8, window);
    for (unsigned n = 0; n < kEach; ++n)
      for (unsigned m = 0; m < 8; ++m)
        text += fmt::format("0 {} R 0x{:x} 16\n", m, (n * 8 + m) * 2048);
    trace::TextTrace t("t", text);
    const Played p(t.info(), t, true, {{"ddr.tREFI", "0cycles"}});
    const double clocks = figures(p).at("replay.time") * 243e6;
    EXPECT_NEAR(clocks / (8 * kEach), 4, 0.04) << window;
  }
}

// A slow crossbar announces requests long before they arrive: rows that are due are closed meanwhile,
// or the checker of the commands (Played) ends the test.
TEST(ReplayPathTest, RowsAreClosedInTimeBehindASlowCrossbar) {
  Rng rng(6);
  std::string text = master_lines(2, 4);
  for (unsigned i = 0; i < 4000; ++i)
    text += fmt::format("0 {} {} 0x{:x} 64\n", rng.below(2), rng.below(2) ? 'W' : 'R',
                        rng.below(1u << 20) * 64);
  for (const char* clock : {"1MHz", "10MHz", "60MHz"}) {
    trace::TextTrace t("t", text);
    const Played p(t.info(), t, false, {{"bus.clock", clock}, {"ddr.row_intervals", "1"}});
    EXPECT_EQ(p.path->requests(), 4000u);
  }
}

// What the reads of a master waited for is their latency, to the picosecond; what their master and the
// bus did is in proportion.
TEST(ReplayPathTest, TheFiguresAddUp) {
  std::string text = master_lines(3, 4);
  Rng rng(4);
  std::array<unsigned, 3> reads{};
  for (unsigned i = 0; i < 3000; ++i) {
    const auto m = static_cast<unsigned>(rng.below(3));
    const bool write = rng.below(3) == 0;
    reads[m] += !write;
    text += fmt::format("{} {} {} 0x{:x} {}\n", rng.below(2) * i * 40'000, m, write ? 'W' : 'R',
                        rng.below(1u << 20) * 64, 4u << rng.below(5));
  }
  trace::TextTrace t("t", text);
  const Played p(t);
  const auto value = figures(p);
  for (unsigned m = 0; m < 3; ++m) {
    double waited = 0;
    for (const auto& [name, v] : value)
      if (name.starts_with(fmt::format("ddr.m{}.wait.read.", m))) waited += v;
    EXPECT_NEAR(waited * 1e12, value.at(fmt::format("ddr.m{}.latency.mean", m)) * 1e12 * reads[m], 1);
    EXPECT_GT(value.at(fmt::format("ddr.m{}.wait.read.m{}", m, (m + 1) % 3)), 0);
    EXPECT_GT(value.at(fmt::format("ddr.m{}.wait.write.bridge", m)), 0);
  }
  EXPECT_NEAR(value.at("ddr.efficiency") * (1 - value.at("ddr.headroom")),
              value.at("ddr.utilisation"), 1e-12);
  const double bytes = value.at("ddr.read_bytes") + value.at("ddr.write_bytes");
  EXPECT_NEAR(value.at("replay.bandwidth") * value.at("replay.time"), bytes, 1e-6);
  double rows = 0;
  for (unsigned b = 0; b < 8; ++b)
    rows += value.at(fmt::format("ddr.bank{}.row_hits", b)) +
            value.at(fmt::format("ddr.bank{}.row_misses", b)) +
            value.at(fmt::format("ddr.bank{}.row_conflicts", b));
  EXPECT_EQ(rows, 3000);
}

TEST(ReplayPathTest, MarksKeepTheirPlace) {
  const trace::TraceInfo info = board_info();
  Listed l;
  Record begin = after(1, true, 100, 0x4 | 7 << 4), end = after(2, true, 100, 0x5 | 7 << 4);
  begin.mark = end.mark = true;
  end.back = 1;
  l.records[0] = {read_at(2'000'000, 0x1000), begin, after(2, false, 200, 0x9000), end};
  const Played p(info, l);
  ASSERT_EQ(p.path->remap_times().size(), 1u);
  const Picoseconds read_done = p.issued[0].at(2);
  EXPECT_GT(p.path->marks()[1].at, read_done);
  EXPECT_EQ(p.path->remap_times()[0], p.path->marks()[1].at - p.path->marks()[0].at);
}

TEST(ReplayPathTest, TheUrgentMasterWaitsLess) {
  const auto means = [](std::uint8_t first, std::uint8_t second) {
    trace::TraceInfo info = board_info();
    Listed l;
    Rng rng(5);
    for (int n = 0; n < 600; ++n)
      for (const unsigned s : {1u, 2u}) {
        Record r = read_at(1'000'000, static_cast<std::uint32_t>(rng.below(1u << 20) * 64));
        r.master = s == 1 ? Master::kVpfe : Master::kVpbe;
        r.priority = s == 1 ? first : second;
        l.records[s].push_back(r);
      }
    const Played p(info, l);
    return std::pair(p.path->latency(Master::kVpfe).histogram.mean(),
                     p.path->latency(Master::kVpbe).histogram.mean());
  };
  const auto one = means(0, 7), two = means(7, 0);
  EXPECT_LT(one.first * 1.1, one.second);
  EXPECT_LT(two.second * 1.1, two.first);
}

std::string error_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const UserError& e) {
    return e.what();
  }
  return {};
}

TEST(ReplayPathTest, WhatNoMemoryHasIsRefused) {
  using testing::HasSubstr;
  const auto play = [](const char* line, std::vector<std::pair<std::string, std::string>> keys) {
    return error_of([&] {
      trace::TextTrace t("t", std::string("# dramtrace 1\n# master 0 window 1 a\n") + line);
      Played(t.info(), t, false, keys);
    });
  };
  EXPECT_EQ(play("0 0 R 0x7FFFFC0 64\n", {}), "");
  EXPECT_THAT(play("0 0 R 0x8000000 4\n", {}), HasSubstr("outside the SDRAM of 128 MiB"));
  EXPECT_EQ(play("0 0 R 0x0 256\n\n0 0 W 0x7fffffe 4\n", {}),
            "trace 't': line 5 of a: 2 bytes at 0x08000000: outside the SDRAM of 128 MiB (ddr.part)");
  EXPECT_EQ(play("0 0 R 0x8000000 4\n", {{"ddr.part", "mt47h128m16"}}), "");
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.tRC", "12 cycles"}}), HasSubstr("ddr.tRC"));
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.tRAS", "4 cycles"}}), HasSubstr("ddr.tRAS"));
  // A refresh opens and closes a row: a clock more than tRP at least.
  for (const unsigned tRP : {5u, 8u}) {
    const auto with = [&](unsigned tRFC) {
      return play("0 0 R 0x0 4\n", {{"ddr.tRP", fmt::format("{} cycles", tRP)},
                                    {"ddr.tRC", "32 cycles"},
                                    {"ddr.tRFC", fmt::format("{} cycles", tRFC)}});
    };
    EXPECT_THAT(with(tRP), HasSubstr("ddr.tRFC")) << tRP;
    EXPECT_EQ(with(tRP + 1), "") << tRP;
  }
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.CL", "9 cycles"}}), HasSubstr("7"));
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.clock", "90MHz"}}), HasSubstr("125"));
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.banks", "6"}}), HasSubstr("powers of two"));
  EXPECT_THAT(play("0 0 R 0x0 4\n", {{"ddr.part", "mt47h32m16"}}), HasSubstr("ddr.banks"));
}

// What no part of its kind does is refused; what the part at hand forbids is a warning.
TEST(ReplayPathTest, EachKindOfMemoryHasItsClocks) {
  using testing::HasSubstr;
  std::vector<std::string> said;
  const auto play = [&](std::vector<std::pair<std::string, std::string>> keys) {
    Diagnostics::instance().clear();
    const std::string error = error_of([&] {
      trace::TextTrace t("t", "# dramtrace 1\n# master 0 window 1 a\n0 0 R 0x0 4\n");
      Played(t.info(), t, false, keys);
    });
    said.clear();
    for (const auto& [what, n] : Diagnostics::instance().counts()) said.push_back(what.second);
    return error;
  };
  EXPECT_THAT(play({{"ddr.clock", "124MHz"}}), HasSubstr("125MHz .. 533MHz, DDR2"));
  EXPECT_EQ(play({{"ddr.clock", "125MHz"}, {"ddr.tREFI", "975cycles"}}), "");
  EXPECT_THAT(said, testing::IsEmpty());
  EXPECT_THAT(play({{"ddr.CL", "2cycles"}}), HasSubstr("3 .. 7 cycles, DDR2"));
  EXPECT_EQ(play({{"ddr.clock", "266MHz"}, {"ddr.CL", "4cycles"}}), "");
  EXPECT_THAT(play({{"ddr.clock", "267MHz"}, {"ddr.CL", "4cycles"}}),
              HasSubstr("'ddr.CL': 4 cycles is not allowed; allowed: more cycles at 267MHz"));
  // 3.75 ns, 2.5 ns and 1.875 ns in whole hertz, rounded up; 2 Hz more are too many.
  const auto at_CL = [&](const char* clock, const char* CL) {
    return play({{"ddr.clock", clock}, {"ddr.CL", CL}});
  };
  EXPECT_EQ(at_CL("266666667Hz", "4cycles"), "");
  EXPECT_THAT(at_CL("266666669Hz", "4cycles"), HasSubstr("more cycles at 266666669Hz"));
  EXPECT_EQ(at_CL("400000001Hz", "5cycles"), "");
  EXPECT_THAT(at_CL("400000002Hz", "5cycles"), HasSubstr("more cycles at 400000002Hz"));
  EXPECT_EQ(at_CL("533333334Hz", "7cycles"), "");
  EXPECT_THAT(at_CL("533333336Hz", "7cycles"), HasSubstr("125MHz .. 533MHz, DDR2"));
  EXPECT_THAT(at_CL("124999998Hz", "4cycles"), HasSubstr("125MHz .. 533MHz, DDR2"));
  const std::vector<std::pair<std::string, std::string>> mobile = {
      {"ddr.part", "mt46h32m16lf"}, {"ddr.banks", "4"},      {"ddr.CL", "3cycles"},
      {"ddr.clock", "166MHz"},      {"ddr.tREFI", "1290cycles"}};
  const auto with = [&](const char* key, const char* value) {
    auto keys = mobile;
    keys.emplace_back(key, value);
    return keys;
  };
  EXPECT_EQ(play(mobile), "");
  EXPECT_THAT(said, testing::IsEmpty());
  EXPECT_EQ(play(with("ddr.clock", "20MHz")), "") << "no DLL, no floor";
  EXPECT_THAT(said, testing::ElementsAre(HasSubstr("SDRCR RR: 1290 clocks programmed, "
                                                   "MT46H32M16LF-6 needs tREFI at most 7800 ns = "
                                                   "156 at 20 MHz"),
                                         HasSubstr("SDTIMR2 T_RASMAX: 8 x 1290 clocks")));
  EXPECT_THAT(play(with("ddr.clock", "201MHz")), HasSubstr("1MHz .. 200MHz, mobile DDR"));
  EXPECT_THAT(play(with("ddr.CL", "4cycles")), HasSubstr("2 or 3 cycles, mobile DDR"));
  EXPECT_THAT(play(with("ddr.CL", "2cycles")), HasSubstr("more cycles at 166MHz"));
  EXPECT_EQ(play(with("ddr.clock", "200MHz")), "");
  EXPECT_THAT(said, testing::Contains(HasSubstr("CL 3 has tCK 6 ns at least")));
  EXPECT_EQ(play({{"ddr.tRRD", "2cycles"}}), "");
  EXPECT_THAT(said, testing::Contains("SDTIMR T_RRD: 2 clocks programmed, MT47H64M16-3 needs tRRD "
                                      "10 ns = 3 at 243 MHz: 1 short"));
}

/// A trace whose content is spoilt but whose checksums are right again: plays, or one line says why
/// it cannot.
TEST(ReplayPathTest, NoTraceCrashesIt) {
  Rng rng(9);
  unsigned played = 0, refused = 0;
  for (int n = 0; n < 1500; ++n) {
    trace::TraceInfo info = board_info();
    trace::TraceWriter writer(3);
    for (std::uint64_t k = 0; k < 40; ++k)
      for (unsigned s = 0; s < 3; ++s) {
        Record r = random_record(rng, s, k);
        if (rng.below(60) == 0) {  // a wild field
          switch (rng.below(9)) {
            case 0: r.address = static_cast<std::uint32_t>(rng.next()); break;
            case 1: r.bytes = static_cast<std::uint8_t>(rng.next()); break;
            case 2: r.gap = rng.next() >> rng.below(64); break;
            case 3: r.at = rng.next() >> rng.below(64); break;
            case 4: r.back = static_cast<std::uint32_t>(rng.below(60)); break;
            case 5: r.event = rng.next() >> rng.below(64); break;
            case 6: r.source = static_cast<std::uint8_t>(rng.below(kMasterCount)); break;
            case 7: r.locked = true; break;
            default: r.critical = static_cast<std::uint8_t>(rng.next()); break;
          }
        }
        writer.add(s, r);
      }
    if (rng.below(10) == 0) info.streams[0].clock = Frequency(1 + rng.next() % 2'000'000'000'000);
    if (rng.below(10) == 0) info.masters[rng.below(4)].reads = static_cast<unsigned>(rng.below(40));
    if (rng.below(10) == 0) info.start = rng.next() >> rng.below(64);
    std::string bytes;
    writer.finish(info, [&](std::string_view piece) { bytes += piece; });
    const std::string error = error_of([&] {
      trace::TraceFile file("t", bytes);
      // Hours of refreshes between two records are not worth their checkers.
      Played(file.info(), file, rng.below(2), {{"ddr.check", "none"}});
    });
    ++(error.empty() ? played : refused);
  }
  EXPECT_GT(played, 300u);
  EXPECT_GT(refused, 300u);
}

}  // namespace
}  // namespace fovea::replay
