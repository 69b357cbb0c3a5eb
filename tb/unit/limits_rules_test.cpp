// The rules of `fovea limits`: how it searches, when a run has kept up, which replay is believed, its tables.
#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "model/common/nearest.h"
#include "sw/fovea/limits/answers.h"
#include "sw/fovea/limits/binds.h"
#include "sw/fovea/limits/bisection.h"
#include "sw/fovea/limits/judge.h"
#include "sw/fovea/limits/relaxations.h"
#include "sw/fovea/limits/value_range.h"
#include "tb/unit/support.h"

namespace fovea::limits {
namespace {

using test::user_error;
using ::testing::HasSubstr;
using ::testing::Not;
using Answer = Bisection::Answer;

/// Plays a search against a rule, and counts what it asked for.
template <class Good>
Bisection::Outcome search(std::uint64_t last, unsigned probes, Good good, std::size_t* asked = nullptr) {
  Bisection b(last, probes);
  std::size_t n = 0;
  while (const auto v = b.next()) {
    const std::size_t most = b.at_most_left();
    b.tell(*v, good(*v));
    if (n++ > 200) break;
    // A probe that moves the edge may make it longer; a rule with one edge never does.
    EXPECT_GT(most, 0u);
  }
  if (asked) *asked = n;
  EXPECT_EQ(b.at_most_left(), 0u);
  return b.outcome();
}

TEST(BisectionTest, FindsEveryEdgeFromBothSides) {
  for (std::uint64_t last = 1; last <= 33; ++last)
    for (std::uint64_t edge = 0; edge < last; ++edge)
      for (const unsigned probes : {0u, 2u}) {
        auto o = search(last, probes, [&](auto v) { return v <= edge; });
        EXPECT_EQ(o.answer, Answer::kLargest);
        EXPECT_EQ(o.good, edge);
        EXPECT_EQ(o.bad, edge + 1);
        EXPECT_TRUE(o.monotonic);
        o = search(last, probes, [&](auto v) { return v > edge; });
        EXPECT_EQ(o.answer, Answer::kSmallest);
        EXPECT_EQ(o.good, edge + 1);
        EXPECT_EQ(o.bad, edge);
        EXPECT_TRUE(o.monotonic);
      }
}

TEST(BisectionTest, AsksLogarithmicallyAndForNoMoreThanItSays) {
  for (const std::uint64_t edge : {0u, 1u, 511u, 512u, 1022u}) {
    std::size_t asked = 0;
    search(1023, 0, [&](auto v) { return v <= edge; }, &asked);
    EXPECT_LE(asked, 12u);  // both ends and 10 halvings
    EXPECT_EQ(Bisection(1023, 0).at_most_left(), 12u);
    EXPECT_EQ(Bisection(1023, 3).at_most_left(), 15u);
  }
}

TEST(BisectionTest, BothEndsAlike) {
  EXPECT_EQ(search(64, 2, [](auto) { return true; }).answer, Answer::kAll);
  EXPECT_EQ(search(64, 2, [](auto) { return false; }).answer, Answer::kNone);
  EXPECT_TRUE(search(64, 2, [](auto) { return false; }).monotonic);
  EXPECT_EQ(search(0, 2, [](auto) { return true; }).answer, Answer::kAll);
}

// Rules drawn from a seed, with up to four changes between good and bad: what the search says of the values that it
// tried is so, and if it tries all of them, it is so of the whole range.
TEST(BisectionTest, WhatItSaysIsSoByBruteForce) {
  std::mt19937 random(41);
  for (int n = 0; n < 2000; ++n) {
    const std::uint64_t last = 1 + random() % 60;
    std::vector<std::uint64_t> changes(random() % 5);
    for (auto& c : changes) c = random() % (last + 1);
    const bool first = random() % 2;
    const auto good = [&](std::uint64_t v) {
      return first ^ (std::count_if(changes.begin(), changes.end(), [&](auto c) { return c <= v; }) % 2);
    };
    const unsigned probes = n % 2 ? 1000 : 2;
    Bisection b(last, probes);
    while (const auto v = b.next()) b.tell(*v, good(*v));
    std::vector<std::uint64_t> known;
    for (const auto& [value, was_good] : b.tried()) known.push_back(value);
    EXPECT_TRUE(probes == 2 || known.size() == last + 1);
    const auto o = b.outcome();
    const auto any = [&](auto rule) { return std::any_of(known.begin(), known.end(), rule); };
    const bool up = o.answer == Answer::kLargest;
    const auto beyond = [&](auto v) { return up ? v > o.bad : v < o.bad; };
    switch (o.answer) {
      case Answer::kLargest:
      case Answer::kSmallest:
        EXPECT_TRUE(good(up ? 0 : last));
        EXPECT_EQ(o.bad, up ? o.good + 1 : o.good - 1);
        EXPECT_FALSE(good(o.bad));
        EXPECT_FALSE(any([&](auto v) { return (up ? v <= o.good : v >= o.good) && !good(v); }));
        EXPECT_EQ(o.monotonic, !any([&](auto v) { return beyond(v) && good(v); }));
        EXPECT_TRUE(o.monotonic || (beyond(o.odd) && good(o.odd)));
        break;
      case Answer::kAll:
        EXPECT_FALSE(any([&](auto v) { return !good(v); }));
        break;
      case Answer::kBetween:
        EXPECT_TRUE(!good(0) && !good(last) && good(o.good) && !o.monotonic);
        break;
      case Answer::kNone:
        EXPECT_FALSE(any([&](auto v) { return good(v); }));
        break;
      case Answer::kUnknown:
        FAIL();
    }
  }
}

TEST(BisectionTest, AsksMoreWhereGoodAndBadAlternate) {
  const auto two = [](auto v) { return v <= 100 || (v > 600 && v <= 900); };
  std::size_t asked = 0, plain = 0;
  search(
      1023, 2, [](auto v) { return v <= 100; }, &plain);
  search(1023, 2, two, &asked);
  EXPECT_GE(asked, plain + Bisection::kMore);
  search(1023, 0, two, &asked);
  EXPECT_LE(asked, 12u) << "--probes 0 asks for nothing besides the edge";
}

TEST(BisectionTest, SaysThatGoodAndBadAlternate) {
  // Good again at the far end: the answer is still the first edge.
  auto o = search(100, 2, [](auto v) { return v <= 30 || v >= 70; });
  EXPECT_EQ(o.answer, Answer::kLargest);
  EXPECT_EQ(o.good, 30u);
  EXPECT_FALSE(o.monotonic);
  EXPECT_GE(o.odd, 70u);
  // Good again between the edge and a bad end: only a probe can see it.
  const auto island = [](auto v) { return v <= 10 || (v >= 40 && v <= 70); };
  o = search(100, 2, island);
  EXPECT_FALSE(o.monotonic);
  EXPECT_EQ(o.good, 10u);
  // A bad value in front of the first edge that was found moves the answer.
  const auto gap = [](auto v) { return v <= 60 && !(v >= 25 && v <= 40); };
  o = search(100, 8, gap);
  EXPECT_EQ(o.good, 24u);
  EXPECT_FALSE(o.monotonic);
  // Good only in the middle.
  o = search(100, 2, [](auto v) { return v >= 30 && v <= 70; });
  EXPECT_EQ(o.answer, Answer::kBetween);
  EXPECT_FALSE(o.monotonic);
  EXPECT_TRUE(o.good >= 30 && o.good < 40) << o.good;
}

points::PointResult result_of(std::map<std::string, double, std::less<>> stats) {
  points::PointResult r;
  for (const auto& [name, value] : stats) r.units[name] = "1";
  r.stats = std::move(stats);
  return r;
}

// Which masters a replay can do without, typed in apart from their table.
TEST(RelaxationsTest, AReplayLeavesOutEachMasterButTheCoreAndLoads) {
  const ParamSet none;
  std::vector<std::string> masters, busy;
  for (const Relaxation& r : relaxations(none, result_of({{"bus.remap_engine.transactions", 3}}))) {
    if (!r.replay || r.options.empty()) continue;
    EXPECT_EQ(r.options.front(), "--without");
    masters.push_back(fmt::format("{}: {} ({})", r.name, r.resource, r.options.back()));
    if (r.idle.empty()) busy.push_back(r.name);
  }
  EXPECT_THAT(masters, testing::UnorderedElementsAre(
                           "camera: the camera's traffic (vpfe)", "display: the display's traffic (vpbe)",
                           "edma_tc0: the traffic of EDMA controller 0 (edma_tc0)",
                           "edma_tc1: the traffic of EDMA controller 1 (edma_tc1)",
                           "edma_tc2: the traffic of EDMA controller 2 (edma_tc2)",
                           "edma_tc3: the traffic of EDMA controller 3 (edma_tc3)",
                           "remap_engine: the remap engine's traffic (remap_engine)"));
  EXPECT_THAT(busy, testing::ElementsAre("remap_engine"));
  // What the EDMA moves, others wait for.
  for (const Relaxation& r : relaxations(none, result_of({{"bus.edma_tc1.transactions", 3}})))
    EXPECT_TRUE(r.name != "edma_tc1" || r.idle == "the core waits for its transfers: no replay can leave them out")
        << r.idle;
}

TEST(JudgeTest, EachConditionAtItsBoundAndBeyond) {
  const std::map<std::string, double, std::less<>> good = {
      {"frame.dropped", 0}, {"frame.repeated", 0}, {"capture.overflows", 0}, {"display.underflows", 0}};
  EXPECT_TRUE(judge(result_of(good), default_conditions()).good());
  for (const auto& [name, zero] : good) {
    auto stats = good;
    stats[name] = 1;
    EXPECT_EQ(judge(result_of(stats), default_conditions()).kind, Verdict::Kind::kBad) << name;
    stats.erase(name);
    EXPECT_EQ(judge(result_of(stats), default_conditions()).kind, Verdict::Kind::kUnknown) << name;
  }
  auto stats = good;
  stats["camera.2.frame.dropped"] = 2;
  EXPECT_EQ(judge(result_of(stats), default_conditions()).why, "2 dropped frames (camera.2.frame.dropped)");
  // What is shown again while the decoder locks does not count; any other frame does.
  stats = good;
  stats["frame.repeated"] = 3;
  stats["frame.repeated_relock"] = 3;
  EXPECT_TRUE(judge(result_of(stats), default_conditions()).good());
  stats["frame.repeated_relock"] = 2;
  EXPECT_EQ(judge(result_of(stats), default_conditions()).why, "1 repeated frame");
  EXPECT_FALSE(judge(result_of(stats), conditions_with({"frame.repeated<=2"})).good());
  stats["frame.repeated_relock"] = 3;
  EXPECT_FALSE(judge(result_of(stats), conditions_with({"frame.repeated<=2"})).good()) << "what was asked for";
  EXPECT_EQ(text_of(default_conditions().at(0)), "no frame is dropped");
  EXPECT_EQ(text_of(conditions_with({"frame.repeated<=2"}).back()), "frame.repeated <= 2");
  stats = good;
  stats["frame.rate"] = 25;
  stats["frame.remap_time.mean"] = 0.04;
  EXPECT_TRUE(judge(result_of(stats), default_conditions()).good());
  stats["frame.remap_time.mean"] = 0.0404;
  EXPECT_EQ(judge(result_of(stats), default_conditions()).kind, Verdict::Kind::kBad);
  EXPECT_EQ(judge(result_of(stats), default_conditions()).why,
            "a remap takes 1.0 % more than a frame period on average, so that frames will be dropped");
  stats = good;
  stats["frame.rate"] = 24.9;
  EXPECT_TRUE(judge(result_of(stats), conditions_with({"frame.rate>=24.9"})).good());
  EXPECT_EQ(judge(result_of(stats), conditions_with({"frame.rate>=25"})).why,
            "frame.rate is 24.9, allowed: at least 25");
  stats["frame.dropped"] = 2;
  EXPECT_TRUE(judge(result_of(stats), conditions_with({"frame.dropped<=2"})).good());
  EXPECT_FALSE(judge(result_of(stats), conditions_with({"frame.dropped<=1"})).good());
  for (const char* wrong :
       {"", "frame.rate", "frame.rate>25", "frame.rate>=", ">=2", "frame.rate>=x", "a>=1x", "a>=nan", "a<=inf"})
    EXPECT_THAT(user_error([&] { conditions_with({wrong}); }), HasSubstr("METRIC<=NUMBER")) << wrong;
}

// A loop that has slipped once shows every frame from then on, a period later. In the window, that is one frame shown
// again; before the window, it is none. Both are good; what happens twice is not.
TEST(JudgeTest, ASlipIsNoLossAndWhatHappensTwiceIs) {
  std::map<std::string, double, std::less<>> stats = {{"frame.dropped", 0},
                                                      {"frame.repeated", 1},
                                                      {"capture.overflows", 0},
                                                      {"display.underflows", 0},
                                                      {"frame.displayed", 3},
                                                      {"frame.rate", 50.0 / 3},
                                                      {"frame.remap_time.mean", 0.0398},
                                                      {"frame.remap_time.max", 0.0399}};
  const auto conditions = default_conditions();
  Verdict v = judge(result_of(stats), conditions);
  EXPECT_FALSE(v.good());
  EXPECT_TRUE(v.longer) << "a longer window has to tell";
  EXPECT_TRUE(judge(result_of(stats), conditions, 1).good());
  EXPECT_NEAR(*steady_rate(result_of(stats)), 25, 1e-9);
  EXPECT_NEAR(*slack(result_of(stats)), 1 - 0.0399 * 25, 1e-9);
  // It does not count as a lower rate either, wherever it is; a repeated frame that is allowed is no slip.
  EXPECT_TRUE(judge(result_of(stats), conditions_with({"frame.rate>=25"}), 1).good());
  EXPECT_FALSE(judge(result_of(stats), conditions_with({"frame.rate>=25", "frame.repeated<=9"}), 1).good());
  // The slip does not hide that remaps take longer than a frame period.
  stats["frame.remap_time.mean"] = 0.0402;
  EXPECT_FALSE(judge(result_of(stats), conditions, 1).good());
  EXPECT_FALSE(judge(result_of(stats), conditions).longer);
  stats["frame.remap_time.mean"] = 0.0398;
  stats["frame.repeated"] = 2;
  v = judge(result_of(stats), conditions);
  EXPECT_FALSE(v.good() || v.longer);
  EXPECT_FALSE(judge(result_of(stats), conditions, 1).good());
  stats["frame.repeated_relock"] = 1;
  stats["frame.rate"] = 25.0 / 3;
  EXPECT_TRUE(judge(result_of(stats), conditions).longer) << "of the two, one was for the decoder's sake";
  stats["frame.dropped"] = 1;
  EXPECT_FALSE(judge(result_of(stats), conditions).longer) << "a drop is a loss";
  // A user's condition that no frame is repeated is taken literally.
  stats["frame.dropped"] = 0;
  stats["frame.repeated"] = 1;
  stats["frame.repeated_relock"] = 0;
  v = judge(result_of(stats), conditions_with({"frame.repeated<=0"}), 1);
  EXPECT_FALSE(v.good() || v.longer);
  EXPECT_EQ(longer_window(3), 27u);
  EXPECT_EQ(longer_window(23), 47u);
  EXPECT_EQ(longer_window(24), 48u);
  EXPECT_EQ(longer_window(25), 50u);
}

// Remaps of a few frames may take less than a period on average, and those of many more.
TEST(JudgeTest, ALongerWindowTellsWhereARemapTakesMoreThanAPeriod) {
  std::map<std::string, double, std::less<>> stats = {{"frame.dropped", 0},       {"frame.repeated", 0},
                                                      {"capture.overflows", 0},   {"display.underflows", 0},
                                                      {"frame.displayed", 3},     {"frame.rate", 25},
                                                      {"frame.remap_time.mean", 0.0398},
                                                      {"frame.remap_time.max", 0.04}};
  EXPECT_TRUE(judge(result_of(stats), default_conditions()).good());
  EXPECT_FALSE(judge(result_of(stats), default_conditions()).longer) << "a period is not more than a period";
  stats["frame.remap_time.max"] = 0.04001;
  EXPECT_TRUE(judge(result_of(stats), default_conditions()).good());
  EXPECT_TRUE(judge(result_of(stats), default_conditions()).longer);
  stats["frame.remap_time.mean"] = 0.0401;
  EXPECT_FALSE(judge(result_of(stats), default_conditions()).longer) << "that is known already";
}

points::PointResult replay_of(std::map<std::string, double, std::less<>> stats) { return result_of(std::move(stats)); }

TEST(ReplayTest, HoldsOnlyForAFigureThatFollowsTheRun) {
  const auto run = result_of({{"frame.remap_time.mean", 0.010}, {"frame.rate", 25}});
  const auto refused = [&](std::map<std::string, double, std::less<>> stats,
                           const char* metric = "frame.remap_time.mean") {
    return replay_refused(run, replay_of(std::move(stats)), metric);
  };
  EXPECT_EQ(refused({{"frame.remap_time.mean", 0.010}}), "");
  EXPECT_EQ(refused({{"frame.remap_time.mean", 0.010029}}), "");
  EXPECT_THAT(refused({{"frame.remap_time.mean", 0.010031}}), HasSubstr("0.3 % off"));
  EXPECT_THAT(refused({{"frame.remap_time.mean", 0.009969}}), HasSubstr("0.3 % off"));
  EXPECT_THAT(refused({{"frame.remap_time.mean", 0.010}}, "frame.rate"), HasSubstr("no such figure"));
  // Requests that keep their recorded times cannot follow another memory, however well they follow the recorded one.
  EXPECT_THAT(refused({{"frame.remap_time.mean", 0.010}, {"bus.edma_tc1.at_recorded_time", 1}}),
              HasSubstr("keeps the recorded times of 1 of edma_tc1's requests"));
  EXPECT_EQ(
      refused({{"frame.remap_time.mean", 0.010}, {"bus.vpfe.at_recorded_time", 9}, {"bus.vpbe.at_recorded_time", 9}}),
      "")
      << "pixels have times of their own";
  EXPECT_EQ(refused({{"frame.remap_time.mean", 0.010}, {"bus.arm_d.at_recorded_time", 2}}), "")
      << "what its first requests waited for lies before the recording";
  auto failed = replay_of({});
  failed.status = 2;
  failed.message = "it stops before its end";
  EXPECT_THAT(replay_refused(run, failed, "frame.rate"), HasSubstr("it stops before its end"));
}

TEST(NearestTest, NamesWhatWasMeant) {
  const std::vector<std::string> names = {"frame.remapped", "frame.remap_time.mean", "frame.rate", "cpu.ipc"};
  EXPECT_EQ(nearest_name("frame.remap.mean", names), "frame.remap_time.mean");
  EXPECT_EQ(nearest_name("frame.remaped", names), "frame.remapped");
  EXPECT_EQ(nearest_name("frame.rat", names), "frame.rate");
  EXPECT_EQ(nearest_name("power.sdram", names), "");
}

// Searches that run at once add their points in the order in which runs end.
TEST(PointsTableTest, HasTheSameOrderHoweverThePointsCame) {
  std::vector<points::PointResult> results(3);
  std::vector<points::Runner::Entry> entries;
  const char* const labels[] = {"b", "a", "b"};
  for (std::size_t k = 0; k < 3; ++k) {
    results[k].folder = fmt::format("F{}", k);
    points::Point p;
    p.label = labels[k];
    p.identity = std::to_string(k);
    entries.push_back({p, &results[k]});
  }
  std::sort(entries.begin(), entries.end(),
            [](const auto& x, const auto& y) { return x.point.identity < y.point.identity; });
  const std::string expected = points_csv(entries, {});
  std::istringstream rows(expected);
  std::string line, order;
  for (std::getline(rows, line); std::getline(rows, line);) order += line.substr(0, 2);
  // By label, then by key; the keys are hashes.
  EXPECT_EQ(order, points::key_of(entries[0].point) < points::key_of(entries[2].point) ? "F1F0F2" : "F1F2F0");
  do {
    EXPECT_EQ(points_csv(entries, {}), expected);
  } while (std::next_permutation(entries.begin(), entries.end(), [](const auto& x, const auto& y) {
    return x.point.identity < y.point.identity;
  }));
}

}  // namespace
}  // namespace fovea::limits
