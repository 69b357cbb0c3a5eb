// What a run says about programming that the part's data sheet forbids: each number at n - 1 and n,
// the words of real boot loaders, and the checkers of the command bus as a run has them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "model/common/check.h"
#include "model/mem/ddr_check.h"
#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Gt;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

struct Checked {
  struct Params : mem::DdrParams {
    explicit Params(const std::vector<std::pair<std::string, std::string>>& keys) {
      ParamSet set;
      set.add(*this);
      for (const auto& [key, value] : keys) set.set("ddr." + key, value);
    }
  } params;
  DdrBench bench;
  mem::DdrCheck check;
  explicit Checked(const std::vector<std::pair<std::string, std::string>>& keys, const BenchOptions& o = {})
      : params(keys), bench(o), check(params, bench.ddr, bench.diagnostics) {}
};

std::vector<std::string> violations(const mem::DdrConfig& c, const char* part, Frequency clock,
                                    const char* grade = "default") {
  Checked x({{"part", part}, {"grade", grade}});
  return x.check.violations(c, clock);
}

/// Exactly what JESD79-2 and Micron's data sheet ask of a -25E part of 2 Gb at 340 MHz.
mem::DdrConfig tight() {
  mem::DdrConfig c;
  auto& t = c.timing;
  t.CL = 5;
  t.nRFC = 67;
  t.nRP = t.nRCD = 5;
  t.nWR = 6;
  t.nRAS = 14;
  t.nRC = 19;
  t.nRRD = 4;
  t.nWTR = t.nRTP = 3;
  t.nXP = 2;
  t.nCKE = 3;
  t.nXSNR = 70;
  t.nXSRD = 200;
  c.refresh_interval = 2652;
  c.row_intervals = 8;  // 21,216 of 23,800 clocks
  c.low_power = mem::LowPower::kSelfRefresh;
  return c;
}
const Frequency k340(340'000'000);

TEST(ProgrammingTest, WithinTheSheetNothingIsSaid) {
  EXPECT_THAT(violations(tight(), "mt47h128m16", k340), IsEmpty());
}

TEST(ProgrammingTest, EachNumberOneClockShortIsNamedWithItsMargin) {
  const struct {
    unsigned mem::DdrTiming::*number;
    const char* line;
  } cases[] = {
      {&mem::DdrTiming::nRFC, "SDTIMR T_RFC: 66 clocks programmed, MT47H128M16-25E needs tRFC 195 ns "
                              "= 67 at 340 MHz: 1 short"},
      {&mem::DdrTiming::nRP, "SDTIMR T_RP: 4 clocks programmed, MT47H128M16-25E needs tRP 12.5 ns = "
                             "5 at 340 MHz: 1 short"},
      {&mem::DdrTiming::nRCD, "SDTIMR T_RCD: 4 clocks programmed, MT47H128M16-25E needs tRCD 12.5 ns "
                              "= 5 at 340 MHz: 1 short"},
      {&mem::DdrTiming::nWR, "SDTIMR T_WR: 5 clocks programmed, MT47H128M16-25E needs tWR 15 ns = 6 "
                             "at 340 MHz: 1 short"},
      {&mem::DdrTiming::nRAS, "SDTIMR T_RAS: 13 clocks programmed, MT47H128M16-25E needs tRAS 40 ns "
                              "= 14 at 340 MHz: 1 short"},
      {&mem::DdrTiming::nRC, "SDTIMR T_RC: 18 clocks programmed, MT47H128M16-25E needs tRC 55 ns = "
                             "19 at 340 MHz: 1 short"},
      {&mem::DdrTiming::nWTR, "SDTIMR T_WTR: 2 clocks programmed, MT47H128M16-25E needs tWTR 7.5 ns "
                              "= 3 at 340 MHz: 1 short"},
      {&mem::DdrTiming::nRTP, "SDTIMR2 T_RTP: 2 clocks programmed, MT47H128M16-25E needs tRTP 7.5 ns "
                              "= 3 at 340 MHz: 1 short"},
      {&mem::DdrTiming::nXP, "SDTIMR2 T_XP: 1 clock programmed, MT47H128M16-25E needs tXP 2 at 340 "
                             "MHz: 1 short"},
      {&mem::DdrTiming::nCKE, "SDTIMR2 T_CKE: 2 clocks programmed, MT47H128M16-25E needs tCKE 3 at "
                              "340 MHz: 1 short"},
      {&mem::DdrTiming::nXSNR, "SDTIMR2 T_XSNR: 69 clocks programmed, MT47H128M16-25E needs tXSNR "
                               "205 ns = 70 at 340 MHz: 1 short"},
      {&mem::DdrTiming::nXSRD, "SDTIMR2 T_XSRD: 199 clocks programmed, MT47H128M16-25E needs tXSRD "
                               "200 at 340 MHz: 1 short"},
  };
  for (const auto& x : cases) {
    mem::DdrConfig c = tight();
    c.timing.*x.number -= 1;
    EXPECT_THAT(violations(c, "mt47h128m16", k340), ElementsAre(x.line));
    c.timing.*x.number += 2;
    EXPECT_THAT(violations(c, "mt47h128m16", k340), IsEmpty()) << x.line;
  }
}

