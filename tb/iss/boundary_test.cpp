// Internal RAM under the MMU, aborts within accesses of several words, and instructions fetched
// before a register changes: ARM DDI 0198D chapters 2 and 3, with expectations worked out by hand.
#include "tb/iss/vectors.h"

namespace fovea::cpu::test::boundary {
namespace {

constexpr std::uint32_t kCoarse = kTables + 0x8000;
constexpr std::uint32_t kVa = 0x0800'0000, kPa = 0x0030'0000, kNowhere = 0x7000'0000;

class BoundaryTest : public testing::Test {
 protected:
  Machine m;
  /// Small page of VA `va` (table at `table`): memory at `pa` with these permissions, uncached.
  void page(std::uint32_t table, std::uint32_t va, std::uint32_t pa, unsigned ap = 3) {
    m.port.set_word(table + 4 * (va >> 12 & 0xFFu), (pa & ~0xFFFu) | ap * 0x550u | 2u);
  }
  void coarse(std::uint32_t va, std::uint32_t table, unsigned domain = 0) {
    m.port.set_word(kTables + 4 * (va >> 20), table | domain << 5 | 0x11u);
  }
  std::vector<Taken> faults() const { return taken(m); }
  /// Domain 1 (client) holds both windows of internal RAM, each page with full access.
  void internal_ram_by_pages() {
    coarse(0, kCoarse, 1);
    for (std::uint32_t a = 0; a < 0x8000; a += 0x1000) {
      page(kCoarse, a, a);
      page(kCoarse, 0x10000 + a, 0x10000 + a);
    }
  }
};

/// Dacr with domain 0 as manager and domain 1 as client.
const std::string kClients =
    kVectors + kCachesOn + " ldr r0, =0x00000007\n mcr p15, 0, r0, c3, c0, 0\n ldr r4, =0x10000\n";

TEST_F(BoundaryTest, InternalRamHasPermissions) {
  internal_ram_by_pages();
  page(kCoarse, 0x12000, 0x12000, 0);  // no access
  page(kCoarse, 0x14000, 0x14000, 1);  // not the user
  page(kCoarse, 0x15000, 0x15000, 2);  // the user reads
  m.port.set_word(kCoarse + 4 * 0x16, 0);
  for (const std::uint32_t a : {0x2000u, 0x4000u, 0x6000u}) std::memset(m.tcm.data() + a, 0x5A, 8);
  m.execute(kClients +
            "mov r1, #1\n add r5, r4, #0x2000\n add r6, r4, #0x4000\n add r7, r4, #0x5000\n"
            "add r8, r4, #0x6000\n add r9, r4, #0x7000\n"
            "ldr r0, [r5]\n str r1, [r5, #4]\n ldr r0, [r8]\n"
            "ldrt r0, [r6], #0\n swp r0, r1, [r5]\n stmia r5, {r1, r2}\n"
            "msr cpsr_c, #0x10\n"
            "ldr r0, [r6, #8]\n ldr r0, [r7]\n str r1, [r7, #12]\n str r1, [r9]\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 8u);
  const std::pair<std::uint32_t, std::uint32_t> seen[] = {
      {0x12000, 0x1F}, {0x12004, 0x1F}, {0x16000, 0x17}, {0x14000, 0x1F},
      {0x12000, 0x1F}, {0x12000, 0x1F}, {0x14008, 0x1F}, {0x1500C, 0x1F}};
  for (unsigned k = 0; k < 8; ++k) {
    EXPECT_EQ(f[k].far, seen[k].first) << k;
    EXPECT_EQ(f[k].dfsr, seen[k].second) << k << ": permission or translation, page, domain 1";
  }
  EXPECT_EQ(m.tcm_word(0x2000), 0x5A5A5A5Au) << "refused writes change nothing";
  EXPECT_EQ(m.tcm_word(0x7000), 1u);
}

TEST_F(BoundaryTest, InternalRamHasADomain) {
  internal_ram_by_pages();
  // The program runs from memory: internal RAM is data alone, until the handlers need it again.
  const Program there = assemble(
      "mrc p15, 0, r0, c3, c0, 0\n ldr r2, [r4]\n mov r1, #3\n mcr p15, 0, r1, c3, c0, 0\n"
      "ldr r3, [r4]\n mcr p15, 0, r0, c3, c0, 0\n mov pc, lr\n",
      kPa);
  m.load(there);
  // The vector of a data abort in domain 1 is in domain 1: it faults as well, for ever.
  EXPECT_THROW(m.execute(kClients + " ldr r8, =0x00300000\n blx r8\n"), GuestFailure);
  EXPECT_EQ(m.core.current_pc(), kPa + 16) << "the load behind the change, not the one before";
}

TEST_F(BoundaryTest, FetchesFromInternalRamAreChecked) {
  internal_ram_by_pages();
  m.port.set_word(kCoarse + 4 * 7, 0);
  page(kCoarse, 0x6000, 0x6000, 1);
  m.execute(kClients +
            "adr r12, 1f\n mov r0, #0x7000\n mov pc, r0\n"
            "1: adr r12, 2f\n mov r0, #0x6000\n msr cpsr_c, #0x10\n mov pc, r0\n 2: mov r9, #9\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 2u);
  EXPECT_EQ(f[0].kind, 3u);
  EXPECT_EQ(f[0].ifsr & 0xFu, 0x7u);
  EXPECT_EQ(f[0].lr, 0x7004u);
  EXPECT_EQ(f[1].ifsr & 0xFu, 0xFu);
  EXPECT_EQ(f[1].spsr & 0x1Fu, 0x10u);
  EXPECT_EQ(m.core.reg(9), 9u);
}

/// An access that a hint knows is one that the TLB knows and permits.
TEST_F(BoundaryTest, RevokedPermissionHoldsForKnownInternalRam) {
  internal_ram_by_pages();
  m.on_svc = [this](std::uint32_t) { m.port.set_word(kCoarse + 4 * 0x13, 0); };
  m.execute(kClients +
            "add r5, r4, #0x3000\n ldr r1, [r5]\n str r1, [r5]\n ldr r1, [r5]\n svc #3\n"
            "ldr r1, [r5]\n mcr p15, 0, r5, c8, c7, 1\n ldr r1, [r5]\n str r1, [r5]\n");
  EXPECT_EQ(faults().size(), 2u) << "only what follows the invalidation";
}

/// Chapter 3, FAR: an external abort of several words leaves the last address before the 1 KB boundary
/// behind the word that aborted, or the last of the transfer.
TEST_F(BoundaryTest, ExternalAbortOfSeveralWordsNamesTheEndOfItsKilobyte) {
  struct Row {
    const char* text;
    std::uint32_t far;
  };
  const Row rows[] = {
      {"ldr r0, [r5]", 0x3F8},      {"str r0, [r5]", 0x3F8},       {"ldmia r5, {r0-r3}", 0x3FC},
      {"stmia r5, {r0-r3}", 0x3FC}, {"ldmia r5, {r0, r1}", 0x3FC}, {"ldmia r5, {r0}", 0x3F8},
      {"ldmdb r5, {r0-r3}", 0x3F4}, {"stmib r5!, {r0-r3}", 0x3FC}, {"ldrd r0, r1, [r5]", 0x3FC},
      {"strd r0, r1, [r5]", 0x3FC}, {"ldmia r5!, {r0-r3}", 0x3FC}, {"swp r0, r1, [r5]", 0x3F8},
  };
  m.section(kVa, kNowhere, 0, 0);
  std::string text = kVectors + kCachesOn;
  for (const Row& row : rows) text += std::string(" ldr r5, =0x080003f8\n") + row.text + "\n";
  m.execute(text + " mov r9, r5\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), std::size(rows));
  for (unsigned k = 0; k < f.size(); ++k) {
    EXPECT_EQ(f[k].dfsr, 0x8u) << rows[k].text;
    EXPECT_EQ(f[k].far, kVa + rows[k].far) << rows[k].text;
  }
  EXPECT_EQ(m.core.reg(9), kVa + 0x3F8);
}

/// Two pages, of which the second aborts outside: the words before are there, the base is kept.
TEST_F(BoundaryTest, ExternalAbortBehindTheBoundaryNamesTheLastWord) {
  coarse(kVa, kCoarse);
  page(kCoarse, kVa, kPa);
  page(kCoarse, kVa + 0x1000, kNowhere);
  m.port.set_word(kPa + 0xFFC, 55);
  m.execute(
      kVectors + kCachesOn +
      " ldr r5, =0x08000ff8\n mov r6, r5\n mov r0, #1\n mov r1, #2\n mov r2, #3\n mov r3, #4\n"
      "ldmia r5!, {r0-r3}\n stmia r5!, {r0-r3}\n ldmia r6, {r0-r3, r6}\n ldmib r5!, {r0, r1}\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 4u);
  const std::uint32_t far[] = {0x1004, 0x1004, 0x1008, 0x1000};
  for (unsigned k = 0; k < 4; ++k) {
    EXPECT_EQ(f[k].dfsr, 0xAu);
    EXPECT_EQ(f[k].far, kVa + far[k]) << k;
  }
  EXPECT_EQ(m.core.reg(5), kVa + 0xFF8);
  EXPECT_EQ(m.core.reg(6), kVa + 0xFF8) << "a listed base keeps its value, too";
  EXPECT_EQ(m.core.reg(1), 2u) << "no register of an aborted load changes";
  EXPECT_EQ(m.port.word(kPa + 0xFFC), 2u);
}

/// A fault of the MMU names the first word refused; what lies before is written.
class SecondPageTest : public BoundaryTest, public testing::WithParamInterface<std::uint32_t> {};

TEST_P(SecondPageTest, FaultsBeforeTheBaseMoves) {
  coarse(kVa, kCoarse, 2);
  page(kCoarse, kVa, kPa);
  m.port.set_word(kCoarse + 4, 0);
  page(kCoarse, kVa + 0x2000, kPa + 0x2000);
  page(kCoarse, kVa + 0x3000, kPa + 0x3000, 0);
  for (const std::uint32_t at : {kCoarse, kCoarse + 8, kCoarse + 12})
    m.port.set_word(at, m.port.word(at) | GetParam());
  m.execute(kVectors + kCachesOn +
            " ldr r0, =0x13\n mcr p15, 0, r0, c3, c0, 0\n"
            " ldr r5, =0x08000ff4\n add r6, r5, #0x2000\n mov r0, #1\n mov r1, #2\n mov r2, #3\n"
            "mov r3, #4\n stmia r5!, {r0-r3}\n ldmia r5!, {r0-r3}\n stmia r6!, {r0-r3}\n"
            "ldmia r6!, {r0-r3}\n add r8, r5, #16\n ldmda r8!, {r0-r3}\n"
            "1: mrc p15, 0, r15, c7, c10, 3\n bne 1b\n mov r9, #0\n mcr p15, 0, r9, c7, c10, 4\n");
  const auto f = faults();
  ASSERT_EQ(f.size(), 5u);
  const std::uint32_t far[] = {0x1000, 0x1000, 0x3000, 0x3000, 0x1000};
  for (unsigned k = 0; k < 5; ++k) {
    EXPECT_EQ(f[k].far, kVa + far[k]) << k;
    EXPECT_EQ(f[k].dfsr, k == 2 || k == 3 ? 0x2Fu : 0x27u) << k;
  }
  EXPECT_EQ(m.core.reg(5), kVa + 0xFF4);
  EXPECT_EQ(m.core.reg(6), kVa + 0x2FF4);
  EXPECT_EQ(m.core.reg(8), kVa + 0x1004);
  EXPECT_EQ(m.core.reg(0), 1u);
  EXPECT_EQ(m.port.word(kPa + 0xFFC), 3u);
  EXPECT_EQ(m.port.word(kPa + 0x2FFC), 3u);
}
// C and B of the pages.
INSTANTIATE_TEST_SUITE_P(Kinds, SecondPageTest, testing::Values(0x0u, 0x4u, 0x8u, 0xCu));

/// Low code of two processes at the same virtual address: process 0 writes r[k] = 1, process 1
/// r[k] = 2, and each switches to the other in the middle.
class ProcessTest : public BoundaryTest, public testing::WithParamInterface<unsigned> {
 protected:
  static constexpr std::uint32_t kLow = 0x01C0'0000, kProcess = 0x0200'0000;
  /// @param after what follows the switch at offset 0, with %d for the process' number
  void run(const std::string& after) {
    m.section(kLow, kPa, GetParam(), 0);
    m.section(kProcess | kLow, kPa + 0x100000, GetParam(), 0);
    for (unsigned p = 0; p < 2; ++p) {
      std::string text = " mcr p15, 0, r4, c13, c0, 0\n" + after;
      for (std::size_t at; (at = text.find("%d")) != std::string::npos;)
        text.replace(at, 2, std::to_string(p + 1));
      m.load(assemble(text, kPa + p * 0x100000));
    }
    m.execute(std::string(kCachesOn) +
              " ldr r4, =0x02000000\n mov r5, #0\n ldr r0, =0x01c00000\n"
              "blx r0\n");
  }
};

TEST_P(ProcessTest, TwoInstructionsComeFromTheOldProcess) {
  run("mov r1, #%d\n mov r2, #%d\n mov r3, #%d\n mcr p15, 0, r5, c13, c0, 0\n mov r6, #%d\n"
      "mov r7, #%d\n mov r8, #%d\n mov pc, lr\n");
  const std::uint32_t want[] = {1, 1, 2}, back[] = {2, 2, 1};
  for (unsigned k = 0; k < 3; ++k) {
    EXPECT_EQ(m.core.reg(1 + k), want[k]) << k;
    EXPECT_EQ(m.core.reg(6 + k), back[k]) << k;
  }
}

TEST_P(ProcessTest, BranchIsFetchedFromTheOldProcessAndItsTargetFromTheNew) {
  run("mov r1, #%d\n .if %d == 1\n b 1f\n .else\n nop\n .endif\n mov r2, #9\n 1: mov r3, #%d\n"
      "mcr p15, 0, r5, c13, c0, 0\n nop\n nop\n mov r6, #%d\n mov pc, lr\n");
  EXPECT_EQ(m.core.reg(1), 1u);
  EXPECT_EQ(m.core.reg(2), 0u);
  EXPECT_EQ(m.core.reg(3), 2u);
  EXPECT_EQ(m.core.reg(6), 1u);
}

/// The second instruction was fetched as well, but the flow leaves it and comes back.
TEST_P(ProcessTest, BranchBackFetchesAnew) {
  run("b 1f\n 2: mov r3, #%d\n b 3f\n nop\n 1: b 2b\n 3: mcr p15, 0, r5, c13, c0, 0\n nop\n nop\n"
      "mov pc, lr\n");
  EXPECT_EQ(m.core.reg(3), 2u);
}

TEST_P(ProcessTest, DataMoveAtOnce) {
  m.port.set_word(kPa + 0x800, 1);
  m.port.set_word(kPa + 0x100800, 2);
  run("ldr r1, [r0, #0x800]\n nop\n mcr p15, 0, r5, c13, c0, 0\n ldr r2, [r0, #0x800]\n nop\n"
      "mov pc, lr\n");
  EXPECT_EQ(m.core.reg(1), 2u);
  EXPECT_EQ(m.core.reg(2), 1u);
}

/// Its handler and what it returns to are fetched anew.
TEST_P(ProcessTest, ExceptionEndsTheOldProcess) {
  // The vectors of process 1: the handler of an SWI goes on in its own page.
  m.section(kProcess, 0x0050'0000, GetParam(), 0);
  m.load(assemble(".space 8\n mov r7, #7\n mov pc, lr\n", 0x0050'0000));
  run(".if %d == 1\n svc #16\n .else\n nop\n .endif\n mov r2, #%d\n mov r3, #%d\n"
      "mcr p15, 0, r5, c13, c0, 0\n nop\n nop\n svc #2\n");
  EXPECT_EQ(m.core.reg(7), 7u);
  EXPECT_EQ(m.core.reg(2), 2u);
  EXPECT_EQ(m.core.reg(3), 2u);
}
INSTANTIATE_TEST_SUITE_P(Cached, ProcessTest, testing::Values(0u, 1u));

/// Both words of the handler at 0x18 lie in one piece of the prefetch buffer: one burst fetches
/// them.
TEST(EntryTest, SecondInstructionOfAnUncachedHandlerIsThereAlready) {
  Machine m;
  m.section(0, kPa, 0, 0);
  m.load(
      assemble(".space 0x18\n add r10, r10, #1\n add r10, r10, #1\n add r10, r10, #1\n"
               "subs pc, lr, #4\n",
               kPa));
  constexpr Picoseconds kRaised = 40'000'000;
  m.port.schedule(kRaised, [&m] { m.core.set_irq(true, kRaised); });
  m.port.schedule(kRaised + 10'000, [&m] { m.core.set_irq(false, kRaised + 10'000); });
  m.execute(std::string(kCachesOn) +
                "mov r0, #0\n mcr p15, 0, r0, c9, c1, 1\n mov r10, #0\n msr cpsr_c, #0x1f\n"
                "ldr r0, =4000\n 1: subs r0, r0, #1\n bne 1b\n",
            0x0040'0000);
  EXPECT_EQ(m.core.reg(10), 3u);
  std::vector<std::uint32_t> fetched;
  for (const BusRecord& r : m.port.log)
    if (r.port == BusAccess::Port::kInstruction && r.kind == BusAccess::Kind::kIncr4 &&
        r.address >= kPa && r.address < kPa + 0x100)
      fetched.push_back(r.address - kPa);
  EXPECT_EQ(fetched, (std::vector<std::uint32_t>{0x10, 0x20}));
}

/// Each exception's handler is fetched in one burst, too; then the next piece of four words.
TEST(EntryTest, HandlersOfAllExceptionsAreFetchedOnce) {
  struct Kind {
    const char* cause;
    std::uint32_t vector;
  };
  for (const auto& [cause, vector] : {Kind{"svc #16", 0x08}, Kind{".word 0xe7f000f0", 0x04},
                                      Kind{"ldr r0, [r9]", 0x10}}) {
    Machine m;
    m.section(0, kPa, 0, 0);
    m.section(0x0700'0000, 0, 0, 0, 0);  // no access
    m.load(assemble(".space " + std::to_string(vector) +
                        "\n add r10, r10, #1\n add r10, r10, #1\n svc #2\n",
                    kPa));
    m.execute(std::string(kCachesOn) +
                  "mov r0, #0\n mcr p15, 0, r0, c9, c1, 1\n mov r10, #0\n ldr r9, =0x07000000\n"
                  "mvn r0, #2\n mcr p15, 0, r0, c3, c0, 0\n" + cause,
              0x0040'0000);
    EXPECT_EQ(m.core.reg(10), 2u) << cause;
    std::vector<std::uint32_t> fetched;
    for (const BusRecord& r : m.port.log)
      if (r.port == BusAccess::Port::kInstruction && r.kind == BusAccess::Kind::kIncr4 &&
          r.address >= kPa && r.address < kPa + 0x100)
        fetched.push_back(r.address - kPa);
    const std::uint32_t first = vector & ~15u;
    EXPECT_EQ(fetched, vector % 16 == 8 ? (std::vector<std::uint32_t>{first, first + 16})
                                        : (std::vector<std::uint32_t>{first}))
        << cause;
  }
}

/// Code at one address, flat and mapped: what turns the MMU or the I-cache on or off has two
/// instructions behind it that were fetched before.
class ControlTest : public testing::TestWithParam<std::uint32_t> {
 protected:
  Machine m;
  static constexpr std::uint32_t kFlat = kMemory + 0x0030'0000, kMapped = kMemory + 0x0040'0000;
  /// @param text the code, with %d for 1 (flat) and 2 (mapped); r4 turns the MMU on, r5 off
  void run(const std::string& text) {
    m.section(kFlat, kMapped, GetParam() & 1u, 0);
    for (unsigned k = 0; k < 2; ++k) {
      std::string copy = text;
      for (std::size_t at; (at = copy.find("%d")) != std::string::npos;)
        copy.replace(at, 2, std::to_string(k + 1));
      m.load(assemble(copy, k ? kMapped : kFlat));
    }
    const std::uint32_t cache = GetParam() & 2u ? 0x1000u : 0u;
    m.execute("ldr r0, =0x01000000\n mcr p15, 0, r0, c2, c0, 0\n mvn r0, #0\n"
              "mcr p15, 0, r0, c3, c0, 0\n ldr r4, =" + std::to_string(0x50079u | cache) +
              "\n bic r5, r4, #1\n mcr p15, 0, r5, c1, c0, 0\n ldr r0, =" + std::to_string(kFlat) +
              "\n blx r0\n");
  }
};

TEST_P(ControlTest, TwoInstructionsBehindTheSwitchAreOfBefore) {
  // The I-cache is virtual: what it holds of one world it would give in the other.
  run("mcr p15, 0, r4, c1, c0, 0\n mov r1, #%d\n mov r2, #%d\n b 1f\n .balign 64\n"
      "1: mov r3, #%d\n mcr p15, 0, r5, c1, c0, 0\n mov r6, #%d\n b 2f\n .balign 64\n"
      "2: mov r8, #%d\n mov pc, lr\n");
  EXPECT_EQ(m.core.reg(1), 1u);
  EXPECT_EQ(m.core.reg(2), 1u);
  EXPECT_EQ(m.core.reg(3), 2u);
  EXPECT_EQ(m.core.reg(6), 2u);
  EXPECT_EQ(m.core.reg(8), 1u);
}
INSTANTIATE_TEST_SUITE_P(Caches, ControlTest, testing::Values(0u, 1u, 2u, 3u));

/// The prefetch buffer lives on for them as well. Place of the switch in its piece of four words; then
/// what is read: the piece, perhaps the next one, and the line of the third instruction.
TEST(ControlFetchTest, BothComeWithoutANewFetch) {
  for (const unsigned place : {0u, 1u, 2u, 3u}) {
    Machine m;
    const std::uint32_t code = kMemory + 0x0030'0000;
    m.load(assemble(".rept " + std::to_string(place) +
                        "\n nop\n .endr\n mcr p15, 0, r4, c1, c0, 0\n nop\n nop\n nop\n mov pc, lr\n",
                    code));
    m.execute("ldr r0, =0x01000000\n mcr p15, 0, r0, c2, c0, 0\n mvn r0, #0\n"
              "mcr p15, 0, r0, c3, c0, 0\n ldr r4, =0x51079\n ldr r0, =" + std::to_string(code) +
              "\n blx r0\n");
    std::vector<std::pair<BusAccess::Kind, std::uint32_t>> fetched, want;
    for (const BusRecord& r : m.port.log)
      if (r.port == BusAccess::Port::kInstruction) fetched.emplace_back(r.kind, r.address - code);
    want.emplace_back(BusAccess::Kind::kIncr4, 0u);
    if (place + 2 >= 4) want.emplace_back(BusAccess::Kind::kIncr4, 16u);
    want.emplace_back(BusAccess::Kind::kWrap8, 4 * (place + 3));
    if (4 * (place + 4) >= 32) want.emplace_back(BusAccess::Kind::kWrap8, 4 * (place + 4));
    EXPECT_EQ(fetched, want) << place;
  }
}

}  // namespace
}  // namespace fovea::cpu::test::boundary
