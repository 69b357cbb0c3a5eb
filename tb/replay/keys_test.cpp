// The statistics of a replay against independent observation, and the effect of each of its keys.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <ostream>

#include "tb/replay/played.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using trace::Record;
using trace::Release;

/// Three masters under load, reads and writes mixed.
std::string mixed_load(std::uint64_t seed) {
  Rng rng(seed);
  std::string text = master_lines(3, 4);
  for (unsigned i = 0; i < 4000; ++i)
    text += fmt::format("{} {} {} 0x{:x} {}\n", rng.below(2) * i * 60'000, rng.below(3),
                        rng.below(3) == 0 ? 'W' : 'R', rng.below(1u << 20) * 64,
                        4u << rng.below(5));
  return text;
}

/// At the ports, by master and direction: from issue to a read's first beat, to a write's end.
struct Ports : MemObserver {
  std::map<Master, std::array<std::vector<Picoseconds>, 2>> took;
  void submitted(const MemRequest&, bool) override {}
  void responded(const MemRequest& r) override {
    took[r.master][r.write].push_back((r.write ? r.last : r.first) - r.issued);
  }
};

Picoseconds quantile(const std::vector<Picoseconds>& sorted, unsigned percent) {
  return sorted[(sorted.size() * percent + 99) / 100 - 1];
}

// The histogram's buckets are 1/256 of their value wide at most and give their upper edge.
TEST(ReplayFiguresTest, PercentilesAreThoseOfTheSortedLatencies) {
  trace::TextTrace t("t", mixed_load(1));
  Ports seen;
  const Played p(t.info(), t, false, {}, &seen);
  const auto value = figures(p);
  for (unsigned m = 0; m < 3; ++m) {
    std::vector<Picoseconds>& reads = seen.took[trace::TextTrace::port(m)][0];
    ASSERT_GT(reads.size(), 700u);
    std::sort(reads.begin(), reads.end());
    for (const auto& [percent, beside] : {std::pair{50u, 55u}, {95u, 90u}, {99u, 95u}}) {
      const auto mine = static_cast<double>(quantile(reads, percent));
      const double printed =
          1e12 * value.at(fmt::format("ddr.m{}.latency.p{}", m, percent));
      EXPECT_GE(printed, mine - 1) << "m" << m << " p" << percent;
      EXPECT_LE(printed, mine * (1 + 1.0 / 256) + 1) << "m" << m << " p" << percent;
      const auto other = static_cast<double>(quantile(reads, beside));
      EXPECT_GT(std::abs(other - mine), mine / 100) << "the load cannot tell them apart";
    }
    EXPECT_NEAR(1e12 * value.at(fmt::format("ddr.m{}.latency.max", m)),
                static_cast<double>(reads.back()), 1);
  }
}

TEST(ReplayFiguresTest, WaitsAddUpToTheTimesAtThePort) {
  trace::TextTrace t("t", mixed_load(2));
  Ports seen;
  const Played p(t.info(), t, false, {}, &seen);
  const auto value = figures(p);
  for (unsigned m = 0; m < 3; ++m) {
    std::array<double, 2> took{};
    for (const bool write : {false, true}) {
      const auto& times = seen.took[trace::TextTrace::port(m)][write];
      ASSERT_GT(times.size(), 300u);
      for (const Picoseconds one : times) took[write] += static_cast<double>(one);
      double waited = 0;
      const std::string rows = fmt::format("ddr.m{}.wait.{}.", m, write ? "write" : "read");
      for (const auto& [name, v] : value)
        if (name.starts_with(rows)) waited += 1e12 * v;
      EXPECT_NEAR(waited, took[write], 10) << rows;
    }
    EXPECT_GT(std::abs(took[0] - took[1]), took[0] / 10) << "reads for writes would not show";
  }
}

