// Timing presets against the checker's own data sheets and against figures worked out by hand.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "model/trace/core/text_trace.h"
#include "sw/fovea/replay/ddr_presets.h"
#include "sw/fovea/replay/replay_clocks.h"
#include "sw/fovea/replay/replay_path.h"
#include "sw/fovea/results/outputs.h"
#include "tb/own_diagnostics.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using testing::HasSubstr;
using Assignments = std::vector<std::string>;

/// Keys as `fovea replay` takes them: the trace's, those of `-s`, the preset.
struct Keyed {
  app::ReplayParams params;
  ParamSet set;
  app::Experiment experiment;
  std::vector<std::string> said;
  explicit Keyed(const Assignments& by_hand, const trace::TraceInfo& info = {})
      : experiment((params.declare(set), set)) {
    for (const auto& [key, value] : info.params) experiment.preset(key, value, "a.trace");
    for (const auto& a : by_hand) experiment.override_with(a);
    app::apply_clock_preset(params, experiment);
    app::apply_ddr_preset(params, info.ddr.frequency, experiment);
    said = app::follow_clocks(params, info, experiment);
    params.check();
  }
  std::string value(const char* key) const { return set.find(key)->text(); }
  std::string origin(const char* key) const { return experiment.origin(key).text(); }
};

/// The warnings about a random trace.
std::vector<std::string> warnings(const Keyed& setup) {
  Rng rng(7);
  std::string text = "# dramtrace 1\n# master 0 window 8 a\n# master 1 window 4 b\n";
  for (unsigned i = 0; i < 400; ++i)
    text += fmt::format("{} {} {} 0x{:x} {}\n", rng.below(2) * i * 60'000, rng.below(2),
                        rng.below(3) == 0 ? 'W' : 'R', rng.below(1u << 20) * 64,
                        4u << rng.below(5));
  trace::TextTrace t("t", text);
  const OwnDiagnostics diagnostics;
  app::ReplayPath path("t", t.info(), t, setup.params, false);
  EXPECT_TRUE(path.run_before(kNever));
  path.finish();
  std::vector<std::string> said;
  for (const auto& [what, n] : diagnostics.counts()) said.push_back(what.second);
  return said;
}

struct Sold {
  const char* part;
  std::vector<const char*> grades;
};
std::vector<Sold> sold() {
  const std::vector<const char*> ddr2 = {"default", "37e", "3", "25e", "25"},
                                 mobile = {"default", "5", "6", "75"};
  return {{"mt47h32m16", ddr2}, {"mt47h64m16", ddr2}, {"mt47h128m16", ddr2},
          {"mt46h32m16lf", mobile}, {"mt46h64m16lf", mobile}};
}

// The exact clock of the trace counts unless ddr.clock, in whole hertz, is another one. 15 ns are three
// clocks of up to 200 MHz and one hertz (whole hertz get that in the user's favour), and four above.
TEST(DdrPresetTest, TheTracesClockCountsUnlessTheKeyIsAHertzAway) {
  const auto tRCD = [](Frequency recorded) {
    trace::TraceInfo info;
    info.ddr.frequency = recorded;
    info.params = {{"ddr.clock", "200000001Hz"}};
    return Keyed({"ddr.part=mt47h64m16", "ddr.grade=3", "ddr.preset=data_sheet"}, info)
        .value("ddr.tRCD");
  };
  EXPECT_EQ(tRCD(Frequency(200'000'001)), "3 cycles");
  EXPECT_EQ(tRCD(Frequency(400'000'003, 2)), "4 cycles") << "half a hertz above: the trace's";
  EXPECT_EQ(tRCD(Frequency(200'000'002)), "3 cycles") << "a hertz above: the key's";
}

