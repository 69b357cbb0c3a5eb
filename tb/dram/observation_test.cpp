// Observers of the memory system: several at once see the same, and each ends by itself.
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <string>

#include "tb/dram/path.h"

namespace fovea::dram {
namespace {

/// What an observer of each kind was called with, as text.
struct Seen : MemObserver, ArrivalObserver {
  std::string requests, arrivals, commands;
  void submitted(const MemRequest& r, bool to_sdram) override {
    requests += "in " + std::to_string(r.address) + (to_sdram ? "" : " elsewhere") + "\n";
  }
  void responded(const MemRequest& r) override {
    requests += "out " + std::to_string(r.address) + " at " + std::to_string(r.last) + "\n";
  }
  void register_done(const MemRequest& r) override {
    requests += "refused " + std::to_string(r.address) + "\n";
  }
  void arrived(const MemRequest& r, Picoseconds at) override {
    arrivals += std::to_string(r.address) + " at " + std::to_string(at) + "\n";
  }
  static void command(void* self, mem::Cmd, unsigned bank, std::uint32_t row, std::uint64_t clock) {
    static_cast<Seen*>(self)->commands +=
        std::to_string(bank) + " " + std::to_string(row) + " at " + std::to_string(clock) + "\n";
  }
};

struct ObservationTest : testing::Test {
  Path path;
  std::deque<PathRequest> requests;
  std::array<std::uint8_t, 64> data{};
  Picoseconds now = 0;
  /// A read and a write to the SDRAM and a read of a register, which no slave answers.
  void traffic() {
    for (unsigned k = 0; k < 3; ++k) {
      PathRequest& r = requests.emplace_back();
      r.master = k == 2 ? Master::kArmD : Master::kVpbe;
      r.write = k == 1;
      r.address = static_cast<std::uint32_t>(requests.size()) * 0x1000;
      r.bytes = 32;
      r.data = data.data();
      path.submit(r, now += 10'000);
    }
    path.run_before(now += kPsPerUs);
  }
};

TEST_F(ObservationTest, TwoSeeTheSameRequestsAndTheEndOfOneLeavesTheOther) {
  Seen a, b;
  Subscription of_a = path.xbar.observe(a);
  const Subscription of_b = path.xbar.observe(b);
  traffic();
  EXPECT_NE(a.requests, "");
  EXPECT_EQ(a.requests, b.requests);
  EXPECT_TRUE(path.xbar.observed());
  of_a.reset();
  EXPECT_TRUE(path.xbar.observed());
  const std::string before = a.requests;
  traffic();
  EXPECT_EQ(a.requests, before);
  EXPECT_GT(b.requests.size(), before.size());
}

TEST_F(ObservationTest, TwoSeeTheSameArrivalsAndTheEndOfOneLeavesTheOther) {
  Seen a, b;
  Subscription of_a = path.memory.observe_arrivals(a), of_b = path.memory.observe_arrivals(b);
  traffic();
  EXPECT_NE(a.arrivals, "");
  EXPECT_EQ(a.arrivals, b.arrivals);
  of_a.reset();
  const std::string before = a.arrivals;
  traffic();
  EXPECT_EQ(a.arrivals, before);
  EXPECT_GT(b.arrivals.size(), before.size());
  // While an observer is subscribed, a request counts as one with side effects.
  const auto undecided = [&] {
    PathRequest& r = requests.emplace_back();
    r.bytes = 32;
    r.data = data.data();
    r.no_side_effects = true;
    path.submit(r, now += 10'000);
    const unsigned n = path.memory.undecided();
    path.run_before(now += kPsPerUs);
    return n;
  };
  EXPECT_EQ(undecided(), 1u);
  of_b.reset();
  EXPECT_EQ(undecided(), 0u);
}

TEST_F(ObservationTest, TwoSeeTheSameCommandsAndTheEndOfOneLeavesTheOther) {
  Seen a, b;
  Subscription of_a = path.ddr.observe_commands(&Seen::command, &a);
  const Subscription of_b = path.ddr.observe_commands(&Seen::command, &b);
  traffic();
  EXPECT_NE(a.commands, "");
  EXPECT_EQ(a.commands, b.commands);
  of_a.reset();
  const std::string before = a.commands;
  traffic();
  EXPECT_EQ(a.commands, before);
  EXPECT_GT(b.commands.size(), before.size());
}

}  // namespace
}  // namespace fovea::dram
