// System behaviour for which QEMU is not an oracle, with expectations from the architecture manual.
#include "tb/iss/vectors.h"

namespace fovea::cpu::test::by_hand {
namespace {

constexpr std::uint32_t kCoarse = kTables + 0x8000, kOther = kTables + 0x1'0000;
constexpr std::uint32_t kVa = 0x0800'0000, kPa = 0x0030'0000;
const std::string kStart = kVectors + kCachesOn + " ldr r4, =0x08000000\n ldr r5, =0x01010000\n";
static_assert(kOther == 0x0101'0000);

class ByHandTest : public testing::Test {
 protected:
  Machine m;
  void go(const std::string& text) { m.execute(kStart + text); }
  std::vector<Taken> faults() const { return taken(m); }
  /// A second set of tables, equal but for kVa, which it maps a megabyte further.
  void second_tables() {
    m.section(kVa, kPa, 0, 0);
    for (unsigned s = 0; s < 4096; ++s)
      m.port.set_word(kOther + 4 * s, m.port.word(kTables + 4 * s));
    m.port.set_word(kOther + 4 * (kVa >> 20), (kPa + 0x100000) | 0xC12u);
    m.port.set_word(kPa, 1);
    m.port.set_word(kPa + 0x100000, 2);
  }
};

/// QEMU's TLB holds another number of entries, so what is stale there says nothing.
TEST_F(ByHandTest, TableBaseChangeLeavesKnownEntriesAsTheyAre) {
  second_tables();
  go("ldr r0, [r4]\n mcr p15, 0, r5, c2, c0, 0\n ldr r1, [r4]\n mov r3, #0\n"
     "mcr p15, 0, r3, c8, c7, 0\n ldr r2, [r4]\n mrc p15, 0, r6, c2, c0, 0\n");
  EXPECT_EQ(m.core.reg(0), 1u);
  EXPECT_EQ(m.core.reg(1), 1u) << "from the TLB";
  EXPECT_EQ(m.core.reg(2), 2u) << "from the new tables";
  EXPECT_EQ(m.core.reg(6), kOther);
}

TEST_F(ByHandTest, TableBaseChangeHoldsForUnknownPagesAtOnce) {
  second_tables();
  go("mcr p15, 0, r5, c2, c0, 0\n ldr r1, [r4]\n");
  EXPECT_EQ(m.core.reg(1), 2u);
}

TEST_F(ByHandTest, MmuOffAndOnKeepsTheTlb) {
  m.section(kVa, kPa, 0, 0);
  m.port.set_word(kPa, 1);
  m.port.set_word(kPa + 0x100000, 2);
  m.on_svc = [this](std::uint32_t) { m.section(kVa, kPa + 0x100000, 0, 0); };
  go("ldr r0, [r4]\n mrc p15, 0, r6, c1, c0, 0\n bic r7, r6, #1\n mcr p15, 0, r7, c1, c0, 0\n"
     "svc #3\n mcr p15, 0, r6, c1, c0, 0\n ldr r1, [r4]\n mcr p15, 0, r4, c8, c7, 1\n"
     "ldr r2, [r4]\n");
  EXPECT_EQ(m.core.reg(0), 1u);
  EXPECT_EQ(m.core.reg(1), 1u);
  EXPECT_EQ(m.core.reg(2), 2u);
}

/// Two transactions on one AHB port would break its contract, which the flat port checks.
TEST_F(ByHandTest, UncachedFetchWaitsForTheFillThatStillStreams) {
  m.section(kVa, kPa, 0, 0);
  m.load(assemble("mov pc, r4\n", 0x200000));
  m.load(assemble("mov r9, #9\n mov pc, lr\n", kPa));
  go("ldr r0, =0x00200000\n blx r0\n mov r1, #0\n mcr p15, 0, r1, c7, c5, 0\n blx r0\n");
  EXPECT_EQ(m.core.reg(9), 9u);
}

/// ARM DDI 0198D 2-34: without the MMU addresses are not modified.
TEST_F(ByHandTest, ProcessMovesNothingWhileTheMmuIsOff) {
  m.port.set_word(0x0040'0000, 7);
  m.execute("ldr r4, =0x00400000\n ldr r0, =0x08000000\n mcr p15, 0, r0, c13, c0, 0\n"
            "ldr r1, [r4]\n mov r0, #0\n mcr p15, 0, r0, c13, c0, 0\n");
  EXPECT_EQ(m.core.reg(1), 7u);
}

/// ARM ARM, sequence for checking faults: both descriptors are read before the domain is checked.
TEST_F(ByHandTest, NoPageGoesBeforeNoAccess) {
  m.port.set_word(kTables + 4 * (kVa >> 20), kCoarse | 6u << 5 | 0x11u);
  m.port.set_word(kCoarse, 0);
  go("mov r0, #1\n mcr p15, 0, r0, c3, c0, 0\n ldr r0, [r4]\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 1u);
  EXPECT_EQ(f[0].dfsr, 0x67u);
}

TEST_F(ByHandTest, FaultAddressIsTheModifiedOne) {
  // Code above 32 MB is not moved: it runs from there, under process 4. The handlers are found
  // where the process has them: internal RAM lies at the modified address, so they get a section.
  m.section(0x0a00'0000, 0x0020'0000, 1, 0);
  m.section(0x0800'0000, 0x0010'0000, 0, 0);
  m.port.set_word(kTables + 4 * (0x0810'0000u >> 20), 0);
  // The data abort vector of process 4 puts what it sees into registers and leaves the process.
  const Program vector = assemble(
      ".space 0x10\n mrc p15, 0, r7, c6, c0, 0\n mrc p15, 0, r8, c5, c0, 0\n mov r9, #9\n"
      "mcr p15, 0, r6, c13, c0, 0\n mov pc, r10\n",
      0x0010'0000);
  m.load(vector);
  const Program there = assemble(
      "mov r6, #0\n ldr r10, =0x0a000040\n ldr r1, =0x00100008\n ldr r0, =0x08000000\n"
      "mcr p15, 0, r0, c13, c0, 0\n ldrb r2, [r1, #3]\n b .\n .ltorg\n"
      ".org 0x40\n mov pc, r11\n",
      0x0020'0000);
  m.load(there);
  go("ldr r0, =0x0a000000\n adr r11, 1f\n mov pc, r0\n1:\n");
  EXPECT_EQ(m.core.reg(7), 0x0810'000Bu);
  EXPECT_EQ(m.core.reg(8) & 15u, 5u);
  EXPECT_EQ(m.core.reg(9), 9u);
}

/// ARM DDI 0198, FCSE PID register: operations by address take the address as the modified one.
TEST_F(ByHandTest, CacheOperationsByAddressAreNotMoved) {
  m.section(0x0a00'0000, 0x0020'0000, 1, 0);
  m.section(0x0800'0000, 0x0010'0000, 1, 1);
  m.port.set_word(0x0040'0000, 1);
  m.port.set_word(0x0040'0020, 1);
  // Dirty lines of process 0, cleaned (r1) or thrown away (r2) while process 4 is on.
  m.load(
      assemble("ldr r0, =0x08000000\n mov r6, #0\n mcr p15, 0, r0, c13, c0, 0\n"
               "mcr p15, 0, r1, c7, c10, 1\n mcr p15, 0, r2, c7, c6, 1\n"
               "mcr p15, 0, r6, c7, c10, 4\n mcr p15, 0, r6, c13, c0, 0\n mov pc, lr\n .ltorg\n",
               0x0020'0000));
  go("ldr r1, =0x00400000\n add r2, r1, #32\n ldr r0, [r1]\n ldr r0, [r2]\n mov r0, #2\n"
     "str r0, [r1]\n str r0, [r2]\n ldr r0, =0x0a000000\n blx r0\n ldr r7, [r2]\n");
  EXPECT_TRUE(faults().empty());
  EXPECT_EQ(m.port.word(0x0040'0000), 2u) << "cleaned";
  EXPECT_EQ(m.core.reg(7), 1u) << "invalidated, read again";
}

/// L4, bit 15 of the control register: loads of the pc do as in ARMv4, bit 0 changes no state.
/// QEMU keeps the bit without effect.
TEST_F(ByHandTest, LoadsOfThePcKeepTheStateUnderL4) {
  go("ldr r6, =0x4800\n mov r7, #0\n mov r9, #0\n mrc p15, 0, r0, c1, c0, 0\n"
     "orr r0, r0, #0x8000\n mcr p15, 0, r0, c1, c0, 0\n"
     "adr r1, 1f\n orr r1, r1, #1\n str r1, [r6]\n ldr pc, [r6]\n mov r9, #1\n"
     "1: orr r7, r7, #1\n adr r1, 2f\n orr r1, r1, #1\n str r1, [r6, #4]\n mov r2, r6\n"
     "ldmia r2!, {r3, pc}\n mov r9, #2\n"
     "2: orr r7, r7, #2\n mov sp, r6\n adr r1, 3f\n str r1, [r6]\n adr r0, 4f + 1\n bx r0\n"
     ".thumb\n 4: pop {pc}\n .balign 4\n"
     "3: movs r5, #7\n mov r10, r5\n .balign 4\n bx pc\n nop\n .arm\n");
  EXPECT_TRUE(faults().empty());
  EXPECT_EQ(m.core.reg(9), 0u);
  EXPECT_EQ(m.core.reg(7), 3u) << "LDR and LDM stayed in ARM state";
  EXPECT_EQ(m.core.reg(10), 7u) << "POP stayed in Thumb state at an even address";
}

/// The second half of BLX has bit 0 clear; QEMU takes it as a branch all the same.
TEST_F(ByHandTest, OddSecondHalfOfBlxIsUndefined) {
  go("adr r0, 1f + 1\n bx r0\n .thumb\n1:\n .inst.n 0xe801\n .balign 4\n bx pc\n nop\n .arm\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 1u);
  EXPECT_EQ(f[0].kind, 1u);
  EXPECT_EQ(f[0].spsr & 0x20u, 0x20u);
}

/// ARM DDI 0198E 2.3: registers that can be written hold their value, each its own. Bits that should be zero are.
TEST_F(ByHandTest, EachRegisterOfTheCoprocessorHoldsItsOwnValue) {
  struct {
    const char* name;
    std::uint32_t value;
  } const registers[] = {
      {"c2, c0, 0", 0x0104'0000}, {"c3, c0, 0", 0x5566'7789}, {"c5, c0, 0", 0x35},
      {"c5, c0, 1", 0x47},        {"c6, c0, 0", 0x0BAD'F00D}, {"c9, c0, 0", 0x5},
      {"c9, c0, 1", 0xA},         {"c10, c0, 0", 0x1400'0001}, {"c13, c0, 0", 0x0600'0000},
      {"c13, c0, 1", 0xC0DE'1234}};
  std::string write, read = "ldr r12, =0x00200000\n";
  for (const auto& r : registers) {
    write += "ldr r0, =" + std::to_string(r.value) + "\n mcr p15, 0, r0, " + r.name + "\n";
    read += std::string("mrc p15, 0, r0, ") + r.name + "\n str r0, [r12], #4\n";
  }
  m.execute(write + read);
  std::uint32_t at = 0x20'0000;
  for (const auto& r : registers) {
    EXPECT_EQ(m.port.word(at), r.value) << r.name;
    at += 4;
  }
}

}  // namespace
}  // namespace fovea::cpu::test::by_hand
