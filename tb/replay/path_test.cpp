// The player of bus traces: windows, figures, and times compared with those of the cores driven
// directly.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <array>
#include <deque>

#include "model/memsys/bypass.h"
#include "tb/dram/path.h"
#include "tb/replay/played.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using trace::Record;

TEST(ReplayPathTest, TimesAreThoseOfTheCoresDrivenByHand) {
  Rng rng(1);
  std::string text = master_lines(3, 16);
  dram::Path hand(Frequency(243'000'000), Frequency(121'500'000));
  mem::DdrConfig config = app::ReplayParams().config();  // the settings of a trace that has none
  for (const unsigned interval : {0u, config.refresh_interval}) {
    config.refresh_interval = interval;  // counts from time 0, as in a replay
    hand.ddr.configure(config, 0);
  }
  struct Sent {
    dram::PathRequest request;
    std::array<std::uint8_t, 64> data;
  };
  std::deque<Sent> sent;
  Picoseconds at = 0;  // a replay begins with the first request
  for (int n = 0; n < 3000; ++n) {
    if (n > 0) at += 20'000 + rng.below(300'000);  // seldom more than a few under way
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
    const bus::LatencyHistogram got = played.path->latency(trace::TextTrace::port(m)).read_first();
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
  const bus::LatencyHistogram h = alone.path->latency(trace::TextTrace::port(0)).read_first();
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
    const bus::LatencyHistogram h = p.path->latency(trace::TextTrace::port(0)).read_first();
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
    EXPECT_EQ(rows[3].end, 5'000'000 + p.path->duration());  // it begins with the first request
    EXPECT_EQ(rows[3].write_bytes, (std::vector<std::uint64_t>{0, 4}));
    EXPECT_EQ(rows[0].start, 5'000'000u);
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

// Keys have whole hertz: one that is less than a hertz from the recorded clock means that one.
TEST(ReplayPathTest, AKeyThatIsAHertzAwayIsAnotherClock) {
  const auto duration = [](const Frequency& recorded, const char* key) {
    trace::TraceInfo info = board_info();
    info.ddr.frequency = recorded;
    Listed l;
    l.records[1] = {read_at(50'000'000'000, 0)};  // where the edges of two clocks a hertz apart are 200 ps apart
    l.records[1][0].master = Master::kVpfe;
    return Played(info, l, true, {{"ddr.clock", key}, {"ddr.tREFI", "0cycles"}}).path->duration();
  };
  const Frequency whole(243'000'000), half(486'000'001, 2);
  EXPECT_NE(duration(whole, "243000001Hz"), duration(whole, "243MHz"));
  EXPECT_NE(duration(whole, "242999999Hz"), duration(whole, "243MHz"));
  EXPECT_EQ(duration(half, "243000001Hz"), duration(half, "243MHz"));
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

// Eight masters with a bank each keep the data bus busy however many requests wait at the controller: equals
// take turns there as in the crossbar (TheoryTest has the formula).
TEST(ReplayPathTest, EqualsTakeTurnsAtTheController) {
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

// The bypass by itself: the most urgent request goes first, equals in turn after the master that went last, and one
// master's requests in their order.
TEST(BypassTest, TheMostUrgentGoesFirstAndEqualsTakeTurns) {
  memsys::Bypass bypass(kPsPerUs);
  std::deque<MemRequest> requests;
  const auto wait = [&](unsigned master, unsigned priority) {
    MemRequest& r = requests.emplace_back();
    r.master = static_cast<Master>(master);
    r.in_path.priority = static_cast<std::uint8_t>(priority);
    r.bytes = 8;
    bypass.wait(r);
  };
  const auto all = [&] {
    std::vector<std::size_t> order;  // by place in `requests`
    while (bypass.any_waits() && order.size() < 20) {
      MemRequest& r = bypass.next();
      bypass.count(r, 0);
      for (std::size_t i = 0; i < requests.size(); ++i)
        if (&requests[i] == &r) order.push_back(i);
    }
    requests.clear();
    return order;
  };
  using V = std::vector<std::size_t>;
  constexpr unsigned kLast = kMasterCount - 1;
  for (const unsigned m : {1u, 0u, kLast, 2u}) wait(m, 3);
  EXPECT_EQ(all(), (V{0, 3, 2, 1})) << "after master 0";
  for (const unsigned m : {0u, 0u, 1u, 0u}) wait(m, 3);
  EXPECT_EQ(all(), (V{2, 0, 1, 3})) << "after master 0 again";
  wait(1, 7);
  wait(kLast, 6);
  EXPECT_EQ(all(), (V{1, 0})) << "a step of priority is more than all turns";
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
  double read = 0, written = 0, transactions = 0;
  for (unsigned m = 0; m < 3; ++m) {
    read += value.at(fmt::format("bus.m{}.read_bytes", m));
    written += value.at(fmt::format("bus.m{}.write_bytes", m));
    transactions += value.at(fmt::format("bus.m{}.transactions", m));
  }
  EXPECT_EQ(read, value.at("ddr.read_bytes"));
  EXPECT_EQ(written, value.at("ddr.write_bytes"));
  EXPECT_EQ(transactions, 3000);
}

TEST(ReplayPathTest, ATraceOfNothingHasNoRates) {
  Listed nothing;
  const auto value = figures(Played(board_info(), nothing));
  EXPECT_EQ(value.at("replay.time"), 0);
  EXPECT_EQ(value.at("replay.requests"), 0);
  for (const char* rate : {"replay.bandwidth", "ddr.utilisation", "ddr.efficiency", "ddr.headroom"})
    EXPECT_FALSE(value.contains(rate)) << rate;
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
    return std::pair(p.path->latency(Master::kVpfe).read_first().mean(),
                     p.path->latency(Master::kVpbe).read_first().mean());
  };
  const auto one = means(0, 7), two = means(7, 0);
  EXPECT_LT(one.first * 1.1, one.second);
  EXPECT_LT(two.second * 1.1, two.first);
}

}  // namespace
}  // namespace fovea::replay
