// The code of model/howto/parameter-and-statistic.md, and what it does.
#include <gtest/gtest.h>

#include "model/common/param.h"
#include "model/common/stats.h"

namespace fovea {
namespace {

struct BlinkerParams : ParamGroup {
  IntParam period{*this, "period", IntParam::Unit::kTime, 500 * kPsPerMs, kPsPerMs,
                  10 * kPsPerSecond, "time from one blink to the next", Origin::kChoice, ""};
  IntParam start_up{*this, "start_up", IntParam::Unit::kCycles, 4, 0, 64,
                    "clocks from reset to the first blink", Origin::kAssumed, "no public figure",
                    {"2 cycles", "8 cycles", "a few clocks, as in other blocks with a state machine"}};
  BlinkerParams() : ParamGroup("blinker") {}
};

struct BlinkerStats : StatGroup {
  Counter blinks{*this, "blinks", "1", "times the lamp went on"};
  Counter lit{*this, "lit", "ps", "time in which the lamp was on"};
  Formula mean{*this, "mean", "s", "mean length of a blink",
               [this]() -> StatBase::Value {
                 const auto n = static_cast<double>(blinks.count());
                 return n > 0 ? static_cast<double>(lit.count()) * 1e-12 / n : 0.0;
               }};
  BlinkerStats() : StatGroup("blinker") {}
};

TEST(BlinkerParamsTest, AreFoundByKeyAndCheckUnitAndRange) {
  BlinkerParams params;
  ParamSet set;
  set.add(params);
  set.set("blinker.period", "20ms");
  EXPECT_EQ(params.period(), 20 * kPsPerMs);
  EXPECT_THROW(set.set("blinker.period", "20"), UserError) << "no unit";
  EXPECT_THROW(set.set("blinker.period", "11s"), UserError) << "out of range";
  EXPECT_THROW(set.set("blinker.periods", "20ms"), UserError) << "no such key";
  EXPECT_EQ(set.find("blinker.start_up")->origin(), Origin::kAssumed);
}

TEST(BlinkerStatsTest, CountAndResetWithTheWindow) {
  BlinkerStats stats;
  stats.reset();  // the window opens
  ++stats.blinks;
  ++stats.blinks;
  stats.lit += 3 * kPsPerSecond;
  EXPECT_EQ(std::get<double>(stats.mean.value()), 1.5);
  EXPECT_EQ(stats.mean.name(), "blinker.mean");
  stats.reset();
  EXPECT_EQ(stats.blinks.count(), 0u);
  EXPECT_EQ(std::get<double>(stats.mean.value()), 0.0);
}

}  // namespace
}  // namespace fovea
