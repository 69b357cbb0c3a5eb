// Ports of the crossbar: their widths, and the two sides of a transfer controller. By hand.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tb/dram/bench.h"
#include "tb/dram/path.h"
#include "tb/dram/xbar_bench.h"

namespace fovea::dram {
namespace {

constexpr Master kA = Master::kVpfe, kB = Master::kVpbe;

// 64 bits a clock is the width of the slave's data bus. A narrower port occupies it longer for its writes.
TEST(PortsTest, NarrowPortOccupiesTheDataBusForEachOfItsBeats) {
  for (const unsigned bits : {16u, 32u, 64u})
    for (const unsigned bytes : {1u, 4u, 8u, 12u, 32u, 64u}) {
      XbarBench b({{"bus.vpfe.width", std::to_string(bits) + "bit"}});
      b.submit(kA, 5, true, bytes);
      b.submit(kB, 5);
      b.run();
      const std::uint64_t beats = (8 * bytes + bits - 1) / bits;
      EXPECT_EQ(b.events[0].arrival, 8 + beats) << bits << " bits, " << bytes << " bytes";
      EXPECT_EQ(b.events[1].granted, 8 + beats);
      EXPECT_EQ(b.answers[0].last, 8 + beats + 2);
    }
}

// Eight words of 8 bytes are on the return channel from 30 to 37, two edges from the port.
TEST(PortsTest, NarrowPortTakesLongerForReadData) {
  const auto last = [](unsigned bits, unsigned bytes, std::uint64_t from, std::uint64_t to) {
    XbarBench b({{"bus.vpfe.width", std::to_string(bits) + "bit"}});
    b.submit(kA, 5, false, bytes);
    b.run();
    b.xbar.slave_done(b, *b.sent[0], {from * kEdge, to * kEdge});
    EXPECT_EQ(b.answers[0].first, from + 2) << "the first beat is not later";
    return b.answers[0].last;
  };
  EXPECT_EQ(last(64, 64, 30, 37), 39u);
  EXPECT_EQ(last(32, 64, 30, 37), 32u + 16 - 1);
  EXPECT_EQ(last(16, 64, 30, 37), 32u + 32 - 1);
  EXPECT_EQ(last(32, 4, 30, 30), 32u);
  EXPECT_EQ(last(32, 8, 30, 30), 33u);
  EXPECT_EQ(last(16, 4, 30, 30), 33u);
  // A slave slower than the port: only the last word's beats come behind it.
  EXPECT_EQ(last(32, 64, 30, 60), 62u + 1);
}

TEST(PortsTest, NarrowPortReturnsOneBurstAfterTheOther) {
  XbarBench b(std::vector<std::pair<std::string, std::string>>{{"bus.vpfe.width", "32bit"}});
  b.submit(kA, 5, false, 32);
  b.submit(kA, 5, false, 32);
  b.submit(kB, 5, false, 32);
  b.run();
  b.xbar.slave_done(b, *b.sent[0], {30 * kEdge, 33 * kEdge});
  b.xbar.slave_done(b, *b.sent[2], {34 * kEdge, 37 * kEdge});
  b.xbar.slave_done(b, *b.sent[1], {38 * kEdge, 41 * kEdge});
  EXPECT_EQ(b.answers[0].last, 39u);
  EXPECT_EQ(b.answers[1].first, 40u) << "behind the port's first burst";
  EXPECT_EQ(b.answers[1].last, 47u);
  EXPECT_EQ(b.answers[2].first, 40u) << "another port does not wait";
  EXPECT_EQ(b.answers[2].last, 43u);
  const Waits& w = b.xbar.waits[index(kA)].read;
  // Arbitrated behind its own first by an edge, and four edges late at the port.
  EXPECT_EQ(w.ps[index(culprit(kA))] / kEdge, 1u + 4u);
}

TEST(PortsTest, PortsOfTheCoreAreNarrow) {
  for (const Master m : {Master::kArmI, Master::kArmD, Master::kLoad}) {
    XbarBench b;
    b.submit(m, 5, true, 32);
    b.run();
    EXPECT_EQ(b.events[0].arrival - b.events[0].granted, m == Master::kLoad ? 4u : 8u);
  }
}

TEST(PortsTest, SidesOfATransferControllerArbitrateApartAndCountTogether) {
  XbarBench b;
  const Master read = edma_read(2), write = edma_write(2);
  b.xbar.set_priority(read, 3);
  b.xbar.set_priority(write, 2);
  b.submit(read, 5, false, 32);
  b.submit(write, 5, true, 16);
  b.run();
  ASSERT_EQ(b.events.size(), 2u);
  EXPECT_EQ(b.events[0].master, write) << "neither waits in the other's queue";
  EXPECT_EQ(b.events[1].master, read);
  const auto& s = *b.xbar.stats[stat_index(read)];
  EXPECT_EQ(&s, b.xbar.stats[stat_index(write)].get());
  EXPECT_EQ(s.prefix(), "bus.edma_tc2");
  EXPECT_EQ(s.read_bytes.count(), 32u);
  EXPECT_EQ(s.write_bytes.count(), 16u);
  EXPECT_EQ(s.transactions.count(), 2u);
}

// One master's read of a block waits for its older write there; the sides of a transfer controller
// are two masters, and reads go first: the read side sees what was there before.
TEST(PortsTest, SidesOfATransferControllerAreOrderedApart) {
  for (const bool apart : {false, true}) {
    Path path;
    std::array<std::uint8_t, 64> busy{}, fresh, seen{};
    fresh.fill(0x5A);
    PathRequest ahead, write, read;
    ahead.master = Master::kVpbe;
    write.master = apart ? edma_write(0) : edma_read(0);
    read.master = edma_read(0);
    ahead.bytes = write.bytes = read.bytes = 64;
    ahead.address = at(2, 0, 0);
    write.address = read.address = at(1, 0, 0);
    write.write = true;
    ahead.data = busy.data();
    write.data = fresh.data();
    read.data = seen.data();
    path.submit(ahead, 0);
    path.submit(write, 0);
    path.submit(read, 8'000);
    path.drain();
    EXPECT_EQ(seen[0], apart ? 0 : 0x5A);
    std::array<std::uint8_t, 64> after{};
    path.ddr.debug_read(at(1, 0, 0), after.data(), 64);
    EXPECT_EQ(after, fresh);
  }
}

}  // namespace
}  // namespace fovea::dram
