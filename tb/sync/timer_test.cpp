// The time service: when a timer fires, what the horizon is, and that an event notified behind the
// service's back is noticed.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "model/common/timer.h"

namespace fovea {
namespace {

/// Notes the time of each firing of one timer and of one bare event.
class Listener : public sc_core::sc_module {
 public:
  Timer timer;
  sc_core::sc_event bare;
  std::vector<Picoseconds> fired;
  explicit Listener(sc_core::sc_module_name name) : sc_module(name) {
    SC_HAS_PROCESS(Listener);
    SC_METHOD(note);
    sensitive << timer.event();
    dont_initialize();
  }
  void note() { fired.push_back(kernel_time()); }
};

class TimerTest : public testing::Test {
 public:
  static Listener* listener;  // modules cannot be made once the simulation has begun

 protected:
  void SetUp() override {
    listener->timer.cancel();
    listener->bare.cancel();
    advance(kPsPerNs);
    listener->fired.clear();
    start = kernel_time();
  }
  /// Lets everything happen up to and at the new time: sc_start() leaves what is due at its very end
  /// to the next call.
  static void advance(Picoseconds ps) {
    sc_core::sc_start(ps_time(ps));
    while (sc_core::sc_pending_activity_at_current_time()) sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
  Timer& timer = listener->timer;
  std::vector<Picoseconds>& fired = listener->fired;
  Picoseconds start = 0;
};
Listener* TimerTest::listener = nullptr;

TEST_F(TimerTest, FiresAtTheTimeAndNotAPicosecondBefore) {
  timer.at(start + 1000);
  advance(999);
  EXPECT_TRUE(fired.empty());
  advance(1);
  EXPECT_EQ(fired, std::vector{start + 1000});
}

TEST_F(TimerTest, AnEarlierTimeStaysAndALaterOneIsReplacedByIt) {
  timer.at(start + 500);
  timer.at(start + 700);
  advance(1000);
  EXPECT_EQ(fired, std::vector{start + 500});
  timer.at(start + 1700);
  timer.at(start + 1500);
  advance(1000);
  EXPECT_EQ(fired, (std::vector{start + 500, start + 1500}));
}

TEST_F(TimerTest, MovesToALaterTime) {
  timer.at(start + 500);
  timer.move_to(start + 700);
  advance(1000);
  EXPECT_EQ(fired, std::vector{start + 700});
}

TEST_F(TimerTest, NeverLeavesAtAloneAndEndsMoveTo) {
  timer.at(start + 500);
  timer.at(kNever);
  advance(1000);
  EXPECT_EQ(fired, std::vector{start + 500});
  timer.at(start + 1500);
  timer.move_to(kNever);
  advance(1000);
  EXPECT_EQ(fired.size(), 1u);
}

TEST_F(TimerTest, ATimeThatHasPassedIsTheNextDeltaCycle) {
  advance(10);
  timer.at(start + 3);
  EXPECT_TRUE(fired.empty()) << "not within the call";
  advance(1);
  EXPECT_EQ(fired, std::vector{start + 10});
  timer.soon();
  EXPECT_EQ(fired.size(), 1u);
  advance(1);
  EXPECT_EQ(fired, (std::vector{start + 10, start + 11}));
}

TEST_F(TimerTest, TheHorizonFollowsEveryUse) {
  Horizon horizon;
  EXPECT_EQ(horizon(), kNever);
  timer.at(start + 500);
  EXPECT_EQ(horizon(), start + 500);
  timer.move_to(start + 300);
  EXPECT_EQ(horizon(), start + 300);
  timer.soon();
  EXPECT_EQ(horizon(), start);
  timer.cancel();
  EXPECT_EQ(horizon(), kNever);
}

TEST_F(TimerTest, AMarkSeesEachUse) {
  const Horizon::Mark unused;
  EXPECT_FALSE(unused.moved());
  timer.at(start + 500);
  EXPECT_TRUE(unused.moved());
  const Horizon::Mark before_cancel;
  timer.cancel();
  EXPECT_TRUE(before_cancel.moved());
}

TEST_F(TimerTest, AnActivationBeginsWithForget) {
  Horizon horizon;
  timer.at(start + 500);
  ASSERT_EQ(horizon(), start + 500);
  advance(600);
  EXPECT_FALSE(horizon.holds()) << "the kernel went on meanwhile";
  horizon.forget();
  EXPECT_TRUE(horizon.holds()) << "nothing is kept";
  EXPECT_EQ(horizon(), kNever);
}

TEST_F(TimerTest, AnEventBehindTheServicesBackIsNoticed) {
  Horizon horizon;
  timer.at(start + 500);
  ASSERT_EQ(horizon(), start + 500);
  ASSERT_TRUE(horizon.holds());
  listener->bare.notify(ps_time(500));
  EXPECT_TRUE(horizon.holds()) << "not earlier than what is kept";
  listener->bare.notify(ps_time(499));
  EXPECT_FALSE(horizon.holds());
#ifdef FOVEA_PARANOID
  EXPECT_DEATH(horizon(), "without a Timer");
#endif
}

}  // namespace
}  // namespace fovea

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  fovea::Listener listener("listener");
  fovea::TimerTest::listener = &listener;
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  return RUN_ALL_TESTS();
}
