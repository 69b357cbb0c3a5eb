// The player of bus traces: when each record is issued, by its release rule.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "tb/replay/played.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using trace::Record;
using trace::Release;

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
  const std::uint64_t wake = core.edge_at_or_after(info.interrupts[1].at) + 20;
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
  const Subscription observing = path.observe(o);
  EXPECT_TRUE(path.run_before(kNever));
  ASSERT_EQ(o.last[1].size(), kCount);
  for (unsigned n = 0; n < kCount; ++n) {
    ASSERT_EQ(o.issued[1][n], o.last[0][n]) << n;
    if (n >= 2) {
      ASSERT_EQ(o.issued[0][n], o.last[1][n - 2] + 700) << n;
    }
  }
}

TEST(ReplayPathTest, ACompletionLongAgoHoldsNoRequestUp) {
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
    FAIL() << "a deadlock that is not found";
  } catch (const UserError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("stops before its end"));
  }
}

// A write that waits in the memory's input register is acknowledged when it goes through, not before.
TEST(ReplayPathTest, AWriteIsAcknowledgedWhenItLeavesTheInputRegister) {
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
    mark.kind = trace::Kind::kMark;
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

// The write FIFO of 88 bytes takes a burst of 64; the next one waits in the input register, and behind it
// another master's word. When the burst goes in there is room for the word too: both are acknowledged then.
TEST(ReplayPathTest, AWordBehindAFullInputRegisterIsAcknowledgedWhenThatIsFree) {
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
    mark.kind = trace::Kind::kMark;
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

/// A core that reads `reads` times, a microsecond after the one before, and a display that reads every ten up to the
/// end of the window.
struct Windowed {
  trace::TraceInfo info = board_info();
  Listed l;
  app::ReplayParams params;
  std::map<std::string, double> figures;
  Outcomes seen;
  static constexpr unsigned kLines = 89;

  Windowed(unsigned reads, Picoseconds rest, bool comparable = true) {
    info.core_until = info.end - rest;
    l.records[0] = {read_at(2'000'000, 0x1000)};
    l.records[0].resize(reads, after(1, true, 297, 0x9000));
    for (unsigned n = 0; n < kLines; ++n) {
      l.records[2].push_back(read_at(2'000'000 + n * 10'000'000, n * 64));
      l.records[2].back().master = Master::kVpbe;
    }
    app::ReplayPath path("t", info, l, params, false);
    if (comparable) path.end_with_window();
    const Subscription observing = path.observe(seen);
    EXPECT_TRUE(path.run_before(kNever));
    EXPECT_TRUE(path.run_before(kNever)) << "it stays at its end";
    path.finish();
    for (const app::StatRow& row : path.stats())
      if (const auto* const n = std::get_if<std::uint64_t>(&row.value)) figures[row.name] = static_cast<double>(*n);
  }
  Picoseconds latest() const { return *std::max_element(seen.issued[0].begin(), seen.issued[0].end()); }
};

TEST(ReplayPathTest, TheRecordedWindowEndsAReplay) {
  const Windowed slow(2'000, 1'000'000);
  EXPECT_LT(slow.latest(), slow.info.end);
  EXPECT_GT(slow.latest(), slow.info.end - 3'000'000);
  EXPECT_GT(slow.figures.at("replay.left_out"), 1'000);
  EXPECT_EQ(slow.figures.at("replay.requests") + slow.figures.at("replay.left_out"), 2'000 + Windowed::kLines);
  const Windowed all(2'000, 1'000'000, false);
  EXPECT_EQ(all.figures.at("replay.requests"), 2'000 + Windowed::kLines);
  EXPECT_EQ(all.figures.at("replay.left_out"), 0);
}

/// It does not go on for longer after the core's last record than it did when it was recorded; unless the core had
/// nothing to do for more than a twentieth of the window by then.
TEST(ReplayPathTest, WhenTheCoreHasDoneAllAReplayEnds) {
  const trace::TraceInfo info = board_info();
  const Picoseconds most = (info.end - info.start) / 20;
  const Windowed fast(100, most);
  EXPECT_GT(fast.figures.at("replay.left_out"), 50);
  EXPECT_LT(fast.latest(), 200'000'000u);
  EXPECT_GT(fast.latest(), 100'000'000u + most);
  const Windowed idle(100, most + 1);
  EXPECT_EQ(idle.figures.at("replay.left_out"), 0);
  EXPECT_EQ(idle.latest(), idle.info.end - 18'000'000);
}

TEST(ReplayPathTest, MarksKeepTheirPlace) {
  const trace::TraceInfo info = board_info();
  Listed l;
  Record begin = after(1, true, 100, 0x4 | 7 << 4), end = after(2, true, 100, 0x5 | 7 << 4);
  begin.kind = end.kind = trace::Kind::kMark;
  end.back = 1;
  l.records[0] = {read_at(2'000'000, 0x1000), begin, after(2, false, 200, 0x9000), end};
  const Played p(info, l);
  ASSERT_EQ(p.path->remap_times().size(), 1u);
  const Picoseconds read_done = p.issued[0].at(2);
  EXPECT_GT(p.path->marks()[1].at, read_done);
  EXPECT_EQ(p.path->remap_times()[0], p.path->marks()[1].at - p.path->marks()[0].at);
}

}  // namespace
}  // namespace fovea::replay