// A clock beyond the part's is limited where it is not set by hand, and refused where it is.
TEST(DdrPresetTest, NoPartGivesAWarningAtAnyClock) {
  unsigned played = 0, refused = 0, unrefreshed = 0, short_stays = 0;
  for (const Sold& s : sold())
    for (const char* grade : s.grades)
      for (const char* clock : {"", "20MHz", "83MHz", "125MHz", "133MHz", "166MHz", "200MHz",
                                "243MHz", "266MHz", "270MHz", "333MHz", "340MHz", "400MHz"}) {
        Assignments by_hand = {std::string("ddr.part=") + s.part,
                               std::string("ddr.grade=") + grade, "ddr.preset=data_sheet",
                               "ddr.check=commands"};
        if (*clock) by_hand.push_back(std::string("ddr.clock=") + clock);
        std::optional<Keyed> setup;
        try {
          setup.emplace(by_hand);
        } catch (const UserError& e) {
          ASSERT_NE(*clock, 0) << e.what();
          EXPECT_THAT(e.what(), HasSubstr("'ddr.clock'"));
          ++refused;
          continue;
        }
        EXPECT_THAT(warnings(*setup), testing::IsEmpty())
            << s.part << ", grade " << grade << ", " << clock;
        for (const char* sleep : {"self_refresh", "power_down"}) {
          by_hand.push_back(std::string("ddr.low_power=") + sleep);
          // What the sheets want of self-refresh and the controller does not do (assumed): a refresh of DDR2 between
          // two of them, and a least stay of tRFC of mobile DDR.
          const bool ddr2 = std::string_view(s.part).starts_with("mt47");
          for (const std::string& warning : warnings(Keyed(by_hand))) {
            EXPECT_THAT(warning, HasSubstr(ddr2 ? "REF between self-refreshes" : "tRFC in self-refresh"))
                << s.part << ", grade " << grade << ", " << clock << ", " << sleep;
            EXPECT_EQ(sleep, std::string_view("self_refresh"));
            ++(ddr2 ? unrefreshed : short_stays);
          }
        }
        ++played;
      }
  // Of the twelve clocks 37e, 3, 25e and 25 can 6, 8, 10 and 10 (DDR2 has none below 125 MHz), 5, 6
  // and 75 can 6, 5 and 4; the defaults are 37e, 3, 25e, 6, 6; and each without a clock.
  EXPECT_EQ(played, 3u * (6 + 8 + 10 + 10) + 6 + 8 + 10 + 2u * (6 + 5 + 4 + 5) + 3u * 5 + 2u * 4);
  EXPECT_EQ(played + refused, 13u * (3u * 5 + 2u * 4));
  EXPECT_GT(unrefreshed, 0u);
  EXPECT_GT(short_stays, 0u);
}

// A value set by hand wins, and the checkers find the one that is short.
TEST(DdrPresetTest, AClockLessGivesAWarning) {
  const std::map<std::string, int> short_of = {
      {"tRFC", -1}, {"tRP", -1}, {"tRCD", -1}, {"tWR", -1}, {"tRAS", -1}, {"tRC", -1},
      {"tWTR", -1}, {"tRTP", -1}, {"tRRD", -1}, {"tREFI", 1}};
  const Assignments preset = {"ddr.part=mt47h128m16", "ddr.grade=25e", "ddr.preset=data_sheet",
                              "ddr.clock=390MHz", "ddr.check=commands"};
  const Keyed whole(preset);
  EXPECT_THAT(warnings(whole), testing::IsEmpty());
  for (const auto& [name, by] : short_of) {
    const std::string key = "ddr." + name;
    const auto given = std::stoi(whole.value(key.c_str())) + by;
    Assignments by_hand = preset;
    by_hand.push_back(fmt::format("{}={}cycles", key, given));
    const Keyed setup(by_hand);
    EXPECT_EQ(setup.value(key.c_str()), fmt::format("{} cycles", given)) << "set by hand";
    EXPECT_THAT(warnings(setup), testing::Contains(HasSubstr(name == "tRRD" ? "tFAW" : name)));
  }
  EXPECT_THAT(warnings(Keyed({"ddr.grade=3", "ddr.preset=data_sheet", "ddr.clock=340MHz",
                             "ddr.CL=5cycles"})),
              testing::Contains(HasSubstr("CL 5 has tCK 3 ns at least")));
}