TEST(ProgrammingTest, TimesOfSleepCountOnlyWhereThePartSleeps) {
  mem::DdrConfig c = tight();
  c.timing.nXP = c.timing.nCKE = c.timing.nXSNR = c.timing.nXSRD = 1;
  EXPECT_EQ(violations(c, "mt47h128m16", k340).size(), 4u);
  c.low_power = mem::LowPower::kOff;
  EXPECT_THAT(violations(c, "mt47h128m16", k340), IsEmpty());
}

TEST(ProgrammingTest, RefreshAndOpenRowsAreBoundedAbove) {
  mem::DdrConfig c = tight();
  c.refresh_interval = 2653;
  EXPECT_THAT(violations(c, "mt47h128m16", k340),
              ElementsAre("SDRCR RR: 2653 clocks programmed, MT47H128M16-25E needs tREFI at most "
                          "7800 ns = 2652 at 340 MHz: 1 over"));
  c.refresh_interval = 2380;
  c.row_intervals = 10;
  EXPECT_THAT(violations(c, "mt47h128m16", k340), IsEmpty()) << "23,800 clocks are 70 us";
  c.refresh_interval = 2381;
  EXPECT_THAT(violations(c, "mt47h128m16", k340),
              ElementsAre("SDTIMR2 T_RASMAX: 10 x 2381 clocks programmed, MT47H128M16-25E needs "
                          "tRASmax at most 70000 ns = 23800 at 340 MHz: 10 over"));
}

TEST(ProgrammingTest, ClockBeyondTheGradeIsNamed) {
  const auto clock_is_named = [](std::uint64_t hertz) {
    const auto all = violations(tight(), "mt47h128m16", Frequency(hertz));
    return std::any_of(all.begin(), all.end(),
                       [](const auto& line) { return line.find("SDBCR CL") == 0; });
  };
  EXPECT_FALSE(clock_is_named(400'000'001)) << "a rounding of whole hertz";
  EXPECT_THAT(violations(tight(), "mt47h128m16", Frequency(400'000'002)),
              testing::Contains("SDBCR CL: 5 programmed at 400 MHz, MT47H128M16-25E: CL 5 has tCK "
                                "2.5 ns at least"));
  mem::DdrConfig c = tight();
  c.timing.CL = 2;
  EXPECT_THAT(violations(c, "mt47h128m16", k340),
              ElementsAre("SDBCR CL: 2 programmed at 340 MHz, MT47H128M16-25E: CL 2 is not offered"));
}

// 18 ns are three clocks of 6 ns, which no whole number of hertz is.
TEST(ProgrammingTest, HertzThatRoundAPeriodAreNoClockMore) {
  mem::DdrConfig c;
  auto& t = c.timing;
  t.CL = 3;
  t.nRCD = t.nRP = 3, t.nRAS = 7, t.nRC = 10, t.nRRD = 2, t.nWR = 3, t.nWTR = 1, t.nRFC = 12;
  t.banks = 4, t.mobile = true;
  c.row_intervals = 8;
  for (const std::uint64_t hertz : {166'666'666u, 166'666'667u}) {
    c.refresh_interval = hertz == 166'666'666u ? 1299 : 1300;  // 7.8 us, rounded down
    EXPECT_THAT(violations(c, "mt46h32m16lf", Frequency(hertz)), IsEmpty()) << hertz;
  }
  // 1.3 Hz beyond.
  EXPECT_THAT(violations(c, "mt46h32m16lf", Frequency(166'666'668)),
              testing::Contains("SDTIMR T_RCD: 3 clocks programmed, MT46H32M16LF-6 needs tRCD 18 ns "
                                "= 4 at 166.667 MHz: 1 short"));
  c.refresh_interval = 1301;
  EXPECT_THAT(violations(c, "mt46h32m16lf", Frequency(166'666'667)),
              ElementsAre(HasSubstr("needs tREFI at most 7800 ns = 1300 at 166.667 MHz: 1 over")));
}

