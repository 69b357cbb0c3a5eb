// The data sheets of the parts in clocks, and the warnings about software that programs less.
#include <gtest/gtest.h>

#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

// Nanoseconds of JESD79-2 and of the makers' data sheets, rounded up to clocks by hand.
TEST(PartTest, NumbersInClocksAsWorkedOutByHand) {
  const DataSheet a = in_clocks(find_part("mt47h64m16"), Frequency(243'000'000), 4);
  EXPECT_EQ(a.tRCD, 4u);
  EXPECT_EQ(a.tRP, 4u);
  EXPECT_EQ(a.tRRD, 3u);
  EXPECT_EQ(a.tFAW, 13u);
  EXPECT_EQ(a.tWR, 4u);
  EXPECT_EQ(a.tWTR, 2u);
  EXPECT_EQ(a.tRTP, 2u);
  EXPECT_EQ(a.tRFC, 31u);
  EXPECT_EQ(a.tREFI, 1895u);
  const DataSheet b = in_clocks(find_part("mt47h128m16"), Frequency(340'000'000), 5);
  EXPECT_EQ(b.tRCD, 5u);
  EXPECT_EQ(b.tRRD, 4u);
  EXPECT_EQ(b.tFAW, 16u);
  EXPECT_EQ(b.tWR, 6u);
  EXPECT_EQ(b.tRFC, 67u);
  EXPECT_EQ(b.tREFI, 2652u);
  EXPECT_EQ(in_clocks(find_part("mt47h32m16"), Frequency(243'000'000), 4).tRFC, 26u);
  EXPECT_EQ(in_clocks(find_part("mt47h32m16"), Frequency(243'000'000), 4).tFAW, 0u);
  const DataSheet m = in_clocks(find_part("mt46h64m16lf"), Frequency(500'000'000, 3), 3);
  EXPECT_EQ(m.tRCD, 3u);
  EXPECT_EQ(m.tRP, 3u);
  EXPECT_EQ(m.tRAS, 7u);
  EXPECT_EQ(m.tRC, 10u);
  EXPECT_EQ(m.tRRD, 2u);
  EXPECT_EQ(m.tWR, 3u);
  EXPECT_EQ(m.tWTR, 1u);
  EXPECT_EQ(m.tRFC, 21u);
  EXPECT_EQ(m.tREFI, 1300u);
}

TEST(PartTest, TooFastAClockIsAWarning) {
  EXPECT_EQ(PartChecker(find_part("mt47h64m16"), Frequency(340'000'000), 5).warnings().count("tCK"),
            1u);
  EXPECT_EQ(PartChecker(find_part("mt47h64m16"), Frequency(270'000'000), 4).warnings().count("tCK"),
            1u);
  EXPECT_EQ(PartChecker(find_part("mt47h64m16"), Frequency(270'000'000), 5).warnings().count("tCK"),
            0u);
  EXPECT_EQ(PartChecker(find_part("mt46h64m16lf"), Frequency(216'000'000), 3).warnings().count("tCK"),
            1u);
}

/// Three reads, 20 us apart, with self-refresh between them: what the part's sheet has against the commands.
std::string after_naps(const mem::DdrConfig& programmed, const Part& part, std::vector<mem::Cmd>& commands) {
  const Frequency clock(166'000'000);
  BenchOptions o;
  o.ddr = o.scr = clock;
  o.config = programmed;
  o.config.low_power = mem::LowPower::kSelfRefresh;
  DdrBench b(o);
  std::array<Request, 3> all;
  for (unsigned i = 0; i < 3; ++i) {
    all[i].address = at(0, i);
    EXPECT_TRUE(b.submit_at(all[i], (1 + i) * 20 * kPsPerUs));
    b.drain();
  }
  b.ddr.catch_up(80 * kPsPerUs);
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  PartChecker checker(part, clock, programmed.timing.CL);
  for (const Logged& l : b.log) {
    checker.command(translate(l.cmd), l.bank, l.row, l.clock);
    commands.push_back(l.cmd);
  }
  return checker.text();
}