std::string numbers(const Keyed& s) {
  std::string out = s.value("ddr.clock");
  for (const char* key : {"CL", "RL", "tRCD", "tRP", "tRAS", "tRC", "tRRD", "tWR", "tWTR", "tRTP",
                          "tRFC", "tREFI"})
    out += fmt::format(" {}", std::stoi(s.value((std::string("ddr.") + key).c_str())));
  for (const char* key : {"ddr.row_intervals", "ddr.banks", "ddr.page"}) out += " " + s.value(key);
  return out;
}

// JEDEC times of each grade (sources: ddr_presets.cpp) with Micron's tRAS of 40 and tRC of 55 ns, in
// clocks rounded up; tRRD so that four times tRRD covers tFAW.
TEST(DdrPresetTest, NumbersByHand) {
  const auto of = [](const char* part, const char* grade, const char* clock) {
    Assignments by_hand = {std::string("ddr.part=") + part, std::string("ddr.grade=") + grade,
                           "ddr.preset=data_sheet"};
    if (*clock) by_hand.push_back(std::string("ddr.clock=") + clock);
    return numbers(Keyed(by_hand));
  };
  EXPECT_EQ(of("mt47h64m16", "default", ""), "243MHz 4 4 4 4 10 14 4 4 2 2 31 1895 8 8 2KiB");
  EXPECT_EQ(of("mt47h32m16", "3", "270MHz"), "270MHz 5 5 5 5 11 15 3 5 3 3 29 2106 8 4 2KiB");
  EXPECT_EQ(of("mt47h128m16", "25e", "340MHz"), "340MHz 5 5 5 5 14 19 4 6 3 3 67 2652 8 8 2KiB");
  EXPECT_EQ(of("mt47h64m16", "25", "340MHz"), "340MHz 6 6 6 6 14 19 4 6 3 3 44 2652 8 8 2KiB");
  // Without a clock by hand the program's own, 243 MHz, down to what the part can do.
  EXPECT_EQ(of("mt46h64m16lf", "6", ""),
            "166666666Hz 3 3 3 3 7 10 2 3 1 2 21 1299 8 4 2KiB");
  EXPECT_EQ(of("mt46h32m16lf", "75", "83MHz"), "83MHz 2 2 2 2 4 6 2 2 1 2 6 647 8 4 2KiB");
}

// JESD79-2: power-down takes two clocks to leave and three at least, self-refresh 200 clocks until the DLL has
// locked, and tRFC (127.5 ns with 1 Gb) and 10 ns to anything but a read.
TEST(DdrPresetTest, SleepByHand) {
  const Keyed k({"ddr.part=mt47h64m16", "ddr.preset=data_sheet"});
  EXPECT_EQ(k.value("ddr.tXP"), "2 cycles");
  EXPECT_EQ(k.value("ddr.tCKE"), "3 cycles");
  EXPECT_EQ(k.value("ddr.tXSRD"), "200 cycles");
  EXPECT_EQ(k.value("ddr.tXSNR"), "34 cycles");
  // Mobile DDR at 6 ns: 25 ns, two clocks, 200 ns; there is no DLL that has to lock.
  const Keyed mobile({"ddr.part=mt46h64m16lf", "ddr.grade=6", "ddr.preset=data_sheet", "ddr.clock=166666666Hz"});
  EXPECT_EQ(mobile.value("ddr.tXP"), "5 cycles");
  EXPECT_EQ(mobile.value("ddr.tCKE"), "2 cycles");
  EXPECT_EQ(mobile.value("ddr.tXSRD"), "1 cycles");
  EXPECT_EQ(mobile.value("ddr.tXSNR"), "34 cycles");
}

