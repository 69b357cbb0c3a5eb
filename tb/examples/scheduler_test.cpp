// The scheduler of model/howto/add-a-scheduler.md, asked for its choices.
#include <gtest/gtest.h>

#include "tb/examples/shortest_first.h"

namespace fovea::mem {
namespace {

using S = ShortestFirstScheduler;

/// Row 1 of bank 0 and of bank 1 are open.
struct Queue {
  CommandQueue queue;
  DdrDevice device;
  Plan plan;
  Queue() {
    device.configure(DdrTiming{});
    device.issue<Cmd::kAct>(0, 1, 0);
    device.issue<Cmd::kAct>(1, 1, 3);
  }
  void add(Master master, unsigned bank, std::uint32_t row, unsigned chunks) {
    QueueEntry& e = queue.free_entry();
    e.request = {};
    e.request.master = master;
    e.request.bytes = static_cast<std::uint8_t>(16 * chunks);
    e.bank = static_cast<std::uint8_t>(bank);
    e.row = row;
    e.chunks = static_cast<std::uint8_t>(chunks);
    const Positions older = queue.order().of_master(master);
    const unsigned position = queue.add(e, device.row(bank) == row);
    if (S::competes(queue, e, older)) queue.compete(1u << position);
  }
  Choice choose() {
    S::choose({queue, device}, 100, (1u << queue.count()) - 1, plan);
    return plan.choice;
  }
};

TEST(ShortestFirstTest, TheShortestWithAnOpenRowGoesFirst) {
  Queue q;
  q.add(Master::kVpbe, 0, 1, 4);
  q.add(Master::kArmD, 2, 1, 1);  // its bank is closed
  q.add(Master::kVpfe, 1, 1, 2);
  const Choice c = q.choose();
  EXPECT_EQ(c.cmd, Cmd::kRd);
  EXPECT_EQ(c.position, 2u);
  EXPECT_EQ(c.at, 100u);
}

TEST(ShortestFirstTest, OfEqualsTheOldest) {
  Queue q;
  q.add(Master::kVpbe, 1, 1, 2);
  q.add(Master::kVpfe, 0, 1, 2);
  EXPECT_EQ(q.choose().position, 0u);
}

TEST(ShortestFirstTest, AMasterStaysInOrder) {
  Queue q;
  q.add(Master::kVpbe, 0, 1, 4);
  q.add(Master::kVpbe, 1, 1, 1);
  EXPECT_EQ(q.choose().position, 0u);
  q.queue.leave(0);
  q.queue.compete(S::competing(q.queue, q.queue.order().of_master(Master::kVpbe)));
  EXPECT_EQ(q.choose().position, 0u);
  EXPECT_EQ(q.plan.choice.entry->chunks, 1u);
}

}  // namespace
}  // namespace fovea::mem