/// What boot loaders program, in clocks (TI's UBL, device.c; U-Boot, cam_enc_4xx.h).
mem::DdrConfig words(unsigned RFC, unsigned RP, unsigned RCD, unsigned WR, unsigned RAS, unsigned RC,
                     unsigned RRD, unsigned WTR, unsigned RTP, unsigned RR, unsigned intervals) {
  mem::DdrConfig c;
  auto& t = c.timing;
  t.CL = 5;
  t.nRFC = RFC, t.nRP = RP, t.nRCD = RCD, t.nWR = WR, t.nRAS = RAS, t.nRC = RC;
  t.nRRD = RRD, t.nWTR = WTR, t.nRTP = RTP;
  c.refresh_interval = RR;
  c.row_intervals = intervals;
  return c;
}

// TI's own formula has tFAW as 4 tRRD + 2 tCK, so its loader is a clock or two short of a -3 part.
TEST(ProgrammingTest, WordsOfShippedLoaders) {
  EXPECT_THAT(violations(words(67, 5, 5, 6, 15, 20, 3, 3, 3, 1896, 9), "mt47h128m16", k340),
              ElementsAre("SDTIMR T_RRD: 3 clocks programmed, MT47H128M16-25E needs tRRD 10 ns = 4 "
                          "at 340 MHz: 1 short",
                          "SDTIMR T_RRD: 3 clocks programmed (4 tRRD = 12), MT47H128M16-25E needs tFAW 45 ns = "
                          "16 at 340 MHz: 4 short"));
  EXPECT_THAT(violations(words(31, 5, 5, 4, 11, 16, 3, 3, 2, 1895, 8), "mt47h64m16",
                         Frequency(243'000'000)),
              ElementsAre("SDTIMR T_RRD: 3 clocks programmed (4 tRRD = 12), MT47H64M16-3 needs tFAW 50 ns = "
                          "13 at 243 MHz: 1 short"));
  EXPECT_THAT(violations(words(28, 5, 5, 4, 10, 15, 3, 3, 2, 1684, 8), "mt47h64m16",
                         Frequency(216'000'000)),
              IsEmpty());
}

TEST(ProgrammingTest, MobilePartsHaveTheirOwnSheet) {
  mem::DdrConfig c = words(21, 3, 3, 3, 7, 10, 2, 1, 1, 1300, 8);
  c.timing.CL = 3;
  c.timing.banks = 4;
  c.timing.mobile = true;
  const Frequency clock(500'000'000, 3);
  EXPECT_THAT(violations(c, "mt46h64m16lf", clock), IsEmpty());
  c.timing.nWTR = 1;
  EXPECT_THAT(violations(c, "mt46h64m16lf", clock, "5"),
              ElementsAre("SDTIMR T_WTR: 1 clock programmed, MT46H64M16LF-5 needs tWTR 2 at 166.667 "
                          "MHz: 1 short"));
  EXPECT_THAT(violations(c, "mt46h64m16lf", Frequency(166'000'000), "75"),
              testing::Contains(HasSubstr("CL 3 has tCK 7.5 ns at least")));
  try {
    violations(c, "mt46h64m16lf", clock, "25e");
    FAIL();
  } catch (const UserError& e) {
    EXPECT_STREQ(e.what(), "key 'ddr.grade': '25e' is not allowed; ddr.part = mt46h64m16lf comes in "
                           "5, 6, 75");
  }
}

std::vector<std::pair<std::string, std::uint64_t>> warnings(const Checked& x) {
  std::vector<std::pair<std::string, std::uint64_t>> out;
  for (const auto& [what, count] : x.bench.diagnostics.counts()) out.emplace_back(what.second, count);
  return out;
}