// ddr.clock is in whole hertz; tCK is 6 ns in grade 6 and 3 ns in grade 3.
TEST(DdrPresetTest, RoundedHertzAreTheClockOfTheGrade) {
  const auto of = [](const char* part, const char* grade, const char* clock) -> std::string {
    try {
      return numbers(Keyed({std::string("ddr.part=") + part, std::string("ddr.grade=") + grade,
                            "ddr.preset=data_sheet", std::string("ddr.clock=") + clock}));
    } catch (const UserError& e) {
      return e.what();
    }
  };
  EXPECT_EQ(of("mt46h64m16lf", "6", "166666666Hz"),
            "166666666Hz 3 3 3 3 7 10 2 3 1 2 21 1299 8 4 2KiB");
  EXPECT_EQ(of("mt46h64m16lf", "6", "166666667Hz"),
            "166666667Hz 3 3 3 3 7 10 2 3 1 2 21 1300 8 4 2KiB");
  EXPECT_THAT(of("mt46h64m16lf", "6", "166666668Hz"), HasSubstr("has no CL for it"));
  EXPECT_EQ(of("mt47h64m16", "3", "333333334Hz").substr(0, 19), "333333334Hz 5 5 5 5");
  // 5 ns is a whole number of hertz: one more is the same clock, two are not.
  EXPECT_EQ(of("mt47h64m16", "3", "200000001Hz").substr(0, 13), "200000001Hz 3");
  EXPECT_EQ(of("mt47h64m16", "3", "200000002Hz").substr(0, 13), "200000002Hz 4");
  EXPECT_THAT(of("mt47h64m16", "3", "333333335Hz"), HasSubstr("has no CL for it"));
}

TEST(DdrPresetTest, WhoSetWhatIsKept) {
  trace::TraceInfo info;
  info.ddr.frequency = Frequency(340'000'000);
  info.params = {{"ddr.clock", "340MHz"},   {"ddr.CL", "5cycles"},  {"ddr.RL", "7cycles"},
                 {"ddr.tRP", "6cycles"},    {"ddr.tRC", "23cycles"}, {"ddr.old_count", "254"},
                 {"ddr.part", "mt47h64m16"}};
  const Keyed recorded({}, info);
  EXPECT_EQ(recorded.value("ddr.tRP"), "6 cycles");
  EXPECT_EQ(recorded.value("ddr.tRFC"), "31 cycles");
  EXPECT_EQ(recorded.origin("ddr.tRP"), "a.trace");
  EXPECT_EQ(recorded.origin("ddr.tRFC"), "default");
  const Keyed s({"ddr.preset=data_sheet", "ddr.tRP=8cycles", "ddr.tREFI=900cycles"}, info);
  EXPECT_EQ(s.value("ddr.clock"), "333333333Hz");
  EXPECT_EQ(s.origin("ddr.clock"), "ddr.preset: mt47h64m16, grade 3");
  EXPECT_EQ(s.value("ddr.CL"), "5 cycles");
  EXPECT_EQ(s.value("ddr.RL"), "7 cycles") << "as far from CL as the board had it";
  EXPECT_EQ(s.value("ddr.tRP"), "8 cycles");
  EXPECT_EQ(s.origin("ddr.tRP"), "command line");
  EXPECT_EQ(s.value("ddr.tRC"), "21 cycles") << "contains tRAS, 14, and tRP, each rounded";
  EXPECT_EQ(s.value("ddr.tREFI"), "900 cycles");
  EXPECT_EQ(s.value("ddr.tRFC"), "43 cycles");
  EXPECT_EQ(s.origin("ddr.old_count"), "a.trace");
  EXPECT_THAT(app::config_json(s.set, s.experiment, {.version = "v"}),
              HasSubstr(R"("ddr.tRFC": {"value": "43 cycles", "unit": "cycles", "origin": )"
                        R"("ddr.preset: mt47h64m16, grade 3")"));
  const Keyed mobile({"ddr.preset=data_sheet", "ddr.part=mt46h64m16lf"}, info);
  EXPECT_EQ(mobile.origin("ddr.tRFC"), "ddr.preset: mt46h64m16lf, grade 6 (assumed)");
  EXPECT_EQ(mobile.origin("ddr.tRP"), "ddr.preset: mt46h64m16lf, grade 6");
  for (const char* key : {"ddr.tXP", "ddr.tCKE", "ddr.tXSNR"}) {
    EXPECT_EQ(mobile.origin(key), "ddr.preset: mt46h64m16lf, grade 6 (assumed)") << key;
    EXPECT_EQ(s.origin(key), "ddr.preset: mt47h64m16, grade 3") << key;
  }
  EXPECT_EQ(mobile.origin("ddr.tXSRD"), "ddr.preset: mt46h64m16lf, grade 6");
  // The trace's clock is exact where its key is not: 15 ns are four clocks of 3.75 ns, not five.
  info.ddr.frequency = Frequency(800'000'000, 3);
  info.params[0].second = "266666667Hz";
  info.params.back().second = "mt47h32m16";
  const Keyed exact({"ddr.preset=data_sheet", "ddr.grade=37e"}, info);
  EXPECT_EQ(exact.value("ddr.clock"), "266666667Hz");
  EXPECT_EQ(exact.value("ddr.tRCD"), "4 cycles");
}

