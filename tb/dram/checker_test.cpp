// The checker complains at n - 1 and is silent at n, for each rule; numbers are the
// relations of JESD79-2.
#include <gtest/gtest.h>

#include <ostream>
#include <vector>

#include "tb/dram/command_checker.h"

namespace fovea::dram {
namespace {

struct Step {
  Command command;
  unsigned bank;
  std::uint32_t row;
  std::uint64_t clock;
};

/// A command history whose last command is exactly at the limit of one rule.
struct Limit {
  const char* rule;
  std::vector<Step> steps;
};
std::ostream& operator<<(std::ostream& os, const Limit& l) { return os << l.rule; }

// Every rule here binds alone: the sheet's other numbers are small.
DataSheet sheet() {
  DataSheet s;
  s.CL = 5;
  s.tRCD = 5;
  s.tRP = 6;
  s.tRAS = 20;
  s.tRC = 40;
  s.tRRD = 7;
  s.tWR = 8;
  s.tWTR = 4;
  s.tRTP = 3;
  s.tRFC = 50;
  s.tFAW = 35;
  s.tXP = 6;
  s.tXSNR = 60;
  s.tXSRD = 90;
  s.tCKE = 5;
  s.banks = 8;
  return s;
}

using enum Command;

class CheckerTest : public testing::TestWithParam<Limit> {};

TEST_P(CheckerTest, ComplainsOneClockEarlyAndNotAtTheLimit) {
  for (const std::uint64_t early : {0u, 1u, 3u}) {
    CommandChecker checker(sheet());
    const auto& steps = GetParam().steps;
    for (std::size_t i = 0; i < steps.size(); ++i)
      checker.command(steps[i].command, steps[i].bank, steps[i].row,
                      steps[i].clock - (i + 1 == steps.size() ? early : 0));
    if (early == 0) {
      EXPECT_EQ(checker.total(), 0u) << checker.text();
      continue;
    }
    ASSERT_EQ(checker.total(), 1u) << checker.text();
    EXPECT_EQ(checker.complaints()[0].rule, GetParam().rule);
    EXPECT_EQ(checker.complaints()[0].missing, early);
    EXPECT_EQ(checker.complaints()[0].clock, steps.back().clock - early);
  }
}

// WL = CL - 1 = 4; a burst holds the data bus 4 clocks.
INSTANTIATE_TEST_SUITE_P(
    Rules, CheckerTest,
    testing::Values(
        Limit{"tRCD", {{kAct, 0, 1, 100}, {kRd, 0, 1, 105}}},
        Limit{"tRCD", {{kAct, 0, 1, 100}, {kWr, 0, 1, 105}}},
        Limit{"tRAS", {{kAct, 0, 1, 100}, {kPre, 0, 0, 120}}},
        Limit{"tRAS", {{kAct, 3, 1, 100}, {kPreAll, 0, 0, 120}}},
        Limit{"tRC", {{kAct, 0, 1, 100}, {kPre, 0, 0, 125}, {kAct, 0, 2, 140}}},
        Limit{"tRP", {{kAct, 0, 1, 100}, {kPre, 0, 0, 150}, {kAct, 0, 2, 156}}},
        Limit{"tRP", {{kAct, 0, 1, 100}, {kPre, 0, 0, 150}, {kRef, 0, 0, 156}}},
        Limit{"tRPA", {{kAct, 0, 1, 100}, {kPreAll, 0, 0, 150}, {kAct, 1, 2, 157}}},
        Limit{"tRPA", {{kAct, 0, 1, 100}, {kPreAll, 0, 0, 150}, {kRef, 0, 0, 157}}},
        Limit{"tRRD", {{kAct, 0, 1, 100}, {kAct, 1, 1, 107}}},
        Limit{"tFAW",
              {{kAct, 0, 1, 100},
               {kAct, 1, 1, 107},
               {kAct, 2, 1, 114},
               {kAct, 3, 1, 121},
               {kAct, 4, 1, 135}}},
        Limit{"RD to RD", {{kAct, 0, 1, 100}, {kRd, 0, 1, 110}, {kRd, 0, 1, 114}}},
        Limit{"WR to WR", {{kAct, 0, 1, 100}, {kWr, 0, 1, 110}, {kWr, 0, 1, 114}}},
        // RL + BL/2 + 1 - WL = 5 + 4 + 1 - 4 = 6
        Limit{"RD to WR", {{kAct, 0, 1, 100}, {kRd, 0, 1, 110}, {kWr, 0, 1, 116}}},
        // WL + BL/2 + tWTR = 4 + 4 + 4 = 12, also to another bank
        Limit{"tWTR", {{kAct, 0, 1, 100}, {kWr, 0, 1, 110}, {kRd, 0, 1, 122}}},
        Limit{"tWTR", {{kAct, 0, 1, 100}, {kAct, 1, 1, 107}, {kWr, 0, 1, 120}, {kRd, 1, 1, 132}}},
        // BL/2 + max(tRTP, 2) - 2 = 4 + 3 - 2 = 5
        Limit{"tRTP", {{kAct, 0, 1, 100}, {kRd, 0, 1, 130}, {kPre, 0, 0, 135}}},
        // WL + BL/2 + tWR = 4 + 4 + 8 = 16
        Limit{"tWR", {{kAct, 0, 1, 100}, {kWr, 0, 1, 130}, {kPre, 0, 0, 146}}},
        Limit{"tWR", {{kAct, 0, 1, 100}, {kWr, 0, 1, 130}, {kPreAll, 0, 0, 146}}},
        Limit{"tXP", {{kPde, 0, 0, 100}, {kPdx, 0, 0, 110}, {kAct, 0, 1, 116}}},
        Limit{"tXSNR", {{kSre, 0, 0, 100}, {kSrx, 0, 0, 110}, {kAct, 0, 1, 170}}},
        Limit{"tXSRD", {{kSre, 0, 0, 100}, {kSrx, 0, 0, 110}, {kAct, 0, 1, 175}, {kRd, 0, 1, 200}}},
        Limit{"tCKE", {{kPde, 0, 0, 100}, {kPdx, 0, 0, 105}}},
        Limit{"tCKE", {{kPde, 0, 0, 100}, {kPdx, 0, 0, 110}, {kPde, 0, 0, 115}}},
        // CL + BL/2 + 1 = 10; WL + BL/2 + tWTR = 12
        Limit{"RD to CKE low", {{kAct, 0, 1, 100}, {kRd, 0, 1, 110}, {kPde, 0, 0, 120}}},
        Limit{"WR to CKE low", {{kAct, 0, 1, 100}, {kWr, 0, 1, 110}, {kPde, 0, 0, 122}}},
        Limit{"tRP", {{kAct, 0, 1, 100}, {kPre, 0, 0, 150}, {kSre, 0, 0, 156}}},
        Limit{"tRPA", {{kAct, 0, 1, 100}, {kPreAll, 0, 0, 150}, {kSre, 0, 0, 157}}},
        Limit{"tRFC", {{kRef, 0, 0, 100}, {kSre, 0, 0, 150}}},
        // The part precharges by itself at RD + 5, tRP later it takes an ACT or REF.
        Limit{"tRP", {{kAct, 0, 1, 100}, {kRda, 0, 1, 140}, {kAct, 0, 2, 151}}},
        Limit{"tRP", {{kAct, 0, 1, 100}, {kRda, 0, 1, 130}, {kRef, 0, 0, 141}}},
        // At WR + WL + BL/2 + tWR = 146.
        Limit{"tRP", {{kAct, 0, 1, 100}, {kWra, 0, 1, 130}, {kAct, 0, 2, 152}}},
        Limit{"tRFC", {{kRef, 0, 0, 100}, {kAct, 0, 1, 150}}},
        Limit{"tRFC", {{kRef, 0, 0, 100}, {kRef, 0, 0, 150}}}));

/// The complaint about one illegal last command; empty if there is none.
std::string rule_of(const std::vector<Step>& steps, DataSheet s = sheet()) {
  CommandChecker checker(s);
  for (const Step& x : steps) checker.command(x.command, x.bank, x.row, x.clock);
  return checker.complaints().empty() ? "" : checker.complaints().back().rule;
}

// JESD79-2: behind self-refresh a DDR2 part wants a refresh at least before it is put back into it. JESD209 does not
// ask for it; SPRUH82C 14.2.8: TI's controller gives a mobile part one before any other command.
TEST(CheckerStateTest, ARefreshComesBetweenTwoSelfRefreshes) {
  const std::vector<Step> once = {{kSre, 0, 0, 100}, {kSrx, 0, 0, 200}, {kAct, 0, 1, 300}, {kPre, 0, 0, 350}};
  const auto then = [&](std::vector<Step> more) {
    more.insert(more.begin(), once.begin(), once.end());
    return more;
  };
  const auto again = then({{kSre, 0, 0, 400}});
  const auto refreshed = then({{kRef, 0, 0, 400}, {kSre, 0, 0, 500}, {kSrx, 0, 0, 600}});
  DataSheet s = sheet();
  EXPECT_EQ(rule_of(again, s), "");
  s.refresh_before_sleep = true;
  EXPECT_EQ(rule_of(again, s), "REF between self-refreshes");
  EXPECT_EQ(rule_of(refreshed, s), "");
  EXPECT_EQ(rule_of(then({{kPde, 0, 0, 400}}), s), "") << "power-down is no self-refresh";
  EXPECT_EQ(rule_of({{kSre, 0, 0, 100}}, s), "") << "the first one";
  s = sheet();
  s.refresh_after_sleep = true;
  EXPECT_EQ(rule_of(once, s), "REF after self-refresh");
  EXPECT_EQ(rule_of({{kSre, 0, 0, 100}, {kSrx, 0, 0, 200}, {kRef, 0, 0, 260}, {kAct, 0, 1, 310}}, s), "");
  // JESD209: a mobile part stays in self-refresh for tRFC at least.
  s = sheet();
  s.tSR = 50;
  EXPECT_EQ(rule_of({{kSre, 0, 0, 100}, {kSrx, 0, 0, 149}}, s), "tRFC in self-refresh");
  EXPECT_EQ(rule_of({{kSre, 0, 0, 100}, {kSrx, 0, 0, 150}}, s), "");
  EXPECT_EQ(rule_of({{kPde, 0, 0, 100}, {kPdx, 0, 0, 149}}, s), "") << "power-down is no self-refresh";
}

TEST(CheckerStateTest, RowStatesAreEnforced) {
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kAct, 0, 2, 200}}), "ACT on open bank");
  EXPECT_EQ(rule_of({{kRd, 0, 1, 100}}), "RD on closed bank");
  EXPECT_EQ(rule_of({{kWr, 0, 1, 100}}), "WR on closed bank");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kRd, 0, 2, 200}}), "RD on wrong row");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kWr, 0, 2, 200}}), "WR on wrong row");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kRd, 1, 1, 200}}), "RD on closed bank");
  EXPECT_EQ(rule_of({{kAct, 5, 1, 100}, {kRef, 0, 0, 200}}), "REF with open bank");
  EXPECT_EQ(rule_of({{kPre, 0, 0, 100}}), "PRE on closed bank");
  EXPECT_EQ(rule_of({{kAct, 8, 0, 100}}), "no such bank");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kRda, 0, 1, 130}, {kRd, 0, 1, 200}}), "RD on closed bank");
  EXPECT_EQ(rule_of({{kPde, 0, 0, 100}, {kAct, 0, 1, 200}}), "command while CKE is low");
  EXPECT_EQ(rule_of({{kSre, 0, 0, 100}, {kRef, 0, 0, 200}}), "command while CKE is low");
  EXPECT_EQ(rule_of({{kPdx, 0, 0, 100}}), "exit without entry");
  EXPECT_EQ(rule_of({{kPde, 0, 0, 100}, {kSrx, 0, 0, 200}}), "exit without entry");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kSre, 0, 0, 200}}), "self-refresh with open bank");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kPde, 0, 0, 200}}), "") << "power-down keeps rows";
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kPreAll, 0, 0, 150}, {kRd, 0, 1, 200}}),
            "RD on closed bank");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kPre, 0, 0, 150}, {kAct, 0, 2, 200}, {kRd, 0, 2, 210}}),
            "");
}