TEST(ReplayFiguresTest, AGapCountsFromTheBeatThatTheRecordNames) {
  for (const bool first : {false, true}) {
    const trace::TraceInfo info = board_info();
    Listed l;
    Record one = read_at(2'000'000, 0x1000), two = read_at(0, 0x9000);
    one.master = two.master = Master::kVpbe;  // its stream counts picoseconds
    one.bytes = 64;
    two.release = Release::kAfter;
    two.back = 1;
    two.from_first = first;
    two.gap = 123'457;
    l.records[2] = {one, two};
    struct : MemObserver {
      std::vector<std::array<Picoseconds, 2>> beats;
      void submitted(const MemRequest&, bool) override {}
      void responded(const MemRequest& r) override { beats.push_back({r.first, r.last}); }
    } seen;
    const Played p(info, l, false, {}, &seen);
    ASSERT_EQ(seen.beats.size(), 2u);
    // Eight beats of 64 bits, seven crossbar clocks from the first to the last.
    EXPECT_NEAR(static_cast<double>(seen.beats[0][1] - seen.beats[0][0]), 7e6 / 121.5, 2);
    EXPECT_EQ(p.issued[2].at(1), seen.beats[0][first ? 0 : 1] + 123'457);
  }
}

/// When each record of streams 1 and 2 was done, told by marks of stream 0 that wait for it.
std::array<std::vector<Picoseconds>, 2> ends_at_the_input(std::array<std::uint8_t, 2> priority,
                                                         bool write) {
  trace::TraceInfo info = board_info();
  info.streams[0] = {};  // counts picoseconds
  for (auto& m : info.masters) m.reads = m.writes = 24;
  Listed l;
  constexpr unsigned kEach = 24;
  Rng rng(6);
  for (const unsigned s : {1u, 2u}) {
    for (unsigned n = 0; n < kEach; ++n) {
      // The second master's come when the first one's fill the FIFO and the input register.
      const auto address = static_cast<std::uint32_t>(rng.below(1u << 20) * 64);
      Record r = read_at(990'000 + s * 10'000, address);
      r.master = s == 1 ? Master::kVpfe : Master::kVpbe;
      r.priority = priority[s - 1];
      r.write = write;
      r.bytes = 64;
      l.records[s].push_back(r);
      Record mark = read_at(0, 0);
      mark.kind = trace::Kind::kMark;
      mark.release = Release::kWhen;
      mark.source = static_cast<std::uint8_t>(s);
      mark.event = n;
      l.records[0].push_back(mark);
    }
  }
  const Played p(info, l, true, {{"ddr.tREFI", "0cycles"}});
  std::array<std::vector<Picoseconds>, 2> ends;
  for (std::size_t i = 0; i < p.issued[0].size(); ++i) ends[i / kEach].push_back(p.issued[0][i]);
  return ends;
}

// How equal masters take turns is another matter; a master's own requests keep their order.
TEST(MemoryOnlyTest, TheOldestOfAMasterGoesToTheInputFirst) {
  for (const bool write : {false, true})
    for (const std::array<std::uint8_t, 2> priority : {std::array<std::uint8_t, 2>{7, 7}, {7, 0}})
      for (const auto& of_master : ends_at_the_input(priority, write)) {
        ASSERT_EQ(of_master.size(), 24u);
        EXPECT_TRUE(std::is_sorted(of_master.begin(), of_master.end())) << "write " << write;
      }
}

TEST(MemoryOnlyTest, TheUrgentGoToTheInputFirst) {
  for (const bool write : {false, true}) {
    const auto ends = ends_at_the_input({7, 0}, write);
    // Of the first master eight at most are inside or in the input register when the second one's come. When
    // its tenth goes in, all the urgent ones have, and but for the eight places they are done.
    EXPECT_GT(ends[0][9], ends[1][15]) << "write " << write;
    EXPECT_LT(ends[0][0], ends[1][15]);
  }
}

// Each key of the SDRAM's timing, by what it moves. Both clocks are 250 MHz and the crossbar is
// left out, so that a clock more is a clock later, exactly.
constexpr Picoseconds kClock = 4'000;

Keys base_keys() {
  return {{"ddr.clock", "250MHz"},  {"bus.clock", "250MHz"},  {"ddr.CL", "5cycles"},
          {"ddr.RL", "7cycles"},    {"ddr.tRFC", "40cycles"}, {"ddr.tRP", "7cycles"},
          {"ddr.tRCD", "6cycles"},  {"ddr.tWR", "7cycles"},   {"ddr.tRAS", "20cycles"},
          {"ddr.tRC", "27cycles"},  {"ddr.tRRD", "5cycles"},  {"ddr.tWTR", "4cycles"},
          {"ddr.tRTP", "3cycles"},  {"ddr.tREFI", "0cycles"}};
}

struct KeyEffect {
  const char* name;
  std::string key, from, to;
  Keys beside;
  std::string records;  // of masters 0 and 1, time in clocks
  double moves;         // clocks that the figure grows by
  std::function<double(Played&)> figure;
};
std::ostream& operator<<(std::ostream& os, const KeyEffect& e) { return os << e.name; }

double clocks(double ps) { return ps / static_cast<double>(kClock); }
double end(Played& p) { return clocks(static_cast<double>(p.path->duration())); }
double longest_read(Played& p) {
  return clocks(static_cast<double>(p.path->latency(trace::TextTrace::port(0)).read_first().max()));
}

std::string record(unsigned clock, unsigned master, char direction, unsigned address,
                   unsigned bytes = 8) {
  return fmt::format("{} {} {} 0x{:x} {}\n", clock * kClock, master, direction, address, bytes);
}
/// Rows are 16 KiB apart in a bank, banks 2 KiB.
constexpr unsigned kRow = 16'384, kBank = 2'048;

class KeyEffectTest : public testing::TestWithParam<KeyEffect> {};

TEST_P(KeyEffectTest, MovesTheFigureByWhatItSays) {
  const KeyEffect& e = GetParam();
  const auto play = [&](const std::string& value) {
    Keys keys = base_keys();
    keys.insert(keys.end(), e.beside.begin(), e.beside.end());
    keys.emplace_back(e.key, value);
    trace::TextTrace t("t", master_lines(2, 16) + e.records);
    Played p(t.info(), t, true, keys);
    return e.figure(p);
  };
  EXPECT_DOUBLE_EQ(play(e.to) - play(e.from), e.moves);
}

std::string lone_read() { return record(100, 0, 'R', 0); }
std::string row_conflict() { return record(100, 0, 'R', 0) + record(100, 0, 'R', kRow); }
/// The read comes when the write has its column command.
std::string write_then_read(unsigned address) {
  return record(100, 0, 'W', 0) + record(109, 0, 'R', address);
}
std::string far_apart(unsigned second) {
  return record(100, 0, 'R', 0) + record(400, 0, 'R', second);
}
/// Forty reads of an open row, and one of another row in its bank.
std::string hits_and_one_conflict() {
  std::string text;
  for (unsigned n = 0; n < 40; ++n) text += record(100, 1, 'R', n * 16, 16);
  return text + record(125, 0, 'R', kRow);
}
/// One row is read for 6.5 intervals of 1000 clocks, 4 clocks a read.
std::string long_stream() {
  std::string text;
  for (unsigned n = 0; n < 1'625; ++n) text += record(100, 1, 'R', n % 128 * 16, 16);
  return text;
}
/// Refresh never goes before a request.
Keys patient_refresh(std::string interval) {
  return {{"ddr.tREFI", std::move(interval)}, {"ddr.refresh.need", "32"},
          {"ddr.refresh.must", "64"}, {"ddr.refresh.gap", "64"}};
}
/// With a pipeline of no clocks, which would hide the shorter times.
Keys asleep(std::string how) {
  return {{"ddr.low_power", std::move(how)}, {"ddr.request_latency", "0cycles"},
          {"ddr.tXP", "8cycles"}, {"ddr.tXSNR", "34cycles"}, {"ddr.tXSRD", "1cycles"}};
}
double overdue(Played& p) { return static_cast<double>(p.path->memory().overdue_rows.count()); }

INSTANTIATE_TEST_SUITE_P(
    Keys, KeyEffectTest,
    testing::Values(
        KeyEffect{"CL", "ddr.CL", "5cycles", "6cycles", {{"ddr.RL", "1cycles"}}, lone_read(), 1,
                  end},
        KeyEffect{"RL", "ddr.RL", "7cycles", "8cycles", {}, lone_read(), 1, end},
        KeyEffect{"tRCD", "ddr.tRCD", "6cycles", "7cycles", {}, lone_read(), 1, end},
        KeyEffect{"tRP", "ddr.tRP", "7cycles", "8cycles", {}, row_conflict(), 1, end},
        // ACT, and 20 clocks later PRE, beyond RD + 5.
        KeyEffect{"tRAS", "ddr.tRAS", "20cycles", "21cycles", {}, row_conflict(), 1, end},
        // tRAS + tRP are 27.
        KeyEffect{"tRC", "ddr.tRC", "27cycles", "28cycles", {}, row_conflict(), 1, end},
        KeyEffect{"tRC hidden", "ddr.tRC", "26cycles", "27cycles", {}, row_conflict(), 0, end},
        // RD 6 behind ACT, PRE 4 + tRTP - 2 behind RD.
        KeyEffect{"tRTP", "ddr.tRTP", "3cycles", "4cycles",
                  {{"ddr.tRAS", "6cycles"}, {"ddr.tRC", "12cycles"}}, row_conflict(), 1, end},
        KeyEffect{"tRTP hidden", "ddr.tRTP", "3cycles", "4cycles", {}, row_conflict(), 0, end},
        // PRE WL + 4 + tWR = 15 behind WR, 21 behind ACT.
        KeyEffect{"tWR", "ddr.tWR", "7cycles", "8cycles", {}, write_then_read(kRow), 1, end},
        KeyEffect{"tWTR", "ddr.tWTR", "4cycles", "5cycles", {}, write_then_read(64), 1, end},
        // RD of the first 8 behind its ACT, off the way of the second ACT.
        KeyEffect{"tRRD", "ddr.tRRD", "5cycles", "6cycles", {{"ddr.tRCD", "8cycles"}},
                  record(100, 0, 'R', 0) + record(100, 1, 'R', kBank), 1, end},
        // A replay of text begins with its first request. The REF of the first interval, for which the row of that
        // request is closed at clock 1001, is under way when the second request comes.
        KeyEffect{"tRFC", "ddr.tRFC", "40cycles", "41cycles", {{"ddr.tREFI", "1000cycles"}},
                  record(0, 1, 'R', 0) + record(1'010, 0, 'R', 0), 1, end},
        KeyEffect{"tREFI", "ddr.tREFI", "1000cycles", "1001cycles", {},
                  record(0, 1, 'R', 0) + record(1'010, 0, 'R', 0), 1, end},
        // Open row instead of a closed bank: tRCD less.
        KeyEffect{"page", "ddr.page", "2048B", "4096B", {}, far_apart(2'048), -6, end},
        // Other row instead of a closed bank: tRP more.
        KeyEffect{"banks", "ddr.banks", "8", "4", {}, far_apart(4 * kBank), 7, end},
        KeyEffect{"bank_on_top", "ddr.bank_on_top", "false", "true", {}, far_apart(kBank), 7, end},
        KeyEffect{"old_count", "ddr.old_count", "8", "9", {}, hits_and_one_conflict(), 4,
                  longest_read},
        // Asleep since the start, awake when the read comes.
        KeyEffect{"low_power", "ddr.low_power", "off", "power_down", asleep("off"), lone_read(), 8,
                  end},
        KeyEffect{"tXP", "ddr.tXP", "7cycles", "8cycles", asleep("power_down"), lone_read(), 1,
                  end},
        KeyEffect{"tXSNR", "ddr.tXSNR", "34cycles", "35cycles", asleep("self_refresh"), lone_read(),
                  1, end},
        KeyEffect{"tXSRD", "ddr.tXSRD", "200cycles", "201cycles", asleep("self_refresh"),
                  lone_read(), 1, end},
        KeyEffect{"clock_restart", "ddr.clock_restart", "1cycles", "2cycles", asleep("clock_stop"),
                  lone_read(), 1, end},
        // RD at 115 or so, asleep ten clocks later: the second comes just then.
        KeyEffect{"tCKE", "ddr.tCKE", "7cycles", "8cycles", asleep("power_down"),
                  lone_read() + record(127, 0, 'R', 0), 1, end},
        KeyEffect{"row_intervals 1", "ddr.row_intervals", "2", "1", patient_refresh("1000cycles"),
                  long_stream(), 6 - 3, overdue},
        KeyEffect{"row_intervals 2", "ddr.row_intervals", "3", "2", patient_refresh("1000cycles"),
                  long_stream(), 3 - 2, overdue}));

}  // namespace
}  // namespace fovea::replay
