// The parts of the SDRAM controller, each alone: refresh, power-down, row policy, queue, schedulers.
#include <gtest/gtest.h>

#include "model/mem/core/command_queue.h"
#include "model/mem/core/ddr_config.h"
#include "model/mem/core/power_manager.h"
#include "model/mem/core/read_return.h"
#include "model/mem/core/refresh_manager.h"
#include "model/mem/core/row_policy.h"
#include "model/mem/core/scheduler/schedulers.h"

namespace fovea::dram {
namespace {

using mem::Cmd;
using mem::CommandQueue;
using mem::DdrDevice;
using mem::LowPower;
using mem::QueueEntry;
using Urgency = mem::RefreshManager::Urgency;

constexpr unsigned kInterval = 100;

/// With the levels of the controller's family.
struct Refresh {
  mem::DdrStats stats;
  mem::RefreshManager manager{{.release = 3, .need = 7, .must = 11, .gap = 7}, stats, {}};
  Refresh() { manager.set_interval(kInterval, 0); }
  void expire(unsigned intervals) {
    for (; intervals; --intervals) manager.count_expired(manager.next_expiry());
  }
  void refresh(unsigned times) {
    for (; times; --times) manager.refreshed();
  }
};

// Each word of ddr.ideal makes its own fields better and leaves the others alone; none is ever made worse.
TEST(IdealTest, EachWordChangesItsOwnFields) {
  mem::DdrConfig programmed;
  programmed.read_latency = 6;
  const auto fields = [](const mem::DdrConfig& c) {
    const mem::DdrTiming& t = c.timing;
    return std::vector<unsigned>{t.CL,   c.read_latency, t.nRP,   t.nRCD, t.nRAS,  t.nRC,  t.nRRD,
                                 t.nRTP, t.nWR,          t.nWTR,  t.nRFC, t.nXSNR, t.nXSRD, t.nCKE,
                                 c.refresh_interval,     c.row_intervals, c.old_count};
  };
  const auto with = [&](const char* word) {
    mem::DdrParams params;
    params.ideal.set(word);
    return fields(mem::idealised(programmed, params));
  };
  //                                        CL RL RP RCD RAS RC RRD RTP WR WTR RFC XSNR XSRD CKE REFI rows count
  using Fields = std::vector<unsigned>;
  EXPECT_EQ(with("none"), (Fields{5, 6, 5, 5, 11, 16, 3, 2, 4, 3, 31, 34, 200, 3, 1895, 16, 255}));
  EXPECT_EQ(with("row_timing"), (Fields{5, 6, 1, 1, 1, 1, 1, 1, 1, 3, 31, 34, 200, 3, 1895, 16, 255}));
  EXPECT_EQ(with("cas_latency"), (Fields{4, 4, 5, 5, 11, 16, 3, 2, 4, 3, 31, 34, 200, 3, 1895, 16, 255}));
  EXPECT_EQ(with("turnaround"), (Fields{5, 6, 5, 5, 11, 16, 3, 2, 4, 1, 31, 34, 200, 3, 1895, 16, 255}));
  EXPECT_EQ(with("refresh"), (Fields{5, 6, 5, 5, 11, 16, 3, 2, 4, 3, 31, 34, 200, 3, 0, 16, 255}));
  programmed.timing.CL = programmed.read_latency = 3;
  EXPECT_EQ(with("cas_latency").front(), 3u) << "what is better already stays";
}

TEST(RefreshManagerTest, NeedsARefreshAboveItsLevel) {
  Refresh r;
  EXPECT_EQ(r.manager.next_expiry(), kInterval);
  r.expire(7);
  EXPECT_EQ(r.manager.owed(), 7u);
  EXPECT_EQ(r.manager.urgency(), Urgency::kMay);
  EXPECT_FALSE(r.manager.urgent());
  r.refresh(1);
  r.expire(1);
  EXPECT_EQ(r.manager.urgency(), Urgency::kMay) << "seven owed";
  // By this edge the eighth will be owed, though it was not counted yet.
  EXPECT_EQ(r.manager.urgency(r.manager.next_expiry() - 1), Urgency::kMay);
  EXPECT_EQ(r.manager.urgency(r.manager.next_expiry()), Urgency::kNeed);
  r.expire(1);
  EXPECT_EQ(r.manager.urgency(), Urgency::kNeed);
  EXPECT_TRUE(r.manager.urgent());
}

TEST(RefreshManagerTest, MustRefreshUntilTheBacklogIsReleased) {
  Refresh r;
  r.expire(7);
  r.refresh(1);
  r.expire(5);
  EXPECT_EQ(r.manager.owed(), 11u);
  EXPECT_EQ(r.manager.urgency(), Urgency::kNeed);
  r.expire(1);
  EXPECT_EQ(r.manager.urgency(), Urgency::kMust) << "twelve owed";
  r.refresh(8);
  EXPECT_EQ(r.manager.owed(), 4u);
  EXPECT_EQ(r.manager.urgency(), Urgency::kMust);
  r.refresh(1);
  EXPECT_EQ(r.manager.urgency(), Urgency::kMay) << "three owed";
  EXPECT_EQ(r.stats.refreshes.count(), 10u);
  EXPECT_EQ(std::get<std::uint64_t>(r.stats.refresh_backlog.value()), 12u);
}

TEST(RefreshManagerTest, FourFollowEachOtherAfterMoreThanSevenIntervals) {
  Refresh r;
  r.expire(7);
  EXPECT_EQ(r.manager.urgency(), Urgency::kMay);
  r.expire(1);
  EXPECT_EQ(r.manager.urgency(), Urgency::kMust);
  r.manager.begin_cycle();
  r.refresh(3);
  EXPECT_EQ(r.manager.urgency(), Urgency::kMust);
  r.refresh(1);
  EXPECT_EQ(r.manager.urgency(), Urgency::kMay);
}

TEST(RefreshManagerTest, NothingComesBetweenPreaAndRef) {
  Refresh r;
  r.expire(1);
  r.manager.begin_idle_cycle();
  EXPECT_TRUE(r.manager.cycle_begun());
  EXPECT_EQ(r.manager.urgency(), Urgency::kMust);
  r.refresh(1);
  EXPECT_FALSE(r.manager.cycle_begun());
  EXPECT_EQ(r.manager.urgency(), Urgency::kMay);
}

TEST(RefreshManagerTest, AnotherIntervalStartsToCountAnew) {
  Refresh r;
  r.manager.set_interval(kInterval, 60);
  EXPECT_EQ(r.manager.next_expiry(), kInterval) << "the same keeps its phase";
  r.manager.set_interval(250, 60);
  EXPECT_EQ(r.manager.next_expiry(), 310u);
  r.manager.set_interval(40, 311);
  EXPECT_EQ(r.manager.owed(), 1u) << "the interval that ended before";
  EXPECT_EQ(r.manager.next_expiry(), 351u);
  r.manager.pass_over(5);
  EXPECT_EQ(r.manager.next_expiry(), 551u);
  EXPECT_EQ(r.stats.refreshes.count(), 5u);
  r.manager.restart(1000);
  EXPECT_EQ(r.manager.owed(), 0u);
  EXPECT_EQ(r.manager.next_expiry(), 1040u);
  r.manager.set_interval(0, 1001);
  EXPECT_EQ(r.manager.next_expiry(), mem::RefreshManager::kNoClock);
  EXPECT_EQ(r.manager.urgency(1'000'000), Urgency::kMay);
}

TEST(PowerManagerTest, CkeStaysForTckeAndTheClockRestartsBeforeIt) {
  mem::DdrStats stats;
  mem::PowerManager power(5, stats);
  EXPECT_FALSE(power.asleep());
  power.enter(LowPower::kPowerDown, 10, 40'000, 3);
  EXPECT_EQ(power.mode(), LowPower::kPowerDown);
  EXPECT_EQ(power.entered(), 40'000u);
  EXPECT_EQ(power.exit_clock(12), 13u) << "tCKE";
  EXPECT_EQ(power.exit_clock(14), 14u);
  power.leave(20, true, 3);
  EXPECT_FALSE(power.asleep());
  EXPECT_EQ(power.cke_free(), 23u);
  power.enter(LowPower::kClockStop, 30, 0, 3);
  EXPECT_EQ(power.exit_clock(40), 45u);
  power.change(LowPower::kSelfRefresh, 50);
  EXPECT_EQ(power.exit_clock(51), 55u) << "the clock was started at 50";
  EXPECT_EQ(power.exit_clock(56), 56u);
  EXPECT_EQ(stats.power_downs.count(), 1u);
  EXPECT_EQ(stats.self_refreshes.count(), 1u);
}

TEST(PowerManagerTest, CountsEachModeOnce) {
  mem::DdrStats stats;
  mem::PowerManager power(1, stats);
  power.count(5, true);
  power.enter(LowPower::kPowerDown, 10, 0, 3);
  power.count(14, false);
  power.count(14, false);
  power.leave(20, true, 3);
  EXPECT_EQ(stats.power_down_clocks.count(), 10u);
  EXPECT_EQ(stats.active_power_down_clocks.count(), 4u);
  power.enter(LowPower::kSelfRefresh, 100, 0, 3);
  power.change(LowPower::kClockStop, 130);
  power.leave(200, true, 3);
  EXPECT_EQ(stats.self_refresh_clocks.count(), 100u);
  EXPECT_EQ(stats.clock_stop_clocks.count(), 70u);
}

/// A queue, and a part with all rows closed.
struct Planner {
  CommandQueue queue;
  DdrDevice device;
  mem::Plan plan;
  Planner() { device.configure(mem::DdrTiming{}); }
  void open(unsigned bank, std::uint32_t row, std::uint64_t clock) {
    device.issue<Cmd::kAct>(bank, row, clock);
    queue.row_opened(bank, row);
  }
  template <mem::Scheduler S>
  void add(S, Master master, bool write, unsigned bank, std::uint32_t row, unsigned priority = 4) {
    QueueEntry& e = queue.free_entry();
    e.request = {};
    e.request.master = master;
    e.request.priority = static_cast<std::uint8_t>(priority);
    e.request.write = write;
    e.request.bytes = 16;
    e.request.address = row << 14 | bank << 11;
    e.bank = static_cast<std::uint8_t>(bank);
    e.row = row;
    e.chunks = 1;
    const mem::Positions older = queue.order().of_master(master);
    const unsigned position = queue.add(e, device.row(bank) == row);
    if (S::competes(queue, e, older)) queue.compete(1u << position);
  }
  template <mem::Scheduler S>
  mem::Choice choose(S, std::uint64_t edge) {
    S::choose({queue, device}, edge, (1u << queue.count()) - 1, plan);
    return plan.choice;
  }
};

TEST(RowPolicyTest, ARowIsDueAfterItsLimit) {
  Planner p;
  mem::RowPolicy rows;
  rows.set_limit(500);
  EXPECT_EQ(rows.first_overdue(p.device), mem::RowPolicy::kNoClock);
  p.open(3, 7, 100);
  p.open(1, 9, 140);
  EXPECT_EQ(rows.first_overdue(p.device), 600u);
  EXPECT_EQ(mem::RowPolicy::longest_open(p.device), 3u);
  p.device.issue<Cmd::kPre>(3, 0, 150);
  EXPECT_EQ(rows.first_overdue(p.device), 640u);
  rows.set_limit(0);
  EXPECT_EQ(rows.first_overdue(p.device), mem::RowPolicy::kNoClock);
}

TEST(RowPolicyTest, ARowThatAnotherRequestWantsStaysOpen) {
  Planner p;
  mem::RowPolicy rows;
  const mem::FcfsScheduler fcfs;
  p.add(fcfs, Master::kArmD, false, 2, 5);
  p.add(fcfs, Master::kVpfe, false, 3, 5);
  EXPECT_FALSE(rows.closes_row_of(p.queue.entry(0), p.queue)) << "not with this policy";
  rows.close_after_access(true);
  EXPECT_TRUE(rows.closes_row_of(p.queue.entry(0), p.queue)) << "another bank's row 5";
  p.add(fcfs, Master::kVpbe, true, 2, 5);
  EXPECT_FALSE(rows.closes_row_of(p.queue.entry(0), p.queue));
}

TEST(CommandQueueTest, RequestsMoveUpAndSetsWithThem) {
  Planner p;
  const mem::FcfsScheduler fcfs;
  p.open(1, 5, 0);
  p.add(fcfs, Master::kArmD, true, 0, 5);
  p.add(fcfs, Master::kVpfe, false, 1, 5);
  p.add(fcfs, Master::kArmD, true, 1, 6);
  EXPECT_EQ(p.queue.count(), 3u);
  EXPECT_EQ(p.queue.hits(), 0b010u);
  EXPECT_EQ(p.queue.order().writes(), 0b101u);
  EXPECT_EQ(p.queue.write_words_held(), 4u);
  p.queue.leave(0);
  EXPECT_EQ(p.queue.hits(), 0b01u);
  EXPECT_EQ(p.queue.order().of_master(Master::kArmD), 0b10u);
  EXPECT_EQ(p.queue.write_words_held(), 2u);
  EXPECT_EQ(p.queue.entry(1).row, 6u);
  p.queue.row_closed(1);
  EXPECT_EQ(p.queue.hits(), 0u);
  p.queue.row_opened(1, 6);
  EXPECT_EQ(p.queue.hits(), 0b10u);
}

TEST(CommandQueueTest, ASingleRequestJoinsWhenAnotherComes) {
  CommandQueue queue;
  QueueEntry& e = queue.begin_single();
  e.request = {};
  e.request.write = true;
  e.request.bytes = 16;
  e.bank = 2;
  EXPECT_EQ(queue.count(), 1u);
  EXPECT_EQ(&queue.entry(0), &e);
  EXPECT_EQ(queue.order().writes(), 0u) << "no set knows it";
  queue.join_single(true);
  EXPECT_FALSE(queue.single());
  EXPECT_EQ(queue.count(), 1u);
  EXPECT_EQ(queue.order().writes(), 1u);
  EXPECT_EQ(queue.hits(), 1u);
  EXPECT_EQ(queue.competing(), 1u);
  EXPECT_NE(&queue.free_entry(), &e);
}

TEST(ReadOutcomesTest, HasRoomForAnyNumber) {
  mem::ReadOutcomes out;
  for (unsigned i = 0; i < 40; ++i) out.add({nullptr, i, i + 1, 0, {}});
  ASSERT_EQ(out.size(), 40u);
  Picoseconds at = 0;
  for (const mem::ReadOutcome& r : out) EXPECT_EQ(r.first, at++);
  out.clear();
  EXPECT_EQ(out.begin(), out.end());
}

/// A write and a younger, less urgent read, both with open rows.
template <mem::Scheduler S>
mem::Choice write_then_read(S s, bool full = false) {
  Planner p;
  p.open(0, 1, 0);
  p.open(1, 2, 3);
  p.add(s, Master::kArmD, true, 0, 1, 1);
  p.add(s, Master::kVpbe, false, 1, 2, 5);
  S::choose({p.queue, p.device, full ? 200u : 0u}, 100, 0b11, p.plan);
  return p.plan.choice;
}

TEST(SchedulersTest, TiTakesReadsBeforeWrites) {
  const mem::Choice c = write_then_read(mem::TiScheduler<mem::OpenRow::kActivated>());
  EXPECT_EQ(c.cmd, Cmd::kRd);
  EXPECT_EQ(c.at, 100u);
  EXPECT_EQ(write_then_read(mem::TiScheduler<mem::OpenRow::kActivated>(), true).cmd, Cmd::kWr)
      << "no room for read data";
}

TEST(SchedulersTest, FcfsAndFrfcfsTakeTheOldest) {
  EXPECT_EQ(write_then_read(mem::FcfsScheduler()).cmd, Cmd::kWr);
  EXPECT_EQ(write_then_read(mem::FrfcfsScheduler()).cmd, Cmd::kWr);
}

TEST(SchedulersTest, OnlyFirstReadyPoliciesPreferTheRowThatCanBeRead) {
  const auto first = [](auto s) {
    Planner p;
    p.add(s, Master::kArmD, false, 0, 1);
    p.add(s, Master::kVpbe, false, 1, 2);
    p.open(1, 2, 90);
    p.open(0, 1, 97);  // tRCD 5: legal from 102 on
    return p.choose(s, 100);
  };
  const mem::Choice activated = first(mem::TiScheduler<mem::OpenRow::kActivated>());
  EXPECT_EQ(activated.position, 0u);
  EXPECT_EQ(activated.at, 102u);
  const mem::Choice ready = first(mem::TiScheduler<mem::OpenRow::kReady>());
  EXPECT_EQ(ready.position, 1u);
  EXPECT_EQ(ready.at, 100u);
  EXPECT_EQ(first(mem::FrfcfsScheduler()).position, 1u);
}

TEST(SchedulersTest, OneMasterOffersItsOldestAndFrfcfsAll) {
  const auto competing = [](auto s) {
    Planner p;
    for (unsigned bank = 0; bank < 3; ++bank) p.add(s, Master::kVpbe, false, bank, 1);
    return p.queue.competing();
  };
  EXPECT_EQ(competing(mem::TiScheduler<mem::OpenRow::kActivated>()), 0b001u);
  EXPECT_EQ(competing(mem::FrfcfsScheduler()), 0b111u);
}

TEST(SchedulersTest, EachWordHasItsClass) {
  for (const char* word : {"ti", "fcfs", "frfcfs", "closed_page"})
    for (const char* rows : {"activated", "ready"}) {
      mem::DdrParams params;
      ParamSet set;
      set.add(params);
      set.set("ddr.scheduler", word);
      set.set("ddr.ti_open_row", rows);
      const mem::AnyScheduler any = mem::scheduler_of(params);
      std::visit([&]<class S>(S) { EXPECT_STREQ(S::kName, word); }, any);
      if (word == std::string("ti")) {
        EXPECT_EQ(std::holds_alternative<mem::TiScheduler<mem::OpenRow::kReady>>(any),
                  rows == std::string("ready"));
      }
    }
}

}  // namespace
}  // namespace fovea::dram