// A trace stores a configuration as keys; they must give it back, each field of its own value.
TEST(ReplayKeysTest, AConfigurationSurvivesBeingStored) {
  mem::DdrConfig c;
  c.timing = {6, 44, 6, 7, 8, 17, 23, 4, 2, 3, 5, 70, 199, 2, 4, false};
  c.read_latency = 9;
  c.refresh_interval = 1111;
  c.row_intervals = 7;
  c.old_count = 33;
  c.page_log2 = 10;
  c.bank_on_top = true;
  for (const auto sleep : {mem::LowPower::kOff, mem::LowPower::kSelfRefresh,
                           mem::LowPower::kPowerDown, mem::LowPower::kClockStop}) {
    c.low_power = sleep;
    trace::TraceInfo info;
    info.params = app::replay_keys({}, c, Frequency(170'000'000), Frequency(340'000'000));
    const mem::DdrConfig back = Keyed({}, info).params.config();
    EXPECT_EQ(back.low_power, c.low_power);
    const auto numbers_of = [](const mem::DdrConfig& d) {
      const mem::DdrTiming& t = d.timing;
      return std::vector<unsigned>{t.CL, t.nRFC, t.nRP, t.nRCD, t.nWR, t.nRAS, t.nRC, t.nRRD,
                                   t.nWTR, t.nRTP, t.nXP, t.nXSNR, t.nXSRD, t.nCKE, t.banks,
                                   d.read_latency, d.refresh_interval, d.row_intervals,
                                   d.old_count, d.page_log2, d.bank_on_top};
    };
    EXPECT_EQ(numbers_of(back), numbers_of(c));
  }
}

trace::TraceInfo recorded_at_243() {
  trace::TraceInfo info;
  info.scr.frequency = Frequency(121'500'000);
  info.ddr.frequency = Frequency(243'000'000);
  info.streams = {{Frequency(297'000'000), 0, 2, 0}};
  info.params = {{"ddr.clock", "243MHz"}, {"bus.clock", "121500000Hz"}};
  return info;
}

// SYSCLK7 is twice SYSCLK4.
TEST(ReplayClocksTest, TheCrossbarFollowsTheSdram) {
  for (const bool of_text : {false, true}) {
    const trace::TraceInfo info = of_text ? trace::TraceInfo{} : recorded_at_243();
    const Keyed same({}, info);
    EXPECT_EQ(same.value("bus.clock"), "121500kHz");
    EXPECT_THAT(same.said, testing::IsEmpty());
    const Keyed unchanged({"ddr.clock=243MHz"}, info);
    EXPECT_THAT(unchanged.said, testing::IsEmpty());
    const Keyed faster({"ddr.clock=270MHz"}, info);
    EXPECT_EQ(faster.value("bus.clock"), "135MHz");
    EXPECT_EQ(faster.origin("bus.clock"), "half of ddr.clock");
    EXPECT_THAT(faster.said, testing::ElementsAre("bus.clock follows ddr.clock as on the chip: 135 "
                                                  "MHz, it was 121.5 MHz; set it to keep it"));
    const Keyed odd({"ddr.clock=333333333Hz"}, info);
    EXPECT_EQ(odd.value("bus.clock"), "166666667Hz");
    EXPECT_THAT(odd.said, testing::SizeIs(1));
  }
}

