// Translation, permissions and aborts.
#include "tb/iss/vectors.h"

namespace fovea::cpu::test {
namespace {

constexpr std::uint32_t kCoarse = kTables + 0x8000, kFine = kTables + 0xA000;
constexpr std::uint32_t kVa = 0x0800'0000, kPa = 0x0030'0000;
const std::string kStart = kVectors + kCachesOn + " ldr r4, =0x08000000\n ldr r5, =0x00300000\n";

class MmuTest : public testing::Test {
 protected:
  Machine m;
  /// Runs `text` with r4 = kVa, r5 = kPa.
  void go(const std::string& text) { m.execute(kStart + text); }
  std::vector<Taken> faults() const { return taken(m); }
  void coarse(unsigned domain = 0) {
    m.port.set_word(kTables + 4 * (kVa >> 20), kCoarse | domain << 5 | 0x11u);
  }
};

TEST_F(MmuTest, Section) {
  m.section(kVa, kPa, 0, 0);
  m.port.set_word(kPa + 0x12344, 0xABCD);
  go("ldr r0, =0x08012344\n ldr r0, [r0]");
  EXPECT_EQ(m.core.reg(0), 0xABCDu);
}

TEST_F(MmuTest, LargePage) {
  coarse();
  for (unsigned k = 0; k < 16; ++k)
    m.port.set_word(kCoarse + 4 * (0x10 + k), (kPa + 0x20000) | 0xFF1u);
  m.port.set_word(kPa + 0x2F004, 77);
  go("ldr r0, =0x0801f004\n ldr r0, [r0]");
  EXPECT_EQ(m.core.reg(0), 77u);
}

TEST_F(MmuTest, SmallPage) {
  coarse();
  m.port.set_word(kCoarse + 4 * 3, (kPa + 0x5000) | 0xFF2u);
  m.port.set_word(kPa + 0x5FFC, 78);
  go("ldr r0, =0x08003ffc\n ldr r0, [r0]");
  EXPECT_EQ(m.core.reg(0), 78u);
}

TEST_F(MmuTest, TinyPage) {
  m.port.set_word(kTables + 4 * (kVa >> 20), kFine | 0x13u);
  m.port.set_word(kFine + 4 * 5, (kPa + 0x400) | 0x33u);
  m.port.set_word(kPa + 0x404, 79);
  go("ldr r0, =0x08001404\n ldr r0, [r0]");
  EXPECT_EQ(m.core.reg(0), 79u);
}

TEST_F(MmuTest, SmallPageHasFourPermissions) {
  coarse();
  // Quarters: AP 3, 2, 1, 0 from the lowest; user mode reads each and writes the first two.
  m.port.set_word(kCoarse, (kPa + 0x5000) | 0u << 10 | 1u << 8 | 2u << 6 | 3u << 4 | 2u);
  go("ldr r0, =0x55555555\n mcr p15, 0, r0, c3, c0, 0\n msr cpsr_c, #0x10\n ldr r0, [r4]\n str r0, "
     "[r4]\n ldr r0, [r4, #0x400]\n str r0, [r4, #0x400]\n"
     "add r4, r4, #0x800\n ldr r0, [r4]\n ldr r0, [r4, #0x400]\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 3u);
  EXPECT_EQ(f[0].far, kVa + 0x400);
  EXPECT_EQ(f[1].far, kVa + 0x800);
  EXPECT_EQ(f[2].far, kVa + 0xC00);
  for (const auto& each : f) EXPECT_EQ(each.dfsr, 0xFu) << "permission, page";
}

/// AP, S and R bits: who may do what (ARM ARM table B4-1; S and R together are reserved there and permit
/// nothing here). Bits: privileged read, write, user read,
/// write.
TEST_F(MmuTest, PermissionTable) {
  struct Row {
    unsigned ap, s, r, allowed;
  };
  for (const Row& row : {Row{0, 0, 0, 0b0000}, Row{0, 1, 0, 0b1000}, Row{0, 0, 1, 0b1010},
                         Row{0, 1, 1, 0b0000}, Row{1, 0, 0, 0b1100}, Row{2, 0, 0, 0b1110},
                         Row{3, 0, 0, 0b1111}}) {
    Machine each;
    each.section(kVa, kPa, 0, 0, row.ap, 3);
    each.execute(kStart + "mrc p15, 0, r0, c1, c0, 0\n orr r0, r0, #" +
                 std::to_string(row.s << 8 | row.r << 9) +
                 "\n mcr p15, 0, r0, c1, c0, 0\n ldr r0, =0x55555555\n mcr p15, 0, r0, c3, c0, 0\n"
                 "ldr r1, [r4]\n str r1, [r4, #4]\n msr cpsr_c, #0x10\n ldr r1, [r4, #8]\n str r1, "
                 "[r4, #12]\n");
    unsigned refused = 0;
    for (const auto& f : taken(each)) {
      EXPECT_EQ(f.dfsr, 0x3Du) << "permission, section, domain 3";
      refused |= 8u >> ((f.far - kVa) / 4);
    }
    EXPECT_EQ(refused, 15u & ~row.allowed) << "AP " << row.ap << " S " << row.s << " R " << row.r;
  }
}

/// A third page of one set replaces the first, and what was remembered of it goes with it.
TEST_F(MmuTest, ReplacedEntryIsWalkedForAgain) {
  coarse();
  for (const unsigned page : {5u, 5u + 32, 5u + 64})
    m.port.set_word(kCoarse + 4 * page, (kPa + page * 0x1000) | 0xFF2u);
  std::vector<std::uint64_t> walks;
  m.on_svc = [&](std::uint32_t) { walks.push_back(m.core.counts().tlb_walks); };
  go("add r4, r4, #0x5000\n add r6, r4, #0x20000\n add r7, r4, #0x40000\n svc #3\n"
     "ldr r0, [r6]\n ldr r0, [r4]\n svc #3\n ldr r0, [r6]\n ldr r0, [r4]\n svc #3\n"
     "ldr r0, [r7]\n svc #3\n ldr r0, [r6]\n svc #3\n");
  ASSERT_EQ(walks.size(), 5u);
  EXPECT_EQ(walks[1] - walks[0], 2u);
  EXPECT_EQ(walks[2] - walks[1], 0u) << "two ways";
  EXPECT_EQ(walks[3] - walks[2], 1u);
  EXPECT_EQ(walks[4] - walks[3], 1u) << "the page that came first has lost its entry";
}

TEST_F(MmuTest, DomainFaults) {
  m.section(kVa, kPa, 0, 0, 3, 5);
  m.port.set_word(kTables + 4 * (kVa >> 20) + 4, kCoarse | 6u << 5 | 0x11u);
  m.port.set_word(kCoarse, kPa | 0xFF2u);
  go("ldr r0, =0x00000001\n mcr p15, 0, r0, c3, c0, 0\n ldr r0, [r4]\n add r4, r4, #0x100000\n ldr "
     "r0, [r4]");
  const auto f = faults();
  ASSERT_EQ(f.size(), 2u);
  EXPECT_EQ(f[0].dfsr, 0x59u);
  EXPECT_EQ(f[1].dfsr, 0x6Bu);
}

TEST_F(MmuTest, ManagerSkipsPermissions) {
  m.section(kVa, kPa, 0, 0, 0, 5);
  go("ldr r0, [r4]");
  EXPECT_TRUE(faults().empty());
}

TEST_F(MmuTest, TranslationFaultsAndTheReturn) {
  m.port.set_word(kTables + 4 * (kVa >> 20), 0);
  m.port.set_word(kTables + 4 * (kVa >> 20) + 4, kCoarse | 0x51u);
  m.port.set_word(kCoarse, 0);
  go("mov r0, #1\n1: ldr r0, [r4, #8]\n add r6, r4, #0x100000\n str r0, [r6]\n adr r7, 1b\n mov "
     "r8, #3");
  const auto f = faults();
  ASSERT_EQ(f.size(), 2u);
  EXPECT_EQ(f[0].kind, 4u);
  EXPECT_EQ(f[0].dfsr & 0xFu, 0x5u);
  EXPECT_EQ(f[0].far, kVa + 8);
  EXPECT_EQ(f[0].lr, m.core.reg(7) + 8);
  EXPECT_EQ(f[0].spsr & 0x1Fu, 0x13u);
  EXPECT_EQ(f[0].cpsr & 0xBFu, 0x97u) << "abort mode, IRQ off, ARM";
  EXPECT_EQ(f[1].dfsr, 0x27u) << "page, domain 2";
  EXPECT_EQ(f[1].far, kVa + 0x100000);
  EXPECT_EQ(m.core.reg(0), 1u) << "the destination keeps its value";
  EXPECT_EQ(m.core.reg(8), 3u);
}

TEST_F(MmuTest, BaseIsRestored) {
  m.port.set_word(kTables + 4 * (kVa >> 20), 0);
  m.section(kVa - 0x100000, kPa, 0, 0);
  go("mov r0, #1\n mov r1, #2\n ldr r6, [r4], #4\n ldr r6, [r4, #8]!\n str r0, [r4], #4\n strh r0, "
     "[r4, #2]!\n"
     "ldmia r4!, {r0, r1}\n stmia r4!, {r0, r1}\n ldrd r0, r1, [r4], #8\n"
     "sub r7, r4, #8\n ldmia r7!, {r0, r1, r2, r3}\n sub r8, r4, r7\n");
  EXPECT_EQ(faults().size(), 8u);
  EXPECT_EQ(m.core.reg(4), kVa);
  EXPECT_EQ(m.core.reg(8), 8u) << "an LDM that aborts at its third word";
}

TEST_F(MmuTest, TlbIsStaleUntilInvalidated) {
  m.section(kVa, kPa, 0, 0);
  m.port.set_word(kPa, 1);
  m.port.set_word(kPa + 0x100000, 2);
  m.on_svc = [this](std::uint32_t) { m.section(kVa, kPa + 0x100000, 0, 0); };
  go("ldr r0, [r4]\n svc #3\n ldr r1, [r4]\n mcr p15, 0, r4, c8, c7, 1\n ldr r2, [r4]");
  EXPECT_EQ(m.core.reg(0), 1u);
  EXPECT_EQ(m.core.reg(1), 1u);
  EXPECT_EQ(m.core.reg(2), 2u);
}

TEST_F(MmuTest, InvalidateAllOfTheTlb) {
  m.section(kVa, kPa, 0, 0);
  m.port.set_word(kPa + 0x100000, 2);
  m.on_svc = [this](std::uint32_t) { m.section(kVa, kPa + 0x100000, 0, 0); };
  go("ldr r0, [r4]\n svc #3\n mov r0, #0\n mcr p15, 0, r0, c8, c7, 0\n ldr r2, [r4]");
  EXPECT_EQ(m.core.reg(2), 2u);
}

TEST_F(MmuTest, LockedTlbEntrySurvivesInvalidateAll) {
  m.section(kVa, kPa, 0, 0);
  m.port.set_word(kPa, 1);
  m.port.set_word(kPa + 0x100000, 2);
  m.on_svc = [this](std::uint32_t) { m.section(kVa, kPa + 0x100000, 0, 0); };
  go("mov r0, #1\n mcr p15, 0, r0, c10, c0, 0\n ldr r0, [r4]\n mov r0, #0\n mcr p15, 0, r0, c10, "
     "c0, 0\n svc #3\n"
     "mcr p15, 0, r0, c8, c7, 0\n ldr r1, [r4]\n mcr p15, 0, r4, c8, c7, 1\n ldr r2, [r4]");
  EXPECT_EQ(m.core.reg(1), 1u);
  EXPECT_EQ(m.core.reg(2), 2u) << "by address it goes";
}

TEST_F(MmuTest, WalkIsOneReadForASectionAndTwoForAPage) {
  m.section(kVa, kPa, 0, 0);
  // The page goes to another set of the TLB than the sections of code and first access.
  m.port.set_word(kTables + 4 * (kVa >> 20) + 4, kCoarse | 0x11u);
  m.port.set_word(kCoarse + 8, kPa | 0xFF2u);
  m.on_svc = [this](std::uint32_t) { m.marks.push_back(m.port.data_log().size()); };
  go("svc #3\n ldr r0, [r4]\n svc #3\n add r6, r4, #0x100000\n add r6, r6, #0x2000\n"
     "ldr r0, [r6]\n svc #3\n ldr r0, [r6]\n svc #3\n");
  ASSERT_EQ(m.marks.size(), 4u);
  EXPECT_EQ(m.marks[1] - m.marks[0], 2u);
  EXPECT_EQ(m.marks[2] - m.marks[1], 3u);
  EXPECT_EQ(m.marks[3] - m.marks[2], 1u);
  const auto log = m.port.data_log();
  EXPECT_EQ(log[m.marks[0]].address, kTables + 4 * (kVa >> 20));
  EXPECT_EQ(log[m.marks[1] + 1].address, kCoarse + 8);
  EXPECT_EQ(log[m.marks[1]].kind, BusAccess::Kind::kSingle);
}

/// FCSE: addresses below 32 MB move by the process number.
TEST_F(MmuTest, FastContextSwitchMovesLowAddresses) {
  m.section(0x0810'0000, kPa, 0, 0);
  m.section(0x0800'0000, 0, 0,
            0);  // the code itself: internal RAM is found by the modified address
  m.port.set_word(kPa + 8, 0x99);
  // Code above 32 MB is not moved: it runs from there.
  m.section(0x0a00'0000, 0x0020'0000, 1, 0);
  const Program there = assemble(
      "ldr r1, =0x00100008\n ldr r0, =0x08000000\n mcr p15, 0, r0, c13, c0, 0\n"
      "ldr r2, [r1]\n mov r0, #0\n mcr p15, 0, r0, c13, c0, 0\n mov pc, lr\n .ltorg\n",
      0x0020'0000);
  m.load(there);
  go("ldr r0, =0x0a000000\n blx r0\n");
  EXPECT_EQ(m.core.reg(2), 0x99u);
  EXPECT_TRUE(faults().empty());
}

/// The last word below 32 MB moves, the first one above does not.
TEST_F(MmuTest, FastContextSwitchEndsAt32Megabytes) {
  m.section(0x09f0'0000, kPa, 0, 0);
  m.section(0x0200'0000, kPa + 0x10'0000, 0, 0);
  m.section(0x0800'0000, 0, 0, 0);
  m.section(0x0a00'0000, 0x0020'0000, 1, 0);
  m.port.set_word(kPa + 0xF'FFFC, 0x11);
  m.port.set_word(kPa + 0x10'0000, 0x22);
  m.load(assemble("ldr r1, =0x01fffffc\n ldr r6, =0x02000000\n ldr r0, =0x08000000\n mcr p15, 0, r0, c13, c0, 0\n"
                  "ldr r2, [r1]\n ldr r3, [r6]\n mov r0, #0\n mcr p15, 0, r0, c13, c0, 0\n mov pc, lr\n .ltorg\n",
                  0x0020'0000));
  go("ldr r0, =0x0a000000\n blx r0\n");
  EXPECT_EQ(m.core.reg(2), 0x11u);
  EXPECT_EQ(m.core.reg(3), 0x22u);
  EXPECT_TRUE(faults().empty());
}

TEST_F(MmuTest, AlignmentFaults) {
  m.section(kVa, kPa, 0, 0);
  go("mrc p15, 0, r0, c1, c0, 0\n orr r0, r0, #2\n mcr p15, 0, r0, c1, c0, 0\n ldr r0, [r4, #1]\n"
     "ldrh r0, [r4, #3]\n str r0, [r4, #2]\n strh r0, [r4, #5]\n ldrb r0, [r4, #7]\n add r6, r4, "
     "#2\n"
     "ldmia r6, {r0, r1}\n stmia r6, {r0, r1}\n ldrd r0, r1, [r6]\n strd r0, r1, [r6]\n ldr r0, "
     "[r4, #4]\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 8u);
  const std::uint32_t far[] = {1, 3, 2, 5, 2, 2, 2, 2};
  for (unsigned k = 0; k < 8; ++k) {
    EXPECT_EQ(f[k].dfsr & 0xFu, 0x1u);
    EXPECT_EQ(f[k].far, kVa + far[k]);
  }
}

TEST_F(MmuTest, ExternalAborts) {
  m.section(kVa, 0x7000'0000, 0, 0);                             // nothing there: uncached
  m.section(kVa + 0x100000, 0x7000'0000, 1, 1);                  // write-back
  m.port.set_word(kTables + 4 * (kVa >> 20) + 8, 0x7000'0011u);  // its page table is nowhere
  go("mov r0, #1\n ldr r0, [r4]\n str r0, [r4, #4]\n add r6, r4, #0x200000\n ldr r0, [r6]\n"
     "add r6, r4, #0x100000\n str r0, [r6]\n mov r12, #0\n mcr p15, 0, r12, c7, c10, 4\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 3u) << "a buffered write cannot abort";
  EXPECT_EQ(f[0].dfsr, 0x8u);
  EXPECT_EQ(f[1].dfsr, 0x8u);
  EXPECT_EQ(f[1].far, kVa + 4);
  EXPECT_EQ(f[2].dfsr, 0xEu) << "on the second walk read";
  EXPECT_EQ(m.core.reg(0), 1u);
}

TEST_F(MmuTest, ExternalAbortOnTheFirstWalkRead) {
  go("ldr r0, =0x70000000\n mcr p15, 0, r0, c2, c0, 0\n ldr r0, [r4]\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 1u);
  EXPECT_EQ(f[0].dfsr & 0xFu, 0xCu);
}

TEST_F(MmuTest, PrefetchAborts) {
  m.port.set_word(kTables + 4 * (kVa >> 20), 0);
  m.section(kVa + 0x100000, kPa, 0, 0, 1, 0);
  go("adr r12, 1f\n mov pc, r4\n1: adr r12, 2f\n ldr r0, =0x55555555\n mcr p15, 0, r0, c3, c0, 0\n"
     "add r6, r4, #0x100000\n msr cpsr_c, #0x10\n mov pc, r6\n2: adr r12, 3f\n bkpt #7\n3: mov r9, "
     "#9");
  const auto f = faults();
  ASSERT_EQ(f.size(), 3u);
  EXPECT_EQ(f[0].kind, 3u);
  EXPECT_EQ(f[0].ifsr & 0xFu, 0x5u);
  EXPECT_EQ(f[0].lr, kVa + 4);
  EXPECT_EQ(f[1].ifsr & 0xFu, 0xDu);
  EXPECT_EQ(f[1].spsr & 0x1Fu, 0x10u);
  EXPECT_EQ(f[2].kind, 3u);
  EXPECT_EQ(m.core.reg(9), 9u);
}

TEST_F(MmuTest, PrefetchAbortHappensOnlyIfExecuted) {
  // The next page of the code is not mapped, but the branch leaves before.
  coarse();
  m.port.set_word(kCoarse, kPa | 0xFFEu);
  m.port.set_word(kPa + 0xFFC, 0xE12FFF1Eu);  // bx lr, last word of the page
  m.port.set_word(kCoarse + 4, 0);
  go("ldr r0, =0x08000ffc\n blx r0\n mov r9, #9");
  EXPECT_TRUE(faults().empty());
  EXPECT_EQ(m.core.reg(9), 9u);
}

TEST_F(MmuTest, FetchFromNowhereIsAGuestFailure) {
  EXPECT_THROW(m.execute("ldr r0, =0x70000000\n mrc p15, 0, r1, c1, c0, 0\n orr r1, r1, #0x2000\n"
                         "mcr p15, 0, r1, c1, c0, 0\n mov pc, r0\n"),
               GuestFailure);
  EXPECT_EQ(m.core.current_pc(), 0x7000'0000u);
}

}  // namespace
}  // namespace fovea::cpu::test
