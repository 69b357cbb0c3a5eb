// Interrupt latency with zero-wait memory, counted by hand from ARM DDI 0165B 5.3.
#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

/// Vectors at 0; `interrupt:`, `fast:` and `start:` follow from the test. Fills cost nothing: the
/// program and its data lie in internal RAM, page table entries in the TLB.
const std::string kTable = R"(
  b start
  b .
  b .
  b .
  b data
  nop
  b interrupt
fast:
  svc #1
  svc #2
)";

class LatencyTest : public testing::Test {
 protected:
  /// Runs once to find when the instruction behind the first mark begins, then again with the line
  /// going up at that clock plus `after`.
  static Machine& raised(Machine& m, const std::string& text, bool fiq, Picoseconds after = 0) {
    Machine first;
    prepare(first);
    first.execute(text);
    const Picoseconds t = (first.marks.at(0) + 3) * Machine::kClock + after;
    prepare(m);
    m.on_svc = [&m](std::uint32_t n) {
      if (n == 4) m.core.set_irq(false, m.time());
    };
    m.port.schedule(t, [&m, t, fiq] { fiq ? m.core.set_fiq(true, t) : m.core.set_irq(true, t); });
    m.load(first.program);
    m.run();
    m.program = first.program;
    return m;
  }
  /// The first megabyte has pages, of domain 1: those of internal RAM, and one behind its data
  /// window that leads to memory and that no mode may read where domain 1 is a client.
  static void prepare(Machine& m) {
    constexpr std::uint32_t kCoarse = kTables + 0x8000;
    m.port.set_word(kTables, kCoarse | 1u << 5 | 0x11u);
    for (std::uint32_t page = 0; page < 0x18; ++page)
      m.port.set_word(kCoarse + 4 * page, page << 12 | 0xFF2u);
    m.port.set_word(kCoarse + 4 * 0x18, kMemory | 0x00Eu);
  }
};

/// Registers r0 to pc from 0x17fc4 on: fifteen words lie in the data window of the internal RAM,
/// the last behind it, which no mode may read once domain 1 is a client. Both pages are in the TLB.
const std::string kAbortingLdm =
    kTable + "interrupt: data: svc #1\n svc #2\nstart:" + kCachesOn + R"(
  ldr r1, =0x18000
  ldr r0, [r1]
  ldr r0, [r1, #-4]
  mov r0, #0x7
  mcr p15, 0, r0, c3, c0, 0
  msr cpsr_c, #0x1f
  ldr r0, =0x17fc4
  svc #1
  ldmia r0, {r0-pc}
)";

/// Sixteen clocks of LDM, one in which the last word comes with its abort, one that finds it, three
/// of entry (prepare, fetch, decode) for the abort and three for FIQ: 24, and the handler's first
/// instruction executes in the 25th.
TEST_F(LatencyTest, FastWorstCaseIsTwentyFourClocks) {
  Machine m;
  raised(m, kAbortingLdm, true);
  EXPECT_EQ(m.between(), 16u + 1 + 1 + 3 + 3);
}

/// The same without FIQ, for LDM and for a single load; three clocks more are the vector's branch.
TEST_F(LatencyTest, AbortIsTakenWhenTheLastWordWasDue) {
  Machine several;
  prepare(several);
  several.execute(kAbortingLdm);
  EXPECT_EQ(several.between(), 16u + 1 + 1 + 3 + 3);
  std::string text = kAbortingLdm;
  text.replace(text.find("ldmia"), std::string::npos, "ldr r1, [r1]\n");
  Machine one;
  prepare(one);
  one.execute(text);
  EXPECT_EQ(one.between(), 1u + 1 + 1 + 3 + 3);
}

/// Without an abort the longest LDM takes 16 + 4 clocks, since it also branches, and the entry 3.
TEST_F(LatencyTest, FastBehindTheLongestLoad) {
  Machine m;
  raised(m,
         kTable + "interrupt: data: b .\nstart:\n ldr r0, =0x4000\n adr r1, 1f\n" +
             "str r1, [r0, #60]\n msr cpsr_c, #0x1f\n svc #1\n ldmia r0, {r0-pc}\n1:\n",
         true);
  EXPECT_EQ(m.between(), 16u + 4 + 3);
}

/// The line goes up while an instruction of one clock is in its first: it ends, and after the three
/// clocks of entry the vector's instruction executes.
TEST_F(LatencyTest, FastBehindOneClock) {
  for (const Picoseconds after : {Picoseconds{0}, Picoseconds{1}, Machine::kClock - 1}) {
    Machine m;
    raised(m,
           kTable + "interrupt: data: b .\nstart:\n msr cpsr_c, #0x1f\n svc #1\n" +
               "add r0, r0, #1\n add r0, r0, #1\n",
           true, after);
    EXPECT_EQ(m.between(), 1u + 3) << after;
  }
}

/// An instruction that waits for a load is not begun: LDRB at the edge's clock, then the entry,
/// whose three clocks pass while the byte comes.
TEST_F(LatencyTest, FastBeforeAnInterlockedInstruction) {
  Machine m;
  raised(m,
         kTable +
             "interrupt: data: b .\nstart:\n ldr r1, =0x4000\n msr cpsr_c, #0x1f\n svc #1\n"
             "ldrb r0, [r1]\n add r0, r0, #1\n",
         true);
  EXPECT_EQ(m.between(), 1u + 3);
}

/// A usual IRQ, entry to return: how much later the interrupted instructions are done.
TEST_F(LatencyTest, UsualInterruptFromEdgeToReturn) {
  Machine m;
  raised(m, kTable + R"(
interrupt:                          @ 3      entry; and 3 of the branch in the vector
  sub lr, lr, #4                    @ 1
  stmfd sp!, {r0-r3, r12, lr}       @ 6
  ldr r0, [r11]                     @ 1      a status in internal RAM
  add r2, r11, #16                  @ 1
  and r0, r0, #7                    @ 1      a word, one instruction between
  ldr r1, [r2, r0, lsl #2]          @ 2
  add r1, r1, #1                    @ 1 + 1
  str r1, [r2, r0, lsl #2]          @ 2
  svc #4                            @ 3      lowers the line
  ldmfd sp!, {r0-r3, r12, pc}^      @ 6 + 4
data: b .
start:
  ldr r11, =0x4000
  mov r0, #2
  str r0, [r11]
  msr cpsr_c, #0xd2
  ldr sp, =0x5000
  msr cpsr_c, #0x1f
  svc #1
  add r0, r0, #1
  add r0, r0, #1
  add r0, r0, #1
  add r0, r0, #1
  svc #1
)",
         false, Machine::kClock);
  EXPECT_EQ(m.between(), 4u + 3 + 3 + 1 + 6 + 1 + 1 + 1 + 2 + 2 + 2 + 3 + 10);
  EXPECT_EQ(m.core.reg(0), 6u);
  EXPECT_EQ(m.tcm_word(0x4000 + 16 + 8), 1u);
}

}  // namespace
}  // namespace fovea::cpu::test
