// What debuggers and failure reports show of internal RAM, the buffers and the last accesses.
#include "tb/iss/debug_machine.h"

namespace fovea::cpu::test {
namespace {

/// Internal RAM is where the tables map it, and its virtual windows are memory where they say so.
TEST(CoreDebugTest, SeesInternalRamWhereItIsMapped) {
  DebugMachine m;
  const std::uint32_t coarse = kTables + 0x4000;
  m.port.set_word(kTables, coarse | 0x11u);
  for (std::uint32_t a = 0; a < 0x8000; a += 0x1000)
    m.port.set_word(coarse + 4 * (a >> 12), a | 0xFF2u);
  m.port.set_word(coarse + 4 * 0x10, kData | 0xFF2u);
  m.section(0x4000'0000, 0, 1, 1);
  m.port.set_word(kData, 0x77);
  m.on_svc = [&](std::uint32_t) {
    EXPECT_EQ(m.get(0x1'0000), 0x77u);
    m.put(0x1'0000, 0x78);
    EXPECT_EQ(m.port.word(kData), 0x78u);
    m.put(0x4001'6000, 0x66);  // the data window of the RAM
    EXPECT_EQ(m.tcm_word(0x6000), 0x66u);
    EXPECT_EQ(m.get(0x4000'6000), 0x66u);
    EXPECT_EQ(m.get(0x6000), 0x66u);
    m.put(0x4000'5000, 0xE3A05002u);  // mov r5, #2
  };
  m.load(assemble("mov r5, #1\n mov pc, lr\n", 0x5000));
  // Before and after the core has translated these pages itself.
  m.execute(std::string(kCachesOn) + R"(
    ldr r1, =0x10000
    ldr r2, =0x40006000
    mov r6, #0x5000
    mov lr, pc
    mov pc, r6
    svc #3
    ldr r3, [r1]
    ldr r4, [r2]
    mov lr, pc
    mov pc, r6
  )");
  EXPECT_EQ(m.core.reg(3), 0x78u);
  EXPECT_EQ(m.core.reg(4), 0x66u);
  EXPECT_EQ(m.core.reg(5), 2u) << "the patched instruction";
}

TEST(CoreDebugTest, PeekFindsPendingWritesByTheirPhysicalAddress) {
  DebugMachine m;
  m.section(0x4000'0000, kMemory, 0, 1);
  m.port.write_latency = 4'000'000;
  m.port.decide_late = true;
  m.on_svc = [&](std::uint32_t) {
    EXPECT_EQ(m.port.word(kData), 0u) << "all three are on their way";
    std::uint8_t b = 0;
    EXPECT_TRUE(m.core.peek(0x4000'1000, b));
    EXPECT_EQ(b, 0x33u) << "the youngest of two to one word";
    EXPECT_TRUE(m.core.peek(0x4000'1004, b));
    EXPECT_EQ(b, 0x22u);
    EXPECT_FALSE(m.core.peek(0x4000'1008, b));
    EXPECT_EQ(m.get(0x4000'1000), 0x33u);
  };
  m.execute(std::string(kCachesOn) + R"(
    ldr r1, =0x40001000
    mov r2, #0x11
    mov r3, #0x22
    mov r4, #0x33
    ldr r0, [r1, #64]
    str r2, [r1]
    str r3, [r1, #4]
    str r4, [r1]
    svc #3
    mcr p15, 0, r1, c7, c10, 4
  )");
  EXPECT_EQ(m.port.word(kData), 0x33u);
}

TEST(CoreDebugTest, WriteIsNotUndoneByAVictim) {
  DebugMachine m;
  m.port.beat = 800'000;  // the fill holds the port, so that its victim has to wait
  std::uint32_t victim = 0;
  m.on_svc = [&](std::uint32_t) {
    const CoreDebug::Pending p = m.debug.pending();
    ASSERT_EQ(p.victim_bytes, 16u);
    EXPECT_FALSE(p.write_on_bus);
    victim = p.victim;
    EXPECT_EQ(m.get(victim), 0x11u);
    EXPECT_EQ(m.port.word(victim), 0u);
    m.put(victim, 0x22);
    EXPECT_EQ(m.get(victim), 0x22u);
  };
  // Four dirty lines of one set, then a fifth.
  m.execute(std::string(kCachesOn) + R"(
    ldr r1, =0x00110000
    mov r2, #0x11
    mov r3, #4
    1:
    ldr r0, [r1]
    str r2, [r1], #0x800
    subs r3, r3, #1
    bne 1b
    ldr r0, [r1]
    svc #3
    mcr p15, 0, r1, c7, c10, 4
  )");
  EXPECT_EQ(m.port.word(victim), 0x22u);
}

/// The last accesses name each word of a block transfer, whichever way it went.
TEST(CoreDebugTest, LastAccessesHaveEachWordOfABlock) {
  DebugMachine m;
  std::vector<std::vector<AccessRecord>> seen;
  m.on_svc = [&](std::uint32_t) { seen.push_back(m.core.last_accesses()); };
  m.execute(R"(
    mov r3, #3
    mov r1, #0x4000
    1:
    ldmia r1, {r4-r7}
    svc #3
    stmia r1, {r4-r6}
    svc #3
    subs r3, r3, #1
    bne 1b
  )");
  ASSERT_EQ(seen.size(), 6u);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const std::size_t words = k % 2 ? 3 : 4;
    ASSERT_GE(seen[k].size(), words);
    for (std::size_t w = 0; w < words; ++w) {
      const AccessRecord& a = seen[k][seen[k].size() - words + w];
      EXPECT_EQ(a.pc, k % 2 ? 16u : 8u) << k;
      EXPECT_EQ(a.address, 0x4000u + 4 * w) << k;
      EXPECT_EQ(a.bytes, 4u);
      EXPECT_EQ(a.write, k % 2 == 1);
    }
  }
}

}  // namespace
}  // namespace fovea::cpu::test