TEST(PartTest, SelfRefreshAgainWithoutARefreshIsAWarningForDdr2AndDoesNotHappenToAMobilePart) {
  using enum mem::Cmd;
  const auto at_166 = [](const Part& p) {
    const DataSheet s = in_clocks(p, Frequency(166'000'000), 3);
    mem::DdrConfig c;
    mem::DdrTiming& t = c.timing;
    t.CL = 3, t.nRCD = s.tRCD, t.nRP = s.tRP, t.nRAS = s.tRAS, t.nRC = s.tRC, t.nRRD = std::max(s.tRRD, s.tFAW / 4 + 1);
    t.nWR = s.tWR, t.nWTR = s.tWTR, t.nRTP = s.tRTP, t.nRFC = s.tRFC, t.nXP = s.tXP, t.nCKE = s.tCKE;
    t.nXSNR = s.tXSNR, t.nXSRD = std::max(s.tXSNR, s.tXSRD), t.banks = s.banks, t.mobile = s.mobile;
    c.refresh_interval = s.tREFI;
    return c;
  };
  std::vector<mem::Cmd> commands;
  const Part ddr2 = find_part("mt47h64m16"), mobile = find_part("mt46h64m16lf");
  EXPECT_EQ(after_naps(at_166(ddr2), ddr2, commands),
            "REF between self-refreshes: 3 times, against the sheet of MT47H64M16-3 at 166 MHz\n");
  EXPECT_EQ(std::count(commands.begin(), commands.end(), kRef), 0);
  commands.clear();
  EXPECT_EQ(after_naps(at_166(mobile), mobile, commands), "");
  const std::vector<mem::Cmd> nap = {kSre, kSrx, kRef, kAct, kRd, kPreAll};
  std::vector<mem::Cmd> all;
  for (unsigned i = 0; i < 3; ++i) all.insert(all.end(), nap.begin(), nap.end());
  all.push_back(kSre);
  EXPECT_EQ(commands, all);
}

/// Reads that open eight banks one after the other, on a controller programmed so.
PartChecker::Warning warning(const mem::DdrConfig& programmed, const Part& p, const char* rule,
                             std::string* text = nullptr) {
  const Frequency clock(340'000'000);
  BenchOptions o;
  o.ddr = o.scr = clock;
  o.config = programmed;
  o.params = {{"command_fifo", "16"}};
  DdrBench b(o);
  std::array<Request, 8> all;
  for (unsigned i = 0; i < 8; ++i) {
    all[i].master = static_cast<Master>(i);
    all[i].address = at(0, i);
    EXPECT_TRUE(b.submit_at(all[i], 100'000));
  }
  b.drain();
  EXPECT_EQ(b.checker.total(), 0u) << "as programmed it is right\n" << b.checker.text();
  PartChecker checker(p, clock, programmed.timing.CL);
  for (const Logged& l : b.log) checker.command(translate(l.cmd), l.bank, l.row, l.clock);
  if (text) *text = checker.text();
  const auto found = checker.warnings().find(rule);
  return found == checker.warnings().end() ? PartChecker::Warning{} : found->second;
}

/// What a DM368 board ships with at 340 MHz (U-Boot, configs/cam_enc_4xx.h).
mem::DdrConfig shipped() {
  mem::DdrConfig c;
  c.timing.CL = 5;
  c.timing.nRFC = 67;
  c.timing.nRP = c.timing.nRCD = 5;
  c.timing.nWR = 6;
  c.timing.nRAS = 15;
  c.timing.nRC = 20;
  c.timing.nRRD = c.timing.nWTR = c.timing.nRTP = 3;
  c.read_latency = 7;
  c.refresh_interval = 1896;
  return c;
}

TEST(PartTest, ShippedProgrammingIsShortOfTheSheetInTrrdAndTfaw) {
  std::string text;
  const Part p = find_part("mt47h128m16");
  const auto tRRD = warning(shipped(), p, "tRRD", &text);
  // The first read is due five clocks after its ACT, the others each four later, and take the
  // command bus: ACTs at 0, 3, 6, 10 (for 9), 14, 18, 22, 26.
  EXPECT_EQ(tRRD.count, 2u);
  EXPECT_EQ(tRRD.worst_clocks, 1u);
  const auto tFAW = warning(shipped(), p, "tFAW");
  EXPECT_EQ(tFAW.count, 2u) << "14 - 0 and 18 - 3 are below 16";
  EXPECT_EQ(tFAW.worst_clocks, 2u);
  EXPECT_NE(text.find("tRRD: 2 times, at worst 1 clock (2.94 ns) short of MT47H128M16-25E"),
            std::string::npos)
      << text;
}

TEST(PartTest, ProgrammingByTheSheetLeavesNoWarning) {
  mem::DdrConfig c = shipped();
  c.timing.nRRD = 4;  // four times four clocks are tFAW too
  std::string text;
  EXPECT_EQ(warning(c, find_part("mt47h128m16"), "tRRD", &text).count, 0u);
  EXPECT_EQ(text, "");
}

TEST(PartTest, EachNumberOneClockShortIsNamed) {
  unsigned mem::DdrTiming::*const numbers[] = {&mem::DdrTiming::nRCD, &mem::DdrTiming::nRRD};
  const char* names[] = {"tRCD", "tRRD"};
  for (unsigned i = 0; i < 2; ++i) {
    mem::DdrConfig c = shipped();
    c.timing.nRRD = 4;
    c.timing.*numbers[i] -= 1;
    const auto w = warning(c, find_part("mt47h128m16"), names[i]);
    EXPECT_GT(w.count, 0u) << names[i];
    EXPECT_EQ(w.worst_clocks, 1u) << names[i];
  }
}

}  // namespace
}  // namespace fovea::dram
