// What wakes the core first goes on first, whichever of them was first when the trace was recorded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "sw/fovea/replay/wake_order.h"
#include "tb/replay/played.h"
#include "tb/replay/support.h"

namespace fovea::replay {
namespace {

using app::WakeOrder;
using trace::Record;
using trace::Release;
using testing::ElementsAre;

constexpr std::uint64_t kTimed = 0, kOfTransfer = 1, kLaterTimed = 2;
constexpr Picoseconds kFirst = 20'000'000, kLater = 60'000'000;

Record woken(std::uint64_t interrupt, std::uint32_t address) {
  Record r = read_at(0, address);
  r.release = Release::kWhen;
  r.event = interrupt;
  return r;
}
Record behind(std::uint32_t address) {
  Record r = read_at(0, address);
  r.release = Release::kAfter;
  r.back = 1;
  return r;
}

/// Interrupts at two times, and one when the first read of the display has ended.
trace::TraceInfo info_with_interrupts() {
  trace::TraceInfo info = board_info();
  info.interrupts = {{kFirst}, {kFirst + 1, 2, trace::Point::kEnd, 0, 0}, {kLater}};
  return info;
}

struct Addresses : MemObserver {
  std::vector<std::uint32_t> of_core;
  std::vector<Picoseconds> issued;
  void submitted(const MemRequest& r, bool) override {
    if (r.master != Master::kArmD) return;
    of_core.push_back(r.address & 0xFFFFFFu);
    issued.push_back(r.issued);
  }
  void responded(const MemRequest&) override {}
};

/// The core's requests, in blocks that begin with `blocks`; the display's read ends soon after `ends`.
Addresses played(const std::vector<std::vector<Record>>& blocks, Picoseconds ends) {
  const trace::TraceInfo info = info_with_interrupts();
  Listed l;
  l.records[0] = {read_at(2'000'000, 0x100)};
  for (const auto& b : blocks) l.records[0].insert(l.records[0].end(), b.begin(), b.end());
  l.records[2] = {read_at(ends, 0x8000)};
  l.records[2].back().master = Master::kVpbe;
  app::ReplayParams params;
  app::ReplayPath path("t", info, l, params, false);
  Addresses out;
  const Subscription observing = path.observe(out);
  EXPECT_TRUE(path.run_before(kNever));
  return out;
}

const std::vector<Record> kTimedBlock = {woken(kTimed, 0x1000), behind(0x1100)};
const std::vector<Record> kTransferBlock = {woken(kOfTransfer, 0x2000), behind(0x2100), behind(0x2200)};
const std::vector<Record> kLaterBlock = {woken(kLaterTimed, 0x3000)};

TEST(WakeOrderTest, WhatComesFirstGoesOn) {
  for (const bool timed_first : {true, false}) {
    const auto blocks = timed_first ? std::vector{kTimedBlock, kTransferBlock, kLaterBlock}
                                    : std::vector{kTransferBlock, kTimedBlock, kLaterBlock};
    EXPECT_THAT(played(blocks, 10'000'000).of_core,
                ElementsAre(0x100, 0x2000, 0x2100, 0x2200, 0x1000, 0x1100, 0x3000));
    EXPECT_THAT(played(blocks, 30'000'000).of_core,
                ElementsAre(0x100, 0x1000, 0x1100, 0x2000, 0x2100, 0x2200, 0x3000));
    EXPECT_THAT(played(blocks, 80'000'000).of_core,
                ElementsAre(0x100, 0x1000, 0x1100, 0x3000, 0x2000, 0x2100, 0x2200));
  }
}

TEST(WakeOrderTest, EachGoesAtTheTimeOfItsInterrupt) {
  const Addresses early = played({kTimedBlock, kTransferBlock, kLaterBlock}, 10'000'000);
  EXPECT_GT(early.issued[1], 10'000'000u);
  EXPECT_LT(early.issued[1], 12'000'000u);
  EXPECT_GE(early.issued[4], kFirst);
  EXPECT_LT(early.issued[4], kFirst + 10'000);
  const Addresses late = played({kTransferBlock, kTimedBlock, kLaterBlock}, 30'000'000);
  EXPECT_GE(late.issued[1], kFirst);
  EXPECT_LT(late.issued[1], kFirst + 10'000);
  EXPECT_GT(late.issued[3], 30'000'000u);
}

/// When no transfer will wake the core any more, a replay that is to be compared with a run goes on for as long as the
/// run did then, if that is not more than a twentieth of the window.
TEST(WakeOrderTest, WithTheLastTransferTheWorkEnds) {
  trace::TraceInfo info = info_with_interrupts();
  const Picoseconds most = (info.end - info.start) / 20;
  for (const Picoseconds rest : {most, most + 1}) {
    info.interrupts[kOfTransfer].at = info.end - rest;
    info.interrupts[kLaterTimed].at = info.end - 1'000'000;
    info.core_until = info.interrupts[kLaterTimed].at;
    Listed l;
    l.records[0] = {read_at(2'000'000, 0x100)};
    for (const auto& b : {kTimedBlock, kTransferBlock, kLaterBlock})
      l.records[0].insert(l.records[0].end(), b.begin(), b.end());
    l.records[2] = {read_at(100'000'000, 0x8000)};
    l.records[2].back().master = Master::kVpbe;
    app::ReplayParams params;
    app::ReplayPath path("t", info, l, params, false);
    path.end_with_window();
    EXPECT_TRUE(path.run_before(kNever));
    EXPECT_EQ(path.requests(), rest == most ? 7u : 8u);
  }
}

/// A record of the moved block refers to one that comes later now: it waits for its interrupt alone.
TEST(WakeOrderTest, ABlockThatIsBroughtForwardWaitsForNothingOfTheOneItOvertakes) {
  std::vector<Record> refers = kTransferBlock;
  refers[0].back = 1;
  refers[0].gap = 5;
  EXPECT_THAT(played({kTimedBlock, refers}, 10'000'000).of_core,
              ElementsAre(0x100, 0x2000, 0x2100, 0x2200, 0x1000, 0x1100));
}

/// Beyond so many records nothing is looked for; order and number of the records stay.
TEST(WakeOrderTest, FarAheadTheOrderIsThatOfTheTrace) {
  for (const std::size_t length : {4'000u, 5'000u}) {
    std::vector<Record> timed = kTimedBlock;
    timed.resize(length, behind(0x1100));
    const auto out = played({timed, kTransferBlock}, 10'000'000).of_core;
    ASSERT_EQ(out.size(), 1 + length + kTransferBlock.size());
    EXPECT_EQ(out[1], length == 4'000u ? 0x2000u : 0x1000u) << length;
  }
}

}  // namespace
}  // namespace fovea::replay
