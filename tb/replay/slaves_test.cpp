// What lies beside the SDRAM in a replay: one burst of the internal RAM after the other, one word of a master's
// registers after the other.
#include <gtest/gtest.h>

#include <array>

#include "sw/fovea/replay/replay_slaves.h"

namespace fovea::replay {
namespace {

using app::ReplaySlaves;

constexpr Picoseconds kNs = kPsPerNs;
const trace::EdmaInfo kEdma{8, 256, 4, 3, 2, 20 * kNs};
const Clock kCore(Frequency(250'000'000), 0);  // 4 ns

MemRequest request(Master master, std::uint32_t address, unsigned bytes) {
  MemRequest r;
  r.master = master;
  r.address = address;
  r.bytes = bytes;
  return r;
}

TEST(ReplaySlavesTest, RegistersTakeOneWordOfAMasterAfterTheOther) {
  ReplaySlaves slaves(kEdma);
  const MemRequest one = request(Master::kArmD, 0x01C0'0000, 4), other = request(Master::kEdmaTc0Write, 0x01C0'0000, 4);
  EXPECT_EQ(slaves.serve_registers(one, 10 * kNs, 100 * kNs), 110 * kNs);
  EXPECT_EQ(slaves.serve_registers(one, 10 * kNs, 101 * kNs), 120 * kNs) << "behind the first";
  EXPECT_EQ(slaves.serve_registers(one, 7 * kNs, 120 * kNs), 127 * kNs) << "just free";
  EXPECT_EQ(slaves.serve_registers(one, 7 * kNs, 128 * kNs), 135 * kNs);
  EXPECT_EQ(slaves.serve_registers(other, 101 * kNs), 121 * kNs) << "another master, by the EDMA's latency";
  EXPECT_EQ(slaves.serve_registers(request(Master::kEdmaTc1Write, 0x01C0'0000, 9), 0), 60 * kNs) << "three words";
}

// The first word comes ram_latency clocks after the first edge behind the arrival; the end is the last clock's edge.
TEST(ReplaySlavesTest, TheInternalRamTakesOneBurstAfterTheOther) {
  ReplaySlaves slaves(kEdma);
  const MemRequest burst = request(Master::kEdmaTc0Read, 0x1'0000, 16);
  EXPECT_EQ(slaves.serve_ram(burst, kCore, 100 * kNs), (26 + 3 + 8 - 1) * 4 * kNs) << "an edge is strictly after";
  EXPECT_EQ(slaves.serve_ram(burst, kCore, 101 * kNs), (37 + 3 + 8 - 1) * 4 * kNs) << "behind the first";
  EXPECT_EQ(slaves.serve_ram(request(Master::kEdmaTc1Read, 0x1'0002, 16), kCore, 1000 * kNs),
            (251 + 3 + 10 - 1) * 4 * kNs)
      << "16 bytes that are not aligned lie in five words";
}

TEST(ReplaySlavesTest, BurstsOfATransferWaitAsRecorded) {
  ReplaySlaves slaves(kEdma);
  slaves.expect(Master::kEdmaTc0Read, 48, {5, 0});  // three bursts; the last one has no more waits
  slaves.expect(Master::kEdmaTc0Read, 16, {9});
  const MemRequest burst = request(Master::kEdmaTc0Read, 0x1'0000, 16);
  const Picoseconds plain = ReplaySlaves(kEdma).serve_ram(burst, kCore, 0);
  const std::array<Picoseconds, 5> waits{5, 0, 0, 9, 0};
  for (std::size_t n = 0; n < waits.size(); ++n) {
    const Picoseconds arrival = n * 1000 * kNs;
    EXPECT_EQ(slaves.serve_ram(burst, kCore, arrival) - arrival, plain + waits[n] * 4 * kNs) << n;
    const Picoseconds later = arrival + 500 * kNs;
    EXPECT_EQ(slaves.serve_ram(request(Master::kEdmaTc0Write, 0x1'0000, 16), kCore, later) - later, plain)
        << "waits belong to a master";
  }
  EXPECT_EQ(slaves.waited_in_ram(), 14u);
}

TEST(ReplaySlavesTest, WhatIsDueFirstIsTakenFirstAndOfEqualTimesTheFirstAdded) {
  ReplaySlaves slaves(kEdma);
  EXPECT_EQ(slaves.next(), kNever);
  std::array<MemRequest, 4> r;
  slaves.add({&r[0], 20});
  slaves.add({&r[1], 10, true});
  slaves.add({&r[2], 20});
  slaves.add({&r[3], 19});
  EXPECT_EQ(slaves.next(), 10u);
  const auto first = slaves.take();
  EXPECT_EQ(first.request, &r[1]);
  EXPECT_TRUE(first.arrives);
  for (const MemRequest* expected : {&r[3], &r[0], &r[2]}) EXPECT_EQ(slaves.take().request, expected);
  EXPECT_EQ(slaves.next(), kNever);
}

}  // namespace
}  // namespace fovea::replay