TEST(CheckerStateTest, OneCommandAClock) {
  DataSheet loose;
  loose.tRRD = 0;
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kAct, 1, 1, 100}}, loose), "one command a clock");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kAct, 1, 1, 101}}, loose), "");
}

TEST(CheckerStateTest, FourBanksPrechargeAllWithoutTheExtraClock) {
  DataSheet four = sheet();
  four.banks = 4;
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kPreAll, 0, 0, 150}, {kRef, 0, 0, 156}}, four), "");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kPreAll, 0, 0, 150}, {kRef, 0, 0, 155}}, four), "tRPA");
}

// WL = 1, no tRTP: RD to PRE 4, RD to WR CL + 4, WR to RD 1 + 4 + tWTR, WR to PRE 1 + 4 + tWR.
TEST(CheckerStateTest, MobilePartsHaveTheirOwnRelations) {
  const struct {
    const char* rule;
    Command first, then;
    unsigned clocks;
  } relations[] = {{"tRTP", kRd, kPre, 4},
                   {"RD to WR", kRd, kWr, 5 + 4},
                   {"tWTR", kWr, kRd, 1 + 4 + 4},
                   {"tWR", kWr, kPre, 1 + 4 + 8},
                   {"RD to RD", kRd, kRd, 4},
                   {"WR to WR", kWr, kWr, 4}};
  DataSheet mobile = sheet();
  mobile.mobile = true;
  mobile.banks = 4;
  mobile.tFAW = 0;
  for (const auto& r : relations)
    for (const unsigned early : {0u, 1u})
      EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {r.first, 0, 1, 130}, {r.then, 0, 1, 130 + r.clocks - early}},
                        mobile),
                early ? r.rule : "");
}

