// State that the core keeps to run faster: chains of records, lines found last, hints for reads and
// writes. It must be discarded in time and must never be observable.
#include <limits>

#include "tb/iss/vectors.h"

namespace fovea::cpu::test {
namespace {

constexpr std::uint32_t kData = 0x0020'0000, kDataPhysical = kData;
const std::string kBegin = std::string(kCachesOn) + "ldr r4, =0x00200000\n";

/// Runs from cached memory. r4 points to cached data.
struct Cached : Machine {
  explicit Cached(const std::string& text) {
    port.set_word(kDataPhysical, 0x11111111);
    execute(kBegin + text, kMemory);
  }
  Cached(const std::string& text, std::function<void(Machine&, std::uint32_t)> at_svc) {
    on_svc = [this, at_svc](std::uint32_t n) { at_svc(*this, n); };
    execute(kBegin + text, kMemory);
  }
};

/// A chain is made of tail calls. Where the compiler makes one a real call the stack grows with
/// every turn of this loop, which takes all ways out of a chain and back into it.
TEST(ChainTest, StackDoesNotGrow) {
  Machine m;
  std::uintptr_t low = std::numeric_limits<std::uintptr_t>::max(), high = 0;
  const auto look = [&] {
    volatile char here = 0;
    const auto at = reinterpret_cast<std::uintptr_t>(&here);
    low = std::min(low, at);
    high = std::max(high, at);
  };
  unsigned turns = 0;
  m.on_svc = [&](std::uint32_t) {
    look();
    ++turns;
  };
  m.port.extra = [&] {
    look();
    return Picoseconds{0};
  };
  m.execute(kBegin + R"(
    ldr r8, =20000
    mov r7, r4
    ldr r6, =0x00300000
    ldr sp, =0x6000
  1: svc #3
    ldr r0, [r7], #32
    ldrb r1, [r7, #-31]
    add r1, r1, r0
    str r1, [r6], #4
    strb r1, [r6, #1]!
    strh r1, [r6, #3]!
    stmia r6!, {r0-r3}
    push {r0, r1, lr}
    bl 4f
    pop {r0, r1, lr}
    mrs r2, cpsr
    ldrd r2, r3, [r7]
    mul r2, r1, r0
    add r2, r2, r3
    bic r6, r6, #0x700000
    orr r6, r6, #0x300000
    bic r7, r7, #0x700000
    orr r7, r7, #0x200000
    subs r8, r8, #1
    bne 1b
    b 5f
    .ltorg
  4: bx lr
  5:
  )", kMemory);
  EXPECT_EQ(turns, 20000u);
  EXPECT_GT(m.core.counts().dcache_write_misses, 20000u);
  EXPECT_GT(m.core.counts().dcache_read_fills, 10000u);
  EXPECT_LT(high - low, 4096u);
}

TEST(ChainTest, StoreAfterCleanIsWrittenAgain) {
  Cached m(R"(
    ldr r0, [r4]
    mov r1, #1
    str r1, [r4]
    mcr p15, 0, r4, c7, c10, 1
    mov r1, #2
    str r1, [r4]
    mcr p15, 0, r4, c7, c10, 1
    mov r1, #0
    mcr p15, 0, r1, c7, c10, 4
  )");
  EXPECT_EQ(m.core.counts().dcache_writebacks, 2u);
  EXPECT_EQ(m.port.word(kDataPhysical), 2u);
}

TEST(ChainTest, OtherHalfOfALineIsCleanUntilWritten) {
  Cached m(R"(
    ldr r0, [r4]
    str r0, [r4]
    str r0, [r4]
    mcr p15, 0, r4, c7, c10, 1
    str r0, [r4, #16]
    str r0, [r4, #20]
    mcr p15, 0, r4, c7, c10, 1
    mov r1, #0
    mcr p15, 0, r1, c7, c10, 4
  )");
  unsigned halves = 0;
  for (const BusRecord& r : m.port.data_log())
    if (r.write && r.bytes == 16) {
      EXPECT_EQ(r.address, kDataPhysical + 16 * halves);
      ++halves;
    }
  EXPECT_EQ(halves, 2u);
}

/// Lines of one set by turns with one that is pushed out now and then, at each a quarter of the
/// chances. What was remembered of it must then not be read, nor written, long after the fill.
TEST(ChainTest, LineThatWasReplacedIsNotReadOrWritten) {
  constexpr std::uint32_t kLines = 12, kTurns = 8;
  Cached m(R"(
    mov r7, #8
  1: mov r8, #0
  2: add r5, r4, r8, lsl #11
    ldr r0, [r5]
    add r0, r0, r8
    str r0, [r5]
    mov r2, #100
  5: subs r2, r2, #1
    bne 5b
    mov r2, #0
  3: ldr r1, [r4, #2052]
    add r1, r1, #1
    str r1, [r4, #2052]
    add r2, r2, #1
    cmp r2, #30
    bne 3b
    add r8, r8, #1
    cmp r8, #12
    bne 2b
    subs r7, r7, #1
    bne 1b
  4: mrc p15, 0, r15, c7, c10, 3
    bne 4b
    mov r1, #0
    mcr p15, 0, r1, c7, c10, 4
  )");
  EXPECT_EQ(m.port.word(kDataPhysical + 2052), 30 * kLines * kTurns);
  for (std::uint32_t k = 0; k < kLines; ++k)
    EXPECT_EQ(m.port.word(kDataPhysical + 2048 * k), (k == 0 ? 0x11111111u : 0) + k * kTurns) << k;
  EXPECT_GT(m.core.counts().dcache_read_fills, kLines * kTurns / 2 + 10);
}

/// A line known to be absent comes into the cache: the next store belongs there.
TEST(ChainTest, StoreBesideTheCacheEndsWithTheFill) {
  Cached m(R"(
    mov r1, #1
    str r1, [r4]
    str r1, [r4, #4]
    ldr r0, [r4, #8]
    str r1, [r4, #12]
    mov r2, #0
    mcr p15, 0, r2, c7, c10, 4
    svc #3
    mcr p15, 0, r4, c7, c10, 1
    mcr p15, 0, r2, c7, c10, 4
  )", [](Machine& n, std::uint32_t) { EXPECT_EQ(n.port.word(kDataPhysical + 12), 0u); });
  EXPECT_EQ(m.core.counts().dcache_write_misses, 2u);
  EXPECT_EQ(m.port.word(kDataPhysical + 12), 1u);
}

/// The page becomes read-only after a store to it was remembered.
TEST(ChainTest, StoreToAPageThatWasTakenAwayAborts) {
  Machine m;
  m.section(kData, kDataPhysical, 1, 1, 3, 0);
  m.on_svc = [&](std::uint32_t n) {
    if (n == 6) m.section(kData, kDataPhysical, 1, 1, 0, 0);
  };
  m.load(assemble(kVectors + R"(
    ldr r0, =0x00100000
    bx r0
    .ltorg
  )", 0));
  const Program p = assemble(kBegin + R"(
    mov r0, #1
    mcr p15, 0, r0, c3, c0, 0
    mov r12, #0
  1: ldr r0, [r4]
    str r0, [r4]
    add r12, r12, #1
    cmp r12, #2
    bne 2f
    svc #6
    mov r1, #0
    mcr p15, 0, r1, c8, c7, 0
  2: cmp r12, #3
    bne 1b
    svc #2
    .ltorg
  )", kMemory);
  m.load(p);
  m.run();
  const auto seen = taken(m);
  ASSERT_EQ(seen.size(), 2u) << "the load and the store of the third turn";
  for (const Taken& t : seen) {
    EXPECT_EQ(t.kind, 4u);
    EXPECT_EQ(t.far, kData);
    EXPECT_EQ(t.dfsr, 0xDu);
  }
}

/// What the privileged mode may touch the user mode may not. (The line fill is long over.)
TEST(ChainTest, PrivilegedPageIsNotReadInUserMode) {
  Machine m;
  m.section(kData, kDataPhysical, 1, 1, 1, 0);
  m.load(assemble(kVectors + "ldr r0, =0x00100000\n bx r0\n .ltorg\n", 0));
  m.load(assemble(kBegin + R"(
    mov r0, #1
    mcr p15, 0, r0, c3, c0, 0
    ldr r0, [r4]
    str r0, [r4]
    ldr r0, [r4]
    str r0, [r4]
    mov r1, #200
  1: subs r1, r1, #1
    bne 1b
    msr cpsr_c, #0x10
    ldr r0, [r4]
    str r0, [r4]
    svc #2
    .ltorg
  )", kMemory));
  m.run();
  const auto seen = taken(m);
  ASSERT_EQ(seen.size(), 2u);
  for (const Taken& t : seen) EXPECT_EQ(t.dfsr, 0xDu);
}

/// Internal RAM is one memory for data and code: a store is seen by the next fetch, also of the
/// line that is being executed, and also when stores to that line were remembered before.
TEST(ChainTest, StoreToRunningCodeInInternalRam) {
  Machine m;
  m.execute(R"(
    ldr r4, =0x4000
    ldr r0, =0xe3a01001
    ldr r3, =0xe12fff1e
    mov r6, #0
    mov r7, #3
  1: str r0, [r4]
    str r3, [r4, #4]
    mov lr, pc
    bx r4
    add r6, r6, r1
    add r0, r0, #1
    subs r7, r7, #1
    bne 1b
    ldr r0, =0xe3a02009
    b 2f
    .ltorg
    .balign 32
  2: adr r5, 3f
    str r0, [r5]
    nop
  3: mov r2, #1
  )");
  EXPECT_EQ(m.core.reg(6), 1u + 2 + 3);
  EXPECT_EQ(m.core.reg(2), 9u);
}

/// Words looked up in the I-cache, by hand: one an instruction and two behind a taken branch.
TEST(ChainTest, WordsLookedUp) {
  struct Row {
    const char* what;
    unsigned each_turn;
    const char* text;
  };
  const Row rows[] = {
      {"a loop within a line", 3 + 2, "1: subs r8, r8, #1\n nop\n bne 1b\n"},
      {"a loop over two lines", 10 + 2,
       "1: nop\n nop\n nop\n nop\n nop\n nop\n nop\n nop\n subs r8, r8, #1\n bne 1b\n"},
      {"call and return within a line", 4 + 3 * 2,
       "1: bl 2f\n subs r8, r8, #1\n bne 1b\n b 3f\n2: bx lr\n3:\n"},
      {"call and return to another line", 4 + 3 * 2,
       "1: bl 2f\n subs r8, r8, #1\n bne 1b\n b 3f\n.balign 32\n2: bx lr\n3:\n"},
  };
  for (const Row& row : rows) {
    std::array<std::uint64_t, 2> per_run{};
    for (unsigned k = 0; k < 2; ++k) {
      std::vector<std::uint64_t> at;
      Cached m("mov r8, #" + std::to_string(k ? 110 : 10) + "\n svc #3\n b 4f\n.balign 32\n4:\n" +
                   row.text + "svc #3\n",
               [&](Machine& n, std::uint32_t) { at.push_back(n.core.counts().icache_accesses()); });
      ASSERT_EQ(at.size(), 2u);
      per_run[k] = at[1] - at[0];
    }
    EXPECT_EQ(per_run[1] - per_run[0], 100u * row.each_turn) << row.what;
  }
}

/// Issue and interlock clocks apart, by hand. In a chain issue is what the clock moved less the
/// stalls, so that their sum alone would say little.
TEST(ChainTest, IssueAndInterlockByHand) {
  std::vector<Counts> at;
  Cached m(R"(
    mov r8, #2
    ldr r0, [r4]
  1: svc #3
    mov r7, #100
  2: ldr r0, [r4]
    add r1, r0, #1
    ldrb r2, [r4]
    str r2, [r4, #4]
    mul r3, r7, r7
    addeq r3, r3, r3
    add r3, r3, r3
    umull r5, r6, r7, r7
    add r6, r6, r6, lsl r7
    ldmia r4, {r0, r1, r2}
    subs r7, r7, #1
    bne 2b
    svc #3
    subs r8, r8, #1
    bne 1b
  )", [&](Machine& n, std::uint32_t) { at.push_back(n.core.counts()); });
  ASSERT_EQ(at.size(), 4u);
  const Counts &from = at[2], &to = at[3];  // the second turn: everything is in the caches
  // ldr, add, ldrb, str, mul, addeq (never), add, umull, add by register, ldm, subs, bne
  const std::uint64_t issue = 100 * (1 + 1 + 1 + 1 + 2 + 1 + 1 + 3 + 2 + 3 + 1 + 3) - 2;
  // ldr-add 1, ldrb-str 2, mul hidden by addeq, umull-add 1
  const std::uint64_t interlock = 100 * (1 + 2 + 1);
  EXPECT_EQ(to.issue - from.issue, issue + 3 + 1);  // and the mark itself, and mov
  EXPECT_EQ(to.stall[static_cast<std::size_t>(Cause::kInterlock)] -
                from.stall[static_cast<std::size_t>(Cause::kInterlock)],
            interlock);
  EXPECT_EQ(to.instructions - from.instructions, 100u * 12 + 2);
}

/// A result that the last instructions of a line deliver late delays the first ones of the next line,
/// wherever the line ends.
TEST(ChainTest, InterlocksAreTheSameAcrossTheEndOfALine) {
  for (unsigned shift = 0; shift < 8; ++shift) {
    SCOPED_TRACE(shift);
    Machine m;
    std::string nops;
    for (unsigned k = 0; k < shift; ++k) nops += "    nop\n";
    m.execute(kBegin + R"(
    mov r8, #2
  1:
    mov r7, #20
    svc #1
    b 2f
    .balign 32
)" + nops + R"(
  2:
    ldr r0, [r4]
    add r1, r0, #1
    ldrb r2, [r4]
    add r3, r2, #1
    ldrb r2, [r4]
    nop
    add r3, r2, #1
    mul r5, r7, r7
    add r6, r5, r5
    ldmia r4, {r0, r1}
    add r1, r1, #1
    subs r7, r7, #1
    bne 2b
    svc #1
    subs r8, r8, #1
    bne 1b
  )",
              kMemory + 0x4000);  // cached: records of internal RAM do not rely on their neighbours
    ASSERT_EQ(m.marks.size(), 4u);
    // Issue 1+1+1+1+1+1+1+2+1+2+1+1+3, interlocks 1+2+1+1+1; the last bne falls through, and the
    // marks are around one b.
    EXPECT_EQ(m.between(2), 20u * (17 + 6) - 2 + 3);
  }
}

}  // namespace
}  // namespace fovea::cpu::test