TEST(ReplayClocksTest, AClockByHandStaysAndIsNamed) {
  const Keyed kept({"ddr.clock=270MHz", "bus.clock=121500kHz"}, recorded_at_243());
  EXPECT_EQ(kept.value("bus.clock"), "121500kHz");
  EXPECT_THAT(kept.said, testing::ElementsAre("warning: bus.clock is 121.5 MHz; the chip's crossbar runs "
                                              "at half of ddr.clock, 135 MHz"));
  const Keyed alone({"bus.clock=135MHz"}, recorded_at_243());
  EXPECT_EQ(alone.value("bus.clock"), "135MHz");
  EXPECT_THAT(alone.said, testing::ElementsAre(HasSubstr("at half of ddr.clock, 121.5 MHz")));
  EXPECT_THAT(Keyed({"ddr.clock=270MHz", "bus.clock=135MHz"}, recorded_at_243()).said,
              testing::IsEmpty());
  // Whole hertz: one is no deviation, two are.
  EXPECT_THAT(Keyed({"bus.clock=121500001Hz"}, recorded_at_243()).said, testing::IsEmpty());
  EXPECT_THAT(Keyed({"bus.clock=121500002Hz"}, recorded_at_243()).said, testing::SizeIs(1));
}

TEST(ReplayClocksTest, PresetsAreThoseOfARun) {
  for (const board::ClockPreset& p : board::kClockPresets) {
    const Keyed s({fmt::format("clocks.preset={}", p.name)}, recorded_at_243());
    EXPECT_EQ(s.params.registers.clock(), static_cast<std::uint64_t>(p.ddr().hertz())) << p.name;
    EXPECT_EQ(2 * s.params.clocks.clock(), s.params.registers.clock()) << p.name;
    EXPECT_EQ(s.origin("ddr.clock"), fmt::format("clocks.preset: {}", p.name));
    const bool other_core = p.core().hertz() != 297e6;
    EXPECT_EQ(std::count_if(s.said.begin(), s.said.end(),
                            [](const std::string& line) {
                              return line.starts_with("warning: clocks.preset: the core stays at 297 "
                                                      "MHz as recorded, ");
                            }),
              other_core)
        << p.name;
  }
  const Keyed wins({"clocks.preset=297/270", "ddr.clock=243MHz"}, recorded_at_243());
  EXPECT_EQ(wins.value("ddr.clock"), "243MHz");
  EXPECT_EQ(wins.value("bus.clock"), "121500kHz");
  const Keyed none({}, recorded_at_243());
  EXPECT_EQ(none.value("clocks.preset"), "as_recorded");
  EXPECT_EQ(none.value("ddr.clock"), "243MHz");
}

// A recording names clocks, not the preset that a program may or may not have followed.
TEST(ReplayClocksTest, ARecordingHasNoPreset) {
  for (const auto& [key, value] :
       app::replay_keys({}, {}, Frequency(170'000'000), Frequency(340'000'000)))
    EXPECT_NE(key, "clocks.preset");
}

TEST(DdrPresetTest, AGradeOfAnotherKindIsRefused) {
  try {
    Keyed s({"ddr.preset=data_sheet", "ddr.part=mt46h64m16lf", "ddr.grade=25e"});
    FAIL() << s.value("ddr.CL");
  } catch (const UserError& e) {
    EXPECT_STREQ(e.what(), "key 'ddr.grade': '25e' is not allowed; ddr.part = mt46h64m16lf comes in "
                           "5, 6, 75");
  }
}

}  // namespace
}  // namespace fovea::replay
