// Exceptions other than aborts: entry, return, masks, and the time at which a line is sampled.
#include <random>

#include "tb/iss/vectors.h"

namespace fovea::cpu::test {
namespace {

/// Interrupts on (system mode, so that every bank is another one), then what follows.
const std::string kOpen = kVectors + " msr cpsr_c, #0x1f\n";

class InterruptTest : public testing::Test {
 protected:
  Machine m;
  InterruptTest() { lower_on_service(m); }
  static void lower_on_service(Machine& machine) {
    machine.on_svc = [&machine](std::uint32_t n) {
      if (n == 4) machine.core.set_irq(false, machine.time());
      if (n == 5) machine.core.set_fiq(false, machine.time());
    };
  }
  static void raise(Machine& machine, Picoseconds t, bool fiq = false) {
    machine.port.schedule(t, [&machine, t, fiq] {
      fiq ? machine.core.set_fiq(true, t) : machine.core.set_irq(true, t);
      machine.port.interrupt_at(t);
    });
  }
};

/// Instruction n of the sled begins at clock c + n; an edge at time t is seen by the first of them
/// that begins strictly after t.
TEST_F(InterruptTest, EdgeIsSeenStrictlyAfterIt) {
  std::string sled = kOpen + "svc #1\n sled:\n";
  for (unsigned k = 0; k < 60; ++k) sled += "mov r0, #" + std::to_string(k) + "\n";
  m.execute(sled);
  const Picoseconds begin = (m.marks[0] + 3) * Machine::kClock;
  struct Row {
    Picoseconds offset;
    unsigned instruction;
  };
  for (const Row& row : {Row{0, 1}, Row{1, 1}, Row{3999, 1}, Row{4000, 2}, Row{4001, 2},
                         Row{39'999, 10}, Row{40'000, 11}, Row{80'000 - 1, 20}, Row{80'000, 21}}) {
    for (const bool fiq : {false, true}) {
      Machine each;
      lower_on_service(each);
      raise(each, begin + row.offset, fiq);
      each.load(m.program);
      each.run();
      const auto t = taken(each);
      ASSERT_EQ(t.size(), 1u) << row.offset;
      EXPECT_EQ(t[0].kind, fiq ? 7u : 6u);
      EXPECT_EQ(t[0].lr - 4, m.program.symbols.at("sled") + 4 * row.instruction) << row.offset;
      EXPECT_EQ(t[0].cpsr & 0xFFu, fiq ? 0xD1u : 0x92u);
      EXPECT_EQ(t[0].spsr & 0xFFu, 0x1Fu);
      EXPECT_EQ(each.core.reg(0), 59u) << "back in the sled";
    }
  }
}

/// The instruction whose line is on its way has not begun.
TEST_F(InterruptTest, EdgeDuringALineFillGoesBeforeTheInstructionThatWaits) {
  constexpr std::uint32_t kFar = 0x0020'0000;
  const Program far = assemble("svc #1\n mov pc, lr\n", kFar);
  m.load(far);
  m.execute(kVectors + kCachesOn +
            " msr cpsr_c, #0x1f\n ldr r8, =0x00200000\n svc #1\n blx r8\n");
  ASSERT_EQ(m.marks.size(), 2u);
  const std::uint64_t from = m.marks[0] + 3 + 3, to = m.marks[1];  // after svc and branch
  ASSERT_GT(to, from + 8) << "the fill takes time";
  for (const std::uint64_t clock : {from + 2, (from + to) / 2, to - 2}) {
    Machine each;
    lower_on_service(each);
    raise(each, clock * Machine::kClock + 1);
    each.load(far);
    each.load(m.program);
    each.run();
    const auto t = taken(each);
    ASSERT_FALSE(t.empty()) << clock;
    EXPECT_EQ(t[0].kind, 6u);
    EXPECT_EQ(t[0].lr - 4, kFar) << clock << " of " << from << ".." << to;
  }
}

TEST_F(InterruptTest, LongInstructionIsNotBrokenOff) {
  m.execute(kOpen + "ldr r4, =0x6000\n svc #1\n sled: ldmia r4, {r0-r3, r5-r12}\n nop\n nop\n");
  Machine each;
  lower_on_service(each);
  raise(each, (m.marks[0] + 3 + 4) * Machine::kClock);
  each.load(m.program);
  each.run();
  const auto t = taken(each);
  ASSERT_EQ(t.size(), 1u);
  EXPECT_EQ(t[0].lr - 4, m.program.symbols.at("sled") + 4);
}

TEST_F(InterruptTest, MasksHoldTheLineBack) {
  raise(m, 0);
  m.execute(kVectors +
            "msr cpsr_c, #0xdf\n mov r0, #1\n mov r0, #2\n msr cpsr_c, #0x9f\n mov r0, #3\n"
            "msr cpsr_c, #0x1f\n open: mov r0, #4\n");
  const auto t = taken(m);
  ASSERT_EQ(t.size(), 1u);
  EXPECT_EQ(t[0].lr - 4, m.program.symbols.at("open"));
  Machine fast;
  lower_on_service(fast);
  raise(fast, 0, true);
  fast.execute(
      kVectors +
      "msr cpsr_c, #0x5f\n mov r0, #1\n mov r0, #2\n msr cpsr_c, #0x9f\n open: mov r0, #3\n");
  const auto f = taken(fast);
  ASSERT_EQ(f.size(), 1u);
  EXPECT_EQ(f[0].kind, 7u);
  EXPECT_EQ(f[0].lr - 4, fast.program.symbols.at("open"));
}

TEST_F(InterruptTest, FastGoesFirst) {
  raise(m, 400'000);
  raise(m, 400'000, true);
  m.execute(kOpen + "mov r0, #200\n 1: subs r0, r0, #1\n bne 1b\n");
  const auto t = taken(m);
  ASSERT_EQ(t.size(), 2u);
  EXPECT_EQ(t[0].kind, 7u);
  EXPECT_EQ(t[1].kind, 6u);
}

TEST_F(InterruptTest, PulseThatEndsBeforeABoundaryIsLost) {
  m.execute(kOpen + "svc #1\n mov r0, #10\n 1: subs r0, r0, #1\n bne 1b\n");
  const Picoseconds t = (m.marks[0] + 10) * Machine::kClock;
  Machine each;
  lower_on_service(each);
  each.port.schedule(t + 1, [&] { each.core.set_irq(true, t + 1); });
  each.port.schedule(t + 2, [&] { each.core.set_irq(false, t + 2); });
  each.load(m.program);
  each.run();
  EXPECT_TRUE(taken(each).empty());
}

TEST_F(InterruptTest, ThumbProgramIsInterruptedAndResumed) {
  const std::string text =
      kOpen +
      "svc #1\n adr r0, 2f + 1\n bx r0\n .thumb\n .align 2\n2:\n movs r1, #50\n"
      "1: adds r2, #1\n subs r1, #1\n bne 1b\n bx pc\n nop\n .arm\n";
  m.execute(text);
  for (unsigned k = 20; k < 30; ++k) {
    Machine each;
    lower_on_service(each);
    raise(each, (m.marks[0] + k) * Machine::kClock);
    each.load(m.program);
    each.run();
    const auto t = taken(each);
    ASSERT_EQ(t.size(), 1u);
    EXPECT_EQ(t[0].spsr & 0x3Fu, 0x3Fu) << "Thumb state is kept in the SPSR";
    EXPECT_EQ(t[0].cpsr & 0x20u, 0u);
    EXPECT_EQ(each.core.reg(2), m.core.reg(2));
    EXPECT_EQ(each.core.reg(1), 0u);
  }
}

TEST_F(InterruptTest, SoftwareAndUndefined) {
  m.execute(
      kOpen +
      "1: svc #0x123456\n 2: .word 0xe7f000f0\n 3: mcr p14, 0, r0, c0, c0, 0\n adr r0, 1b\n"
      "adr r1, 2b\n adr r2, 3b\n msr cpsr_c, #0x10\n mrc p15, 0, r3, c0, c0, 0\n mov r4, #4\n");
  const auto t = taken(m);
  ASSERT_EQ(t.size(), 4u);
  EXPECT_EQ(t[0].kind, 2u);
  EXPECT_EQ(t[0].lr, m.core.reg(0) + 4);
  EXPECT_EQ(t[0].cpsr & 0x1Fu, 0x13u);
  EXPECT_EQ(t[0].cpsr & 0xC0u, 0x80u) << "IRQ off, FIQ as it was";
  EXPECT_EQ(t[1].kind, 1u);
  EXPECT_EQ(t[1].lr, m.core.reg(1) + 4);
  EXPECT_EQ(t[1].cpsr & 0x1Fu, 0x1Bu);
  EXPECT_EQ(t[2].kind, 1u);
  EXPECT_EQ(t[2].lr, m.core.reg(2) + 4);
  EXPECT_EQ(t[3].kind, 1u) << "CP15 in user mode";
  EXPECT_EQ(t[3].spsr & 0x1Fu, 0x10u);
  EXPECT_EQ(m.core.reg(4), 4u);
}

TEST_F(InterruptTest, OddRegisterPairAndThumbUndefined) {
  m.execute(
      kOpen +
      "ldr r4, =0x6000\n .word 0xe1c410d0 @ ldrd r1\n adr r0, 1f + 1\n bx r0\n .thumb\n .align 2\n"
      "1: .short 0xde00\n movs r7, #7\n bx pc\n nop\n .arm\n");
  const auto t = taken(m);
  ASSERT_EQ(t.size(), 2u);
  EXPECT_EQ(t[0].kind, 1u);
  EXPECT_EQ(t[1].kind, 1u);
  EXPECT_EQ(t[1].lr & 3u, 2u) << "Thumb: two bytes on";
  EXPECT_EQ(m.core.reg(7), 7u);
}

TEST_F(InterruptTest, HighVectors) {
  // 0xFFFF0000 maps to the internal RAM's image in memory; V is set, then an SWI.
  m.section(0xFFF0'0000, 0x0020'0000, 0, 0);
  const Program there = assemble("b .\n b .\n mov r9, #77\n movs pc, lr\n", 0x002F'0000);
  m.load(there);
  m.port.set_word(0x002F'0008, 0xE3A0904Du);  // mov r9, #77 at the SWI vector
  m.port.set_word(0x002F'000C, 0xE1B0F00Eu);  // movs pc, lr
  m.execute(std::string(kCachesOn) +
            "mrc p15, 0, r0, c1, c0, 0\n orr r0, r0, #0x2000\n"
            "mcr p15, 0, r0, c1, c0, 0\n msr cpsr_c, #0xdf\n svc #0x99\n mov r8, #8\n");
  EXPECT_EQ(m.core.reg(9), 77u);
  EXPECT_EQ(m.core.reg(8), 8u);
}

TEST_F(InterruptTest, BankedRegisters) {
  m.execute(
      kVectors +
      "msr cpsr_c, #0xd1\n mov r8, #18\n mov r12, #22\n mov sp, #1\n mov lr, #2\n"
      "msr cpsr_c, #0xd2\n mov sp, #3\n mov lr, #4\n mov r8, #8\n mov r12, #12\n"
      "msr cpsr_c, #0xd3\n mov sp, #5\n mov lr, #6\n msr cpsr_c, #0xd7\n mov sp, #7\n mov lr, #9\n"
      "msr cpsr_c, #0xdb\n mov sp, #10\n mov lr, #11\n msr cpsr_c, #0xdf\n mov sp, #13\n mov lr, "
      "#14\n"
      "ldr r0, =0x6000\n"
      "msr cpsr_c, #0xd1\n stmia r0!, {r8, r12, sp, lr}\n msr cpsr_c, #0xd2\n stmia r0!, {r8, r12, "
      "sp, lr}\n"
      "msr cpsr_c, #0xd3\n stmia r0!, {r8, r12, sp, lr}\n msr cpsr_c, #0xd7\n stmia r0!, {r8, r12, "
      "sp, lr}\n"
      "msr cpsr_c, #0xdb\n stmia r0!, {r8, r12, sp, lr}\n msr cpsr_c, #0xdf\n stmia r0!, {r8, r12, "
      "sp, lr}\n");
  const std::uint32_t want[] = {18, 22, 1, 2, 8, 12, 3,  4,  8, 12, 5,  6,
                                8,  12, 7, 9, 8, 12, 10, 11, 8, 12, 13, 14};
  for (unsigned k = 0; k < std::size(want); ++k)
    EXPECT_EQ(m.tcm_word(0x6000 + 4 * k), want[k]) << k;
}

TEST_F(InterruptTest, UserBankTransfers) {
  m.execute(
      kVectors +
      "msr cpsr_c, #0xdf\n mov sp, #13\n mov lr, #14\n msr cpsr_c, #0xd3\n mov sp, #33\n mov lr, "
      "#34\n"
      "ldr r0, =0x6000\n stmia r0, {r13, r14}^\n ldr r1, =0x6100\n mov r2, #50\n mov r3, #51\n"
      "stmia r1, {r2, r3}\n ldmia r1, {r13, r14}^\n nop\n mov r4, sp\n mov r5, lr\n"
      "msr cpsr_c, #0xdf\n mov r6, sp\n mov r7, lr\n");
  EXPECT_EQ(m.tcm_word(0x6000), 13u);
  EXPECT_EQ(m.tcm_word(0x6004), 14u);
  EXPECT_EQ(m.core.reg(4), 33u);
  EXPECT_EQ(m.core.reg(5), 34u);
  EXPECT_EQ(m.core.reg(6), 50u);
  EXPECT_EQ(m.core.reg(7), 51u);
}

TEST_F(InterruptTest, LdmWithPcAndCaretRestoresTheState) {
  m.execute(
      kVectors +
      "msr cpsr_c, #0xd3\n ldr r0, =0xf0000010\n msr spsr_cf, r0\n adr r2, 1f\n ldr r1, =0x6000\n"
      "str r2, [r1]\n ldmia r1, {pc}^\n nop\n1: mrs r3, cpsr\n");
  EXPECT_EQ(m.core.reg(3) & 0xF00000DFu, 0xF0000010u);
}

TEST_F(InterruptTest, UserModeCannotChangeItsMode) {
  m.execute(kVectors +
            "msr cpsr_c, #0x10\n msr cpsr_c, #0x13\n ldr r0, =0xf00000d3\n msr cpsr_cf, r0\n mrs "
            "r1, cpsr\n");
  EXPECT_EQ(m.core.reg(1) & 0xF00000FFu, 0xF0000010u);
}

TEST_F(InterruptTest, WaitForInterruptSleepsAndWakesAtTheNextClock) {
  const std::string text =
      kVectors + "msr cpsr_c, #0xdf\n mov r0, #0\n svc #1\n mcr p15, 0, r0, c7, c0, 4\n svc #1\n";
  raise(m, 1'000'001);  // masked, and it wakes all the same
  m.execute(text);
  EXPECT_EQ(m.marks[1], 251u) << "clock 250 begins at 1 us, the edge is just after it";
  EXPECT_TRUE(taken(m).empty());
  EXPECT_EQ(m.core.counts().idle, 251u - (m.marks[0] + 3 + 1));
  Machine exact;
  raise(exact, 1'000'000);
  exact.execute(text);
  EXPECT_EQ(exact.marks[1], 251u) << "seen strictly after";
}

TEST_F(InterruptTest, WaitForInterruptDrainsTheBuffersFirst) {
  raise(m, 2'000'000);
  m.execute(kVectors + std::string(kCachesOn) +
            "ldr r4, =0x00200000\n mov r0, #0\n mov r1, #7\n str r1, [r4]\n str r1, [r4, #64]\n"
            "mcr p15, 0, r0, c7, c0, 4\n");
  EXPECT_EQ(m.port.word(0x0020'0000), 7u);
  EXPECT_EQ(m.port.word(0x0020'0040), 7u);
  for (const auto& r : m.port.log) EXPECT_LT(r.last, 2'000'000u);
}

}  // namespace
}  // namespace fovea::cpu::test