TEST(CheckerStateTest, RowsAreOpenForTrasmaxAtMost) {
  DataSheet s = sheet();
  s.tRASmax = 200;
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kPre, 0, 0, 300}}, s), "");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kPre, 0, 0, 301}}, s), "tRASmax");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kAct, 1, 1, 200}, {kPreAll, 0, 0, 300}}, s), "");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kAct, 1, 1, 200}, {kPreAll, 0, 0, 301}}, s), "tRASmax");
  // The part closes the row by itself five clocks after this RD.
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kRda, 0, 1, 295}}, s), "");
  EXPECT_EQ(rule_of({{kAct, 0, 1, 100}, {kRda, 0, 1, 296}}, s), "tRASmax");
}

// Other numbers count from their own clock on; open rows stay open.
TEST(CheckerStateTest, ChangedNumbersBindLaterCommandsOnly) {
  const auto rule = [](std::uint64_t second_act, std::uint64_t third_act) {
    CommandChecker checker(sheet());
    checker.command(kAct, 0, 1, 100);
    DataSheet slower = sheet();
    slower.tRRD = 9;
    slower.tRASmax = 100;
    checker.change(slower, 105);
    checker.command(kAct, 1, 1, second_act);
    checker.command(kAct, 2, 1, third_act);
    checker.command(kPre, 0, 0, 200);
    EXPECT_LE(checker.total(), 1u) << checker.text();
    return checker.total() ? checker.complaints()[0].rule : "";
  };
  EXPECT_EQ(rule(106, 115), "") << "6 clocks are below both numbers, but lie across the change";
  EXPECT_EQ(rule(106, 114), "tRRD");
  CommandChecker checker(sheet());
  checker.command(kAct, 0, 1, 100);
  checker.change(sheet(), 200);
  checker.command(kAct, 0, 2, 300);
  EXPECT_EQ(checker.total(), 1u);
  EXPECT_EQ(checker.complaints()[0].rule, "ACT on open bank");
}