/// Reads that open eight banks one after the other on a controller at 340 MHz.
void open_eight_banks(Checked& x) {
  static std::array<Request, 8> all;
  all.fill({});
  for (unsigned i = 0; i < 8; ++i) {
    all[i].master = static_cast<Master>(i);
    all[i].address = at(0, i);
    x.bench.submit_at(all[i], 100'000);
  }
  x.bench.drain();
}
mem::DdrConfig awake() {
  mem::DdrConfig c = tight();
  c.low_power = mem::LowPower::kOff;
  return c;
}
BenchOptions at_340(const mem::DdrConfig& c) {
  BenchOptions o;
  o.ddr = o.scr = k340;
  o.config = c;
  o.params = {{"command_fifo", "16"}};
  return o;
}

// As counted by hand in dram.part: two ACT a clock early, two fifth ACT two clocks early.
TEST(CommandCheckTest, RunsWarnAboutTheBusWithParameterMarginAndTime) {
  const mem::DdrConfig shipped = words(67, 5, 5, 6, 15, 20, 3, 3, 3, 1896, 9);
  for (const char* key : {"none", "commands"}) {
    Checked x({{"part", "mt47h128m16"}, {"check", key}}, at_340(shipped));
    open_eight_banks(x);
    if (std::string(key) == "none") {
      EXPECT_THAT(warnings(x), IsEmpty());
      continue;
    }
    const auto said = warnings(x);
    ASSERT_EQ(said.size(), 3u);
    EXPECT_THAT(said[0].first, HasSubstr("SDRAM command bus: tFAW, 1 clock (2.94 ns) short of "
                                         "MT47H128M16-25E at 340 MHz, first at 0.0000001"));
    EXPECT_THAT(said[1].first, HasSubstr("tFAW, 2 clocks (5.88 ns) short of"));
    EXPECT_THAT(said[2].first, HasSubstr("tRRD, 1 clock (2.94 ns) short of"));
    EXPECT_EQ(said[2].second, 2u);
    EXPECT_EQ(said[0].second + said[1].second, 2u);
  }
}

TEST(CommandCheckTest, NoWarningWithinTheSheet) {
  Checked x({{"part", "mt47h128m16"}, {"check", "commands"}}, at_340(awake()));
  open_eight_banks(x);
  EXPECT_THAT(warnings(x), IsEmpty());
}

// Before a boot loader has set it up the controller refreshes at a slow clock, and nothing is lost.
TEST(CommandCheckTest, NothingIsSaidBeforeTheFirstUse) {
  mem::DdrConfig c = awake();
  c.refresh_interval = 40'000;  // 9 intervals of 7.8 us are 23,868 clocks
  Checked x({{"part", "mt47h128m16"}, {"check", "commands"}}, at_340(c));
  x.bench.ddr.catch_up(10 * kPsPerMs);
  EXPECT_GT(x.bench.count(mem::Cmd::kRef), 10u);
  EXPECT_THAT(warnings(x), IsEmpty());
  Request r;
  x.bench.submit_at(r, 10 * kPsPerMs + 1);
  x.bench.drain();
  EXPECT_THAT(warnings(x), IsEmpty());
  x.bench.ddr.catch_up(20 * kPsPerMs);
  const std::string beyond = "tREFI, " + std::to_string(40'000 - 9 * 2'652) + " clocks (";
  EXPECT_THAT(warnings(x), Contains(Pair(HasSubstr(beyond), Gt(1u)))) << "9 tREFI of 2652 clocks";
}

// The model's commands against numbers that it was not given: its own defect, not the guest's.
TEST(CommandCheckDeathTest, CommandAgainstTheProgrammedTimingIsADefect) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto play = [](unsigned more) {
    Checked x({{"part", "mt47h128m16"}, {"check", "commands"}}, at_340(awake()));
    mem::DdrConfig other = awake();
    other.timing.nRCD += more;
    x.check.expect(other, k340, 0);
    open_eight_banks(x);
  };
  play(0);
  EXPECT_EXIT(play(1), testing::ExitedWithCode(4),
              "SDRAM command against the programmed timing: tRCD, bank 0, 1 clocks, at 0.0000001");
}

// Registers and clocks change under traffic: what was given before is not held against new numbers,
// what comes after is.
TEST(CommandCheckTest, FollowsChangesOfRegistersAndClock) {
  mem::DdrConfig c = awake();
  Checked x({{"part", "mt47h128m16"}, {"check", "commands"}}, at_340(c));
  Rng rng(7);
  std::vector<std::unique_ptr<Request>> all;
  Picoseconds now = 100'000;
  for (unsigned i = 0; i < 4000; ++i) {
    now += rng.below(40'000);
    if (rng.below(50) == 0) {
      while (x.bench.ddr.next_decision() <= now) x.bench.step();
      c.timing.nRCD = 5 + static_cast<unsigned>(rng.below(6));
      c.timing.nRP = 5 + static_cast<unsigned>(rng.below(6));
      c.timing.nWTR = 3 + static_cast<unsigned>(rng.below(6));
      c.timing.CL = 5 + static_cast<unsigned>(rng.below(2));
      x.bench.ddr.configure(c, now);
    }
    all.push_back(std::make_unique<Request>());
    Request& r = *all.back();
    r.write = rng.below(3) == 0;
    r.master = static_cast<Master>(rng.below(4));
    r.address = at(static_cast<unsigned>(rng.below(3)), static_cast<unsigned>(rng.below(4)));
    while (x.bench.input_taken()) {
      now = std::max(now, x.bench.ddr.next_decision());
      x.bench.step();
    }
    x.bench.submit_at(r, now);
  }
  x.bench.drain();
  EXPECT_THAT(warnings(x), IsEmpty()) << "and no defect either";
}

}  // namespace
}  // namespace fovea::dram
