// A reset of the core: what is lost, what is kept, and at which instruction it takes effect.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

/// Reads CP15 registers 1, 2, 3, 5, 6, 13 into memory at r1.
const char* const kStoreCp15 = R"(
  mrc p15, 0, r0, c1, c0, 0
  str r0, [r1]
  mrc p15, 0, r0, c2, c0, 0
  str r0, [r1, #4]
  mrc p15, 0, r0, c3, c0, 0
  str r0, [r1, #8]
  mrc p15, 0, r0, c5, c0, 0
  str r0, [r1, #12]
  mrc p15, 0, r0, c6, c0, 0
  str r0, [r1, #16]
  mrc p15, 0, r0, c13, c0, 0
  str r0, [r1, #20]
  mrc p15, 0, r0, c9, c1, 0
  str r0, [r1, #24]
  mrc p15, 0, r0, c9, c0, 0
  str r0, [r1, #28]
)";

/// Resets the core when all that it has sent is answered. The clocks that it skips have no cause.
void reset(Machine& m, std::uint32_t entry) {
  m.port.now = std::max(m.port.now, m.core.boundary_time()) + kPsPerUs;
  const std::uint64_t clocks = m.core.clock_count();
  m.core.reset(entry, m.port.now);
  m.first_clock += m.core.clock_count() - clocks;
}

TEST(ResetTest, RegistersAndCoprocessorAreAsAfterPowerUp) {
  Machine m;
  m.execute(std::string(kCachesOn) + R"(
    mov r0, #5
    mcr p15, 0, r0, c5, c0, 0
    mcr p15, 0, r0, c6, c0, 0
    mov r0, #3
    mcr p15, 0, r0, c9, c0, 0
    mov r9, #1
    msr cpsr_c, #0xD1
    mov r9, #2
    svc #2
  )");
  reset(m, 0x200);
  EXPECT_EQ(m.core.cpsr(), 0xD3u);
  EXPECT_EQ(m.core.reg(15), 0x200u);
  EXPECT_EQ(m.core.reg(9), 1u);  // of supervisor mode again
  std::fill(m.tcm.begin() + 0x4000, m.tcm.end(), std::uint8_t{0xEE});
  m.execute(std::string("  ldr r1, =0x4000\n") + kStoreCp15, 0x200);
  const auto word = [&](std::uint32_t at) {
    std::uint32_t w = 0;
    std::memcpy(&w, m.tcm.data() + at, 4);
    return w;
  };
  EXPECT_EQ(word(0x4000), 0x0005'0078u);  // MMU and caches off, vectors at 0
  for (const std::uint32_t at : {4u, 8u, 12u, 16u, 20u, 28u})
    EXPECT_EQ(word(0x4000 + at), 0u) << at;
  EXPECT_EQ(word(0x4018), 0x0001'0019u);  // data TCM: on, 32 KB, at 0x10000
}

// A dirty line is lost, and code that was changed behind the core's back is seen.
TEST(ResetTest, CachesAreEmptyAndInternalRamIsKept) {
  Machine m;
  m.port.set_word(kMemory + 0x2000, 1);
  m.execute(std::string(kCachesOn) + R"(
    ldr r1, =0x00102000
    ldr r0, [r1]
    mov r0, #2
    str r0, [r1]
    ldr r1, =0x5000
    mov r0, #7
    str r0, [r1]
    svc #2
  )");
  EXPECT_EQ(m.virtual_byte(kMemory + 0x2000), 2);
  EXPECT_EQ(*m.port.at(kMemory + 0x2000), 1);
  reset(m, 0);
  EXPECT_EQ(m.virtual_byte(kMemory + 0x2000), 1);
  EXPECT_EQ(m.tcm[0x5000], 7);
  // The same addresses hold another program now.
  m.execute(R"(
    ldr r1, =0x00102000
    ldr r2, [r1]
    svc #2
  )");
  EXPECT_EQ(m.core.reg(2), 1u);
}

// As for an interrupt: a boundary strictly after the time of the reset sees it.
TEST(ResetTest, TakesEffectAtTheFirstBoundaryAfterIt) {
  for (const Picoseconds delay : {0, 1, 3'999, 4'000, 4'001}) {
    Machine m;
    m.load(assemble("1: add r0, r0, #1\n add r0, r0, #1\n b 1b\n", 0));
    m.core.reset(0, 0);
    constexpr Picoseconds kBegin = 400'000;
    m.port.schedule(kBegin + delay, [&] { m.core.set_reset(true, m.port.now); });
    m.core.run();
    EXPECT_TRUE(m.core.held());
    EXPECT_GT(m.core.boundary_time(), kBegin + delay);
    EXPECT_LE(m.core.boundary_time(), kBegin + delay + 3 * Machine::kClock);
    const std::uint64_t instructions = m.core.instructions_executed(), issue = m.core.counts().issue;
    m.core.set_reset(false, m.port.now);
    m.port.now += 1'000'000;
    const std::uint64_t clocks = m.core.clock_count();
    m.core.restart(0, m.port.now);
    EXPECT_FALSE(m.core.held());
    EXPECT_EQ(m.core.counts().idle, m.core.clock_count() - clocks);
    EXPECT_EQ(m.core.clock_count(), m.core.clock().edge_after(m.port.now));
    EXPECT_EQ(m.core.instructions_executed(), instructions);
    EXPECT_EQ(m.core.counts().issue, issue);
  }
}

}  // namespace
}  // namespace fovea::cpu::test