// Each says where and when; `missing` is for times that are too short, by so many clocks.
TEST(CheckerStateTest, ComplaintsNameBankAndClock) {
  CommandChecker checker(sheet());
  checker.command(kAct, 3, 1, 100);
  checker.command(kSre, 0, 0, 200);
  ASSERT_EQ(checker.total(), 1u);
  EXPECT_EQ(checker.complaints()[0].clock, 200u);
  EXPECT_EQ(checker.complaints()[0].bank, 3u);
  EXPECT_EQ(checker.complaints()[0].missing, 0u);
}

// All are counted, the first hundred kept.
TEST(CheckerStateTest, KeepsTheFirstHundredComplaints) {
  CommandChecker checker(sheet());
  std::uint64_t reported = 0;
  checker.on_complaint = [&](const Complaint&) { ++reported; };
  for (std::uint64_t k = 0; checker.total() < 103; ++k) checker.command(kRd, 0, 0, 1000 + 100 * k);
  EXPECT_EQ(reported, 103u);
  ASSERT_EQ(checker.complaints().size(), 100u);
  EXPECT_EQ(checker.complaints()[0].clock, 1000u);
}

// Eight refreshes may be postponed, so two are at most nine intervals apart (JESD79-2).
TEST(CheckerStateTest, RefreshIsNeverMoreThanNineIntervalsLate) {
  DataSheet s = sheet();
  s.tREFI = 100;
  EXPECT_EQ(rule_of({{kRef, 0, 0, 900}}, s), "");
  EXPECT_EQ(rule_of({{kRef, 0, 0, 901}}, s), "tREFI");
  EXPECT_EQ(rule_of({{kRef, 0, 0, 500}, {kRef, 0, 0, 1400}}, s), "");
  EXPECT_EQ(rule_of({{kRef, 0, 0, 500}, {kRef, 0, 0, 1401}}, s), "tREFI");
  CommandChecker none(s);
  none.finish(900);
  EXPECT_EQ(none.total(), 0u);
  none.finish(901);
  EXPECT_EQ(none.total(), 1u);
}

