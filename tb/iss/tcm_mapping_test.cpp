// Under the MMU, the physical address selects internal RAM: model/decisions/0008-internal-ram.md.
#include "tb/iss/vectors.h"

namespace fovea::cpu::test::tcm_mapping {
namespace {

constexpr std::uint32_t kCoarse = kTables + 0x8000, kFine = kTables + 0xA000;
constexpr std::uint32_t kVa = 0x0800'0000, kPa = 0x0030'0000, kWindow = 0x1'0000;

class TcmMappingTest : public testing::Test {
 protected:
  Machine m;

  static void coarse(Machine& m, std::uint32_t va, std::uint32_t table) {
    m.port.set_word(kTables + 4 * (va >> 20), table | 0x11u);
  }
  /// Small page with full access. @param cb bit 1 cacheable, bit 0 bufferable
  static void page(Machine& m, std::uint32_t table, std::uint32_t va, std::uint32_t pa,
                   unsigned cb = 0) {
    m.port.set_word(table + 4 * (va >> 12 & 0xFFu), (pa & ~0xFFFu) | 0xFF2u | cb << 2);
  }
  /// The instruction window maps to itself, so that vectors and program stay where they are.
  static void low_pages(Machine& m) {
    coarse(m, 0, kCoarse);
    for (std::uint32_t a = 0; a < 0x8000; a += 0x1000) page(m, kCoarse, a, a);
  }
  std::vector<Taken> faults() const { return taken(m); }
};

const std::string kStart =
    kVectors + kCachesOn + " ldr r4, =0x10000\n ldr r5, =0x08000000\n ldr r6, =0x00300000\n";

/// Where a Linux program has its code and data: the virtual window is an address like any other.
TEST_F(TcmMappingTest, PageAtTheWindowsVirtualAddressReachesItsMemory) {
  for (const unsigned cb : {0u, 1u, 2u, 3u}) {
    Machine each;
    low_pages(each);
    page(each, kCoarse, kWindow, kPa, cb);
    each.port.set_word(kPa, 0xABCD);
    std::memset(each.tcm.data(), 0x5A, 0x1000);
    each.load(assemble("mov r9, #99\n ldr r8, [r4]\n mov pc, lr\n", kPa + 0x100));
    each.execute(kStart +
                 "ldr r0, [r4]\n mov r1, #77\n str r1, [r4, #4]\n strb r1, [r4, #8]\n"
                 "mov r2, #78\n add r7, r4, #16\n stmia r7, {r1, r2}\n ldmia r7, {r2, r3}\n"
                 "add r7, r4, #32\n swp r10, r1, [r7]\n add r7, r4, #0x100\n mov lr, pc\n"
                 "mov pc, r7\n"
                 "1: mrc p15, 0, r15, c7, c10, 3\n bne 1b\n mov r0, r0\n"
                 "mov r12, #0\n mcr p15, 0, r12, c7, c10, 4\n");
    EXPECT_TRUE(taken(each).empty()) << cb;
    EXPECT_EQ(each.core.reg(8), 0xABCDu) << cb;
    EXPECT_EQ(each.core.reg(9), 99u) << cb << ": executed from memory";
    EXPECT_EQ(each.core.reg(3), 78u) << cb;
    EXPECT_EQ(each.port.word(kPa + 4), 77u) << cb;
    EXPECT_EQ(each.port.word(kPa + 8), 77u) << cb;
    EXPECT_EQ(each.port.word(kPa + 16), 77u) << cb;
    EXPECT_EQ(each.port.word(kPa + 20), 78u) << cb;
    EXPECT_EQ(each.port.word(kPa + 32), 77u) << cb;
    EXPECT_EQ(each.core.counts().dtcm_reads + each.core.counts().dtcm_writes, 0u) << cb;
    EXPECT_EQ(each.core.counts().dcache_reads > 0, cb >= 2) << cb << ": cached as its page says";
  }
}

/// C and B of such a page do not matter; a page walk is all that reaches the bus.
TEST_F(TcmMappingTest, PageThatMapsTheRamElsewhereReachesTheRam) {
  for (const unsigned cb : {0u, 1u, 2u, 3u})
    for (const bool by_data_window : {false, true}) {
      Machine each;
      low_pages(each);
      coarse(each, kVa, kCoarse + 0x400);
      page(each, kCoarse + 0x400, kVa, (by_data_window ? kWindow : 0) + 0x6000, cb);
      each.tcm[0x6040] = 9;  // other lines of the page, which nothing knows yet
      std::vector<Counts> counts;
      each.on_svc = [&](std::uint32_t) {
        each.marks.push_back(each.port.data_log().size());
        counts.push_back(each.core.counts());
      };
      each.execute(kStart +
                   "mov r1, #77\n mov r2, #78\n svc #3\n str r1, [r5]\n svc #3\n"
                   "add r7, r5, #8\n stmia r7, {r1, r2}\n strh r2, [r5, #4]\n ldr r8, [r5]\n"
                   "ldmia r7, {r9, r10}\n swp r11, r2, [r5]\n ldr r8, [r5]\n ldr r3, [r5, #64]\n"
                   "str r1, [r5, #128]\n svc #3\n");
      EXPECT_EQ(each.marks[1] - each.marks[0], 2u) << "a walk of two levels";
      EXPECT_EQ(each.marks[2] - each.marks[1], 0u) << cb;
      EXPECT_EQ(each.core.reg(11), 77u);
      EXPECT_EQ(each.core.reg(8), 78u);
      EXPECT_EQ(each.core.reg(3), 9u) << cb;
      EXPECT_EQ(each.tcm_word(0x6080), 77u) << cb;
      EXPECT_EQ(each.core.reg(10), 78u);
      EXPECT_EQ(each.tcm_word(0x6000), 78u);
      EXPECT_EQ(each.tcm_word(0x6004) & 0xFFFFu, 78u);
      EXPECT_EQ(each.tcm_word(0x6008), 77u);
      const auto added = [&](std::uint64_t Counts::*which) {
        return counts.at(2).*which - counts.at(0).*which;
      };
      EXPECT_EQ(added(by_data_window ? &Counts::dtcm_reads : &Counts::itcm_reads), 6u) << cb;
      EXPECT_EQ(added(by_data_window ? &Counts::dtcm_writes : &Counts::itcm_writes), 6u) << cb;
      EXPECT_EQ(added(by_data_window ? &Counts::itcm_reads : &Counts::dtcm_reads), 0u) << cb;
      EXPECT_EQ(counts[2].dcache_reads + counts[2].dcache_writes, 0u) << cb;
    }
}

/// Code in the RAM, mapped elsewhere: it takes the RAM's clocks, and stores through another mapping
/// are seen by the next fetch, as the RAM has one copy.
TEST_F(TcmMappingTest, CodeRunsInTheRamWhereverItIsMapped) {
  low_pages(m);
  page(m, kCoarse, kWindow + 0x4000, kWindow + 0x4000);
  coarse(m, kVa, kCoarse + 0x400);
  page(m, kCoarse + 0x400, kVa, 0x4000, 3);
  m.load(assemble("mov r9, #1\n mov r0, r0\n mov r0, r0\n mov pc, lr\n", 0x4100));
  const std::uint32_t replaced = 0xE3A09002u;  // mov r9, #2
  m.execute(kStart + "add r7, r5, #0x100\n mov r10, #0\n ldr r2, =" + std::to_string(replaced) +
            "\n add r1, r4, #0x4100\n mov lr, pc\n mov pc, r7\n mov r10, r9\n"
            "mov lr, pc\n mov pc, r7\n str r2, [r1]\n mov r11, r11\n svc #1\n mov lr, pc\n"
            "mov pc, r7\n svc #1\n");
  EXPECT_TRUE(faults().empty());
  EXPECT_EQ(m.core.reg(10), 1u);
  EXPECT_EQ(m.core.reg(9), 2u) << "the store through the data window is seen";
  EXPECT_EQ(m.between(), 1u + 4 + 3 + 4) << "mov, mov pc, three movs, mov pc: no wait states";
  EXPECT_EQ(m.core.counts().icache_fills, 0u);
}

TEST_F(TcmMappingTest, ChangedMappingTakesEffectBehindTheInvalidation) {
  low_pages(m);
  page(m, kCoarse, kWindow, kPa, 3);
  m.port.set_word(kPa, 1);
  m.on_svc = [this](std::uint32_t n) { page(m, kCoarse, kWindow, n == 3 ? kWindow : kPa, 3); };
  // Twice, so that everything is known that makes the second access quick.
  const std::string both = "ldr r0, [r4]\n str r0, [r4, #4]\n ldr r0, [r4]\n str r0, [r4, #4]\n";
  m.execute(kStart + both + "mov r7, r0\n svc #3\n" + both + "mov r8, r0\n" +
            "mcr p15, 0, r4, c8, c7, 1\n" + both + "mov r9, r0\n ldr r11, [r4, #4]\n" +
            "svc #4\n mcr p15, 0, r4, c8, c7, 1\n mov r3, #5\n str r3, [r4]\n ldr r10, [r4]\n" +
            "1: mrc p15, 0, r15, c7, c10, 3\n bne 1b\n mov r0, r0\n"
            "mov r12, #0\n mcr p15, 0, r12, c7, c10, 4\n");
  const std::uint32_t vector = m.tcm_word(0);
  EXPECT_EQ(m.core.reg(7), 1u);
  EXPECT_EQ(m.core.reg(8), 1u) << "the TLB still has the old page";
  EXPECT_EQ(m.core.reg(9), vector) << "the RAM's first word";
  EXPECT_EQ(m.core.reg(11), vector);
  EXPECT_EQ(m.tcm_word(4), vector);
  EXPECT_EQ(m.core.reg(10), 5u);
  EXPECT_EQ(m.port.word(kPa), 5u) << "memory again";
  EXPECT_NE(vector, 5u) << "and only memory";
}

/// The smallest pages: one in the RAM between two in memory, and transfers over both edges.
TEST_F(TcmMappingTest, TinyPagesAndTransfersAcrossThem) {
  low_pages(m);
  m.port.set_word(kTables + 4 * (kVa >> 20), kFine | 0x13u);
  m.port.set_word(kFine + 0, kPa | 0x3Fu);
  m.port.set_word(kFine + 4, (kWindow + 0x6000 + 0x400) | 0x3Fu);
  m.port.set_word(kFine + 8, (kPa + 0x800) | 0x3Fu);
  m.execute(kStart +
            "mov r0, #1\n mov r1, #2\n mov r2, #3\n mov r3, #4\n add r7, r5, #0x3f8\n"
            "stmia r7, {r0-r3}\n add r8, r7, #0x400\n stmia r8, {r0-r3}\n"
            "ldmia r7, {r0-r3}\n add r9, r0, r1, lsl #8\n add r9, r9, r2, lsl #16\n"
            "add r9, r9, r3, lsl #24\n ldmia r8, {r0-r3}\n add r10, r0, r1, lsl #8\n"
            "add r10, r10, r2, lsl #16\n add r10, r10, r3, lsl #24\n"
            "1: mrc p15, 0, r15, c7, c10, 3\n bne 1b\n mov r0, r0\n"
            "mov r12, #0\n mcr p15, 0, r12, c7, c10, 4\n");
  EXPECT_TRUE(faults().empty());
  EXPECT_EQ(m.core.reg(9), 0x04030201u);
  EXPECT_EQ(m.core.reg(10), 0x04030201u);
  EXPECT_EQ(m.port.word(kPa + 0x3F8), 1u);
  EXPECT_EQ(m.port.word(kPa + 0x3FC), 2u);
  EXPECT_EQ(m.tcm_word(0x6400), 3u);
  EXPECT_EQ(m.tcm_word(0x6404), 4u);
  EXPECT_EQ(m.tcm_word(0x67F8), 1u);
  EXPECT_EQ(m.port.word(kPa + 0x800), 3u);
  EXPECT_EQ(m.port.word(kPa + 0x400), 0u) << "nothing of the page between goes to memory";
}

/// The last page of each window and the first behind it.
TEST_F(TcmMappingTest, WindowsEndAfterThirtyTwoKilobytes) {
  low_pages(m);
  coarse(m, kVa, kCoarse + 0x400);
  const std::uint32_t at[] = {0x7000, 0x8000, 0xF000, 0x1'0000, 0x1'7000, 0x1'8000};
  std::string text = kStart;
  for (unsigned k = 0; k < std::size(at); ++k) {
    page(m, kCoarse + 0x400, kVa + k * 0x1000, at[k]);
    text += " ldr r0, [r5]\n add r5, r5, #0x1000\n";
  }
  m.execute(text);
  const auto f = faults();  // behind a window nothing answers
  ASSERT_EQ(f.size(), 3u);
  EXPECT_EQ(f[0].far, kVa + 0x1000);
  EXPECT_EQ(f[1].far, kVa + 0x2000);
  EXPECT_EQ(f[2].far, kVa + 0x5000);
  for (const Taken& each : f) EXPECT_EQ(each.dfsr, 0xAu) << "external, page";
}

/// The modified address is the one that is translated (ARM DDI 0198D 2-34).
TEST_F(TcmMappingTest, ProcessNumberComesBeforeTheTranslation) {
  low_pages(m);
  m.section(0x0200'0000, kPa + 0x10'0000, 0, 0);
  m.port.set_word(kPa + 0x10'4000, 11);
  m.section(0x0400'0000, kPa, 0, 0);
  m.load(
      assemble("mcr p15, 0, r0, c13, c0, 0\n mov r0, r0\n mov r0, r0\n ldr r8, [r1]\n"
               "mov r0, #0\n mcr p15, 0, r0, c13, c0, 0\n mov r0, r0\n mov r0, r0\n"
               "ldr r9, [r1]\n mov pc, lr\n",
               kPa + 0x2000));
  m.tcm[0x4000] = 22;
  m.execute(kStart +
            "ldr r0, =0x02000000\n mov r1, #0x4000\n ldr r7, =0x04002000\n mov lr, pc\n"
            "mov pc, r7\n");
  EXPECT_TRUE(faults().empty());
  EXPECT_EQ(m.core.reg(8), 11u) << "0x4000 of process 1 is a page in memory";
  EXPECT_EQ(m.core.reg(9), 22u) << "0x4000 of process 0 is internal RAM";
}

/// The data TCM serves no fetches: they go to the bus, where the window does not exist for the
/// core.
TEST_F(TcmMappingTest, DataWindowCannotBeFetchedFrom) {
  m.load(assemble("mov r9, #9\n mov pc, r12\n", 0x4000));
  m.execute(kVectors +
            "ldr r4, =0x14000\n mov r9, #0\n adr r12, 1f\n ldr r8, [r4]\n mov pc, r4\n"
            "1: mov r10, r9\n mov r0, #0x4000\n adr r12, 2f\n mov pc, r0\n2:");
  const auto f = faults();
  ASSERT_EQ(f.size(), 1u);
  EXPECT_EQ(f[0].kind, 3u);
  EXPECT_EQ(f[0].lr, 0x1'4004u);
  EXPECT_EQ(f[0].ifsr & 0xDu, 0x8u) << "external";
  EXPECT_EQ(m.core.reg(8), 0xE3A09009u) << "as data it is there";
  EXPECT_EQ(m.core.reg(10), 0u);
  EXPECT_EQ(m.core.reg(9), 9u) << "the same RAM through the instruction window";
}

TEST_F(TcmMappingTest, MappedDataWindowCannotBeFetchedFromEither) {
  for (const unsigned cb : {0u, 2u}) {
    Machine each;
    low_pages(each);
    coarse(each, kVa, kCoarse + 0x400);
    page(each, kCoarse + 0x400, kVa, kWindow + 0x4000, cb);
    page(each, kCoarse + 0x400, kVa + 0x1000, 0x4000, cb);
    each.load(assemble("mov r9, #9\n mov pc, r12\n", 0x4000));
    each.execute(kStart +
                 "adr r12, 1f\n mov r9, #0\n mov pc, r5\n1: mov r10, r9\n adr r12, 2f\n"
                 "add r0, r5, #0x1000\n mov pc, r0\n2:");
    const auto f = taken(each);
    ASSERT_EQ(f.size(), 1u) << cb;
    EXPECT_EQ(f[0].lr, kVa + 4);
    EXPECT_EQ(f[0].ifsr & 0xFu, 0xAu) << "external, page";
    EXPECT_EQ(each.core.reg(10), 0u);
    EXPECT_EQ(each.core.reg(9), 9u);
  }
}

/// A conflict between code and data is one of banks, that is of physical addresses.
TEST_F(TcmMappingTest, ConflictsAreThoseOfThePhysicalBanks) {
  const auto clocks = [](std::uint32_t code, std::uint32_t data) {
    Machine each(Machine::Settings{{"cpu.tcm.own_conflict", "1cycles"}});
    low_pages(each);
    coarse(each, kVa, kCoarse + 0x400);
    page(each, kCoarse + 0x400, kVa, code);
    page(each, kCoarse + 0x400, kVa + 0x1000, data);
    each.load(assemble("svc #1\n ldr r0, [r7]\n ldr r0, [r7]\n svc #1\n mov pc, r12\n", code));
    each.execute(kStart + "add r7, r5, #0x1000\n ldr r0, [r7]\n adr r12, 1f\n mov pc, r5\n1:");
    return each.between();
  };
  EXPECT_EQ(clocks(0x4000, 0x1'5000), 4u) << "one bank";
  EXPECT_EQ(clocks(0x4000, 0x1'6000), 4u);
  EXPECT_EQ(clocks(0x4000, 0x1'2000), 2u) << "two banks";
  EXPECT_EQ(clocks(0x2000, 0x1'3000), 4u);
}

}  // namespace
}  // namespace fovea::cpu::test::tcm_mapping