// And at no time more than eight are owed, however close together two of them are.
TEST(CheckerStateTest, NoMoreThanEightRefreshesAreOwed) {
  DataSheet s = sheet();
  s.tREFI = 100;
  s.counts_postponed = true;
  EXPECT_EQ(rule_of({{kRef, 0, 0, 899}}, s), "") << "eight intervals have ended";
  EXPECT_EQ(rule_of({{kRef, 0, 0, 900}}, s), "postponed REF");
  // One REF at 100 pays for the first; the ninth of the others ends at 1000.
  EXPECT_EQ(rule_of({{kRef, 0, 0, 100}, {kRef, 0, 0, 999}}, s), "");
  EXPECT_EQ(rule_of({{kRef, 0, 0, 100}, {kRef, 0, 0, 1000}}, s), "postponed REF");
  // What is not owed yet is not paid for.
  EXPECT_EQ(rule_of({{kRef, 0, 0, 10}, {kRef, 0, 0, 60}, {kRef, 0, 0, 900}}, s), "postponed REF");
  // Five owed, one paid, five more: nine at 1000, a gap of five intervals.
  EXPECT_EQ(rule_of({{kRef, 0, 0, 500}, {kRef, 0, 0, 999}}, s), "") << "4 + 4";
  EXPECT_EQ(rule_of({{kRef, 0, 0, 500}, {kRef, 0, 0, 1000}}, s), "postponed REF");
  CommandChecker slept(s);
  slept.command(kSre, 0, 0, 850);
  slept.command(kSrx, 0, 0, 5000);
  slept.command(kRef, 0, 0, 5899);
  EXPECT_EQ(slept.total(), 0u) << slept.text();
  slept.command(kRef, 0, 0, 6800);
  EXPECT_EQ(slept.total(), 2u) << "8 - 1 + 10 owed, and a gap of 901 clocks";
  CommandChecker none(s);
  none.finish(899);
  EXPECT_EQ(none.total(), 0u);
}

}  // namespace
}  // namespace fovea::dram
