// PLLs, clock tree, module gates and the system module, programmed like a boot loader does.
#include <vector>

#include "model/periph/clock_tree.h"
#include "model/periph/pll_controller.h"
#include "model/periph/psc.h"
#include "model/periph/system_module.h"
#include "model/periph/timer64.h"
#include "tb/own_diagnostics.h"
#include "tb/periph/bench.h"

namespace fovea::periph {
namespace {
using test::now;
using test::run_until;

enum : std::uint32_t {
  kPllctl = 0x100,
  kSecctl = 0x108,
  kPllm = 0x110,
  kPrediv = 0x114,
  kPostdiv = 0x128,
  kPllcmd = 0x138,
  kPllstat = 0x13C,
  kDchange = 0x144
};
std::uint32_t plldiv(unsigned n) { return n <= 3 ? 0x114 + 4 * n : 0x160 + 4 * (n - 4); }

struct System {
  OwnDiagnostics diagnostics;
  ClockSignal osc{"osc", Frequency(24'000'000)};
  sc_core::sc_vector<ClockSignal> sysclk1{"sysclk1", 9}, sysclk2{"sysclk2", 5};
  sc_core::sc_signal<bool> locked1{"locked1"}, locked2{"locked2"};
  sc_core::sc_signal<std::uint32_t> peri{"peri"}, vpss_ctrl{"vpss_ctrl"}, mstpri0{"mstpri0"},
      misc{"misc"};
  ClockSignal arm{"arm"}, ddr{"ddr"}, edma{"edma"}, vpss{"vpss"}, venc{"venc"}, aux{"aux"},
      uart1{"uart1"};
  sc_core::sc_signal<bool> gpio_on{"gpio_on"}, arm_on{"arm_on"}, timer3_on{"timer3_on"};
  PllParams pll_params;
  PscParams psc_params;
  SystemParams system_params;
  PllController pllc1{"pllc1", "PLLC1", 9, pll_params}, pllc2{"pllc2", "PLLC2", 5, pll_params};
  SystemModule system{"system", system_params};
  ClockTree tree{"tree"};
  Psc psc{"psc", psc_params};
  Timer64 timer3{"timer3"};
  test::Bus b1{"b1"}, b2{"b2"}, bs{"bs"}, bp{"bp"}, bt{"bt"};
  System() {
    pllc1.osc(osc);
    pllc2.osc(osc);
    pllc1.sysclk.bind(sysclk1);
    pllc2.sysclk.bind(sysclk2);
    pllc1.locked(locked1);
    pllc2.locked(locked2);
    system.pll1_locked(locked1);
    system.pll2_locked(locked2);
    system.peri_clk_ctrl(peri);
    system.vpss_clk_ctrl(vpss_ctrl);
    system.mstpri0(mstpri0);
    system.misc(misc);
    tree.osc(osc);
    tree.pll1_sysclk2(sysclk1[1]);
    tree.pll1_sysclk4(sysclk1[3]);
    tree.pll1_sysclk5(sysclk1[4]);
    tree.pll1_sysclk6(sysclk1[5]);
    tree.pll1_sysclk7(sysclk1[6]);
    tree.pll2_sysclk2(sysclk2[1]);
    tree.pll2_sysclk3(sysclk2[2]);
    tree.pll2_sysclk5(sysclk2[4]);
    tree.peri_clk_ctrl(peri);
    tree.vpss_clk_ctrl(vpss_ctrl);
    tree.arm_clk(arm);
    tree.ddr_clk(ddr);
    tree.edma_clk(edma);
    tree.vpss_clk(vpss);
    tree.venc_clk(venc);
    tree.aux_clk(aux);
    tree.uart1_clk(uart1);
    psc.enabled[kLpscGpio](gpio_on);
    psc.enabled[kLpscArm](arm_on);
    psc.enabled[kLpscTimer3](timer3_on);
    timer3.clk(aux);
    timer3.lpsc(timer3_on);
    b1.socket.bind(pllc1.reg_socket);
    b2.socket.bind(pllc2.reg_socket);
    bs.socket.bind(system.reg_socket);
    bp.socket.bind(psc.reg_socket);
    bt.socket.bind(timer3.reg_socket);
  }
};

System& sys() {
  static System* s = new System;
  return *s;
}

/// The boot loader's order: bypass, reset pulse, multiplier and dividers, GO.
void program_pll(test::Bus& b, std::uint32_t pllm, std::uint32_t prediv,
                 const std::vector<std::uint32_t>& dividers) {
  auto clear = [&](std::uint32_t bits) { b.write(kPllctl, b.read(kPllctl) & ~bits); };
  clear(0x002);  // power up
  clear(0x100);
  clear(0x020);  // PLLENSRC
  clear(0x001);  // bypass
  b.write(kPllctl, b.read(kPllctl) | 0x008);
  run_until(now() + kPsPerUs);
  clear(0x008);
  b.write(kPllm, pllm);
  b.write(kPrediv, 0x8000 | prediv);
  for (std::uint32_t v : {0x00470000u, 0x00460000u, 0x00400000u, 0x00410000u}) b.write(kSecctl, v);
  b.write(kPostdiv, 0x8000);
  for (unsigned n = 0; n < dividers.size(); ++n) b.write(plldiv(n + 1), 0x8000 | dividers[n]);
  b.write(kPllcmd, 1);
}

void wait_lock(std::uint32_t config) {
  for (int n = 0; n < 1000 && (sys().bs.read(config) & 0x07000000) != 0x07000000; ++n)
    run_until(now() + kPsPerUs);
  ASSERT_EQ(sys().bs.read(config) & 0x07000000, 0x07000000u);
}

struct Preset {
  const char* name;
  std::uint32_t m1, pre1;
  std::vector<std::uint32_t> div1;
  std::uint32_t m2, pre2;
  std::vector<std::uint32_t> div2;
  std::uint32_t vpss_clk_ctrl;
  Frequency arm, ddr, vpss, edma, venc;
};

Frequency khz(std::uint64_t f) { return Frequency(f * 1000); }

const Preset kPresets[] = {
    {"297/243",
     0x51,
     7,
     {0x13, 1, 1, 3, 1, 0x11, 0, 4, 1},
     0x63,
     7,
     {0x18, 1, 1, 0x1C, 7},
     0x18,
     khz(297'000),
     khz(243'000),
     khz(243'000),
     khz(121'500),
     khz(27'000)},
    {"297/270",
     0x2D,
     3,
     {0x2C, 1, 1, 3, 1, 0x13, 0, 5, 1},
     0x63,
     7,
     {0x18, 1, 1, 0x1C, 7},
     0x18,
     khz(297'000),
     khz(270'000),
     khz(270'000),
     khz(135'000),
     khz(27'000)},
    {"270/216",
     0x9,
     0,
     {0x11, 1, 1, 3, 1, 5, 0, 3, 1},
     0x2D,
     7,
     {0xA, 0, 0, 5, 9},
     0x38,
     khz(270'000),
     khz(216'000),
     khz(216'000),
     khz(108'000),
     khz(27'000)},
    {"216/172",
     0x73,
     0xF,
     {0xD, 1, 1, 3, 1, 0xC, 0, 3, 1},
     0x12,
     1,
     {0x11, 1, 1, 0x14, 0xF},
     0x18,
     khz(216'000),
     khz(172'500),
     khz(172'500),
     khz(86'250),
     Frequency(345'000'000, 13)},
    {"432/340",
     0x55,
     5,
     {0x1B, 1, 1, 3, 1, 8, 0, 6, 0x1B},
     0x9,
     0,
     {0x11, 0, 1, 0x14, 0xF},
     0x38,
     khz(432'000),
     khz(340'000),
     khz(340'000),
     khz(170'000),
     khz(27'000)},
};

TEST(ClocksTest, AStartsInBypassOnTheOscillator) {
  System& s = sys();
  run_until(kPsPerNs);
  EXPECT_EQ(s.arm.read(), khz(24'000));
  EXPECT_EQ(s.ddr.read(), khz(12'000));
  EXPECT_EQ(s.aux.read(), khz(24'000));
  EXPECT_TRUE(s.venc.read().stopped());  // VENCLKEN is 0 at reset
  EXPECT_EQ(s.b1.read(0x0E4), 1u);       // RSTYPE: power-on
  EXPECT_EQ(s.bs.read(0x84), 0u);        // not locked
}

TEST(ClocksTest, BBootLoaderSequencesGiveThePresets) {
  System& s = sys();
  for (const Preset& p : kPresets) {
    SCOPED_TRACE(p.name);
    program_pll(s.b1, p.m1, p.pre1, p.div1);
    wait_lock(0x84);
    s.b1.write(kPllctl, s.b1.read(kPllctl) | 1);
    program_pll(s.b2, p.m2, p.pre2, p.div2);
    wait_lock(0x88);
    s.b2.write(kPllctl, s.b2.read(kPllctl) | 1);
    s.bs.write(0x48, 0x243F04FC);
    s.bs.write(0x44, p.vpss_clk_ctrl);
    EXPECT_EQ(s.arm.read(), p.arm);
    EXPECT_EQ(s.ddr.read(), p.ddr);
    EXPECT_EQ(s.vpss.read(), p.vpss);
    EXPECT_EQ(s.edma.read(), p.edma);
    EXPECT_EQ(s.uart1.read(), p.edma);
    EXPECT_EQ(s.venc.read(), p.venc);
    EXPECT_EQ(s.aux.read(), khz(24'000));
  }
}

struct PllTest : testing::Test {
  System& s = sys();
  void SetUp() override {
    const Preset& p = kPresets[0];
    program_pll(s.b1, p.m1, p.pre1, p.div1);
    wait_lock(0x84);
    s.b1.write(kPllctl, s.b1.read(kPllctl) | 1);
    program_pll(s.b2, p.m2, p.pre2, p.div2);
    wait_lock(0x88);
    s.b2.write(kPllctl, s.b2.read(kPllctl) | 1);
    s.bs.write(0x48, 0x243F04FC);
    s.bs.write(0x44, 0x18);
  }
};

TEST_F(PllTest, RatiosActGoTimeAfterGosetAndNotBefore) {
  s.b1.write(plldiv(4), 0x8005);
  EXPECT_EQ(s.b1.read(kDchange), 1u << 3);
  run_until(now() + kPsPerMs);
  EXPECT_EQ(s.edma.read(), khz(121'500));
  s.b1.write(kPllcmd, 1);
  const Picoseconds go = now();
  EXPECT_EQ(s.b1.read(kPllstat) & 1, 1u);
  run_until(go + s.pll_params.go_time() - 1);
  EXPECT_EQ(s.b1.read(kPllstat) & 1, 1u);
  EXPECT_EQ(s.edma.read(), khz(121'500));
  run_until(go + s.pll_params.go_time());
  EXPECT_EQ(s.edma.read(), khz(81'000));
  EXPECT_EQ(s.b1.read(kPllstat) & 1, 0u);
  EXPECT_EQ(s.b1.read(kDchange), 0u);
}

// The crossbar's clock apart from the SDRAM's, as no chip can have it: from PLL1's first multiplied output on, and only
// the one that crossbar, EDMA and registers share.
TEST_F(PllTest, TheCrossbarsClockMayBeSetApart) {
  const Frequency before[] = {s.ddr.read(), s.vpss.read(), s.arm.read(), s.uart1.read(), s.aux.read()};
  s.tree.set_crossbar(khz(170'000));
  s.bs.write(0x48, 0x243F04FC & ~(1u << 29));  // any change of a multiplexer
  run_until(now() + kPsPerMs);
  s.bs.write(0x48, 0x243F04FC);
  run_until(now() + kPsPerMs);
  EXPECT_EQ(s.edma.read(), khz(170'000));
  const Frequency after[] = {s.ddr.read(), s.vpss.read(), s.arm.read(), s.uart1.read(), s.aux.read()};
  EXPECT_TRUE(std::equal(std::begin(before), std::end(before), std::begin(after)));
  s.b1.write(kPllctl, s.b1.read(kPllctl) & ~1u);  // bypass
  run_until(now() + kPsPerMs);
  EXPECT_EQ(s.edma.read(), khz(6'000)) << "the crystal's clock is not multiplied";
  s.tree.set_crossbar({});  // acts with the next change, which a write does before it returns
  s.b1.write(kPllctl, s.b1.read(kPllctl) | 1);
  run_until(now() + kPsPerMs);
  EXPECT_EQ(s.edma.read(), khz(121'500));
}

TEST_F(PllTest, DisabledDividerStopsItsClock) {
  s.b1.write(plldiv(5), 0x0001);
  s.b1.write(kPllcmd, 1);
  run_until(now() + kPsPerMs);
  EXPECT_TRUE(s.vpss.read().stopped());
  EXPECT_EQ(s.b1.read(0x150), 0x1EFu);
  EXPECT_EQ(s.b2.read(0x150), 0x1Fu);  // SYSTAT of the PLL with five dividers
}

TEST_F(PllTest, LockComesLockTimeAfterTheLastChangeAndTheOldFrequencyStaysUntilThen) {
  s.diagnostics.clear();
  s.b1.write(kPllm, 0x52);
  const Picoseconds change = now();
  EXPECT_EQ(s.diagnostics.counts().size(), 1u);            // PLLEN is 1
  EXPECT_EQ(s.edma.read(), khz(121'500));                  // not bypassed
  run_until(change + s.pll_params.lock_time() - 1);
  EXPECT_EQ(s.bs.read(0x84), 0u);
  EXPECT_EQ(s.edma.read(), khz(121'500));
  run_until(change + s.pll_params.lock_time());
  EXPECT_EQ(s.bs.read(0x84), 0x1F000000u);
  EXPECT_EQ(s.edma.read(), khz(123'000));  // 24 x 2 x 82 / 8 / 4
}

TEST_F(PllTest, WritingTheValueThatIsThereKeepsLockAndClock) {
  for (const std::uint32_t reg : {kPllm, kPrediv, kSecctl}) {
    const Picoseconds at = now();
    s.b1.write(reg, s.b1.read(reg));
    run_until(at + kPsPerNs);
    EXPECT_EQ(s.bs.read(0x84), 0x1F000000u) << std::hex << reg;
    EXPECT_EQ(s.edma.read(), khz(121'500)) << std::hex << reg;
  }
}

TEST_F(PllTest, EachChangeOfMultiplierPreDividerOrSecctlLosesTheLock) {
  for (const std::uint32_t reg : {kPllm, kPrediv, kSecctl}) {
    s.b1.write(reg, s.b1.read(reg) ^ 2);
    EXPECT_EQ(s.bs.read(0x84), 0u) << std::hex << reg;
    EXPECT_EQ(s.b1.read(kPllstat) & 2, 0u);
    run_until(now() + s.pll_params.lock_time());
    EXPECT_EQ(s.bs.read(0x84), 0x1F000000u) << std::hex << reg;
    s.b1.write(reg, s.b1.read(reg) ^ 2);  // back: a change again
    EXPECT_EQ(s.bs.read(0x84), 0u) << std::hex << reg;
    run_until(now() + s.pll_params.lock_time());
  }
  EXPECT_EQ(s.edma.read(), khz(121'500));
}

TEST_F(PllTest, APllOutOfResetStaysBypassedUntilItHasLocked) {
  s.b1.write(kPllctl, s.b1.read(kPllctl) | 8);  // PLLRST with PLLEN = 1
  EXPECT_EQ(s.edma.read(), khz(6'000));
  s.b1.write(kPllctl, s.b1.read(kPllctl) & ~8u);
  const Picoseconds release = now();
  run_until(release + s.pll_params.lock_time() - 1);
  EXPECT_EQ(s.edma.read(), khz(6'000));
  run_until(release + s.pll_params.lock_time());
  EXPECT_EQ(s.edma.read(), khz(121'500));
}

TEST_F(PllTest, DchangeShowsRatiosThatDifferFromThoseInEffect) {
  s.b1.write(plldiv(4), 0x8005);
  s.b1.write(plldiv(5), 0x0001);
  EXPECT_EQ(s.b1.read(kDchange), 1u << 3 | 1u << 4);
  s.b1.write(plldiv(4), 0x8003);  // as in effect
  EXPECT_EQ(s.b1.read(kDchange), 1u << 4);
  s.b1.write(plldiv(5), 0x8001);
  EXPECT_EQ(s.b1.read(kDchange), 0u);
}

TEST_F(PllTest, PllenBeforeTheLockGivesAWarning) {
  s.diagnostics.clear();
  s.b1.write(kPllctl, 0x48);  // bypass, in reset
  EXPECT_EQ(s.bs.read(0x84), 0u);
  EXPECT_EQ(s.arm.read(), khz(297'000));  // the ARM is on the other PLL
  EXPECT_TRUE(s.diagnostics.counts().empty());
  s.b1.write(kPllctl, 0x41);
  EXPECT_EQ(s.diagnostics.counts().size(), 1u);
}

TEST_F(PllTest, PostdivAndPrescalerSourceBitsChangeTheOutput) {
  s.b1.write(kPostdiv, 0x8001);
  EXPECT_EQ(s.vpss.read(), khz(121'500));
  s.b1.write(kPllctl, s.b1.read(kPllctl) | 0x20);  // PLLENSRC: PLLEN no longer decides
  EXPECT_EQ(s.vpss.read(), khz(12'000));
}

TEST_F(PllTest, MultiplexersSelectTheOtherPll) {
  s.bs.write(0x48, 0x0BFF077C);  // ARM from PLL1, DDR from PLL2
  EXPECT_EQ(s.arm.read(), khz(243'000));
  EXPECT_EQ(s.ddr.read(), khz(148'500));
  s.bs.write(0x44, 0x38);  // VENC from PLL2 SYSCLK5
  EXPECT_EQ(s.venc.read(), khz(74'250));
  s.bs.write(0x44, 0x58);  // crystal
  EXPECT_EQ(s.venc.read(), khz(24'000));
  s.bs.write(0x44, 0x10);  // VENCLKEN off
  EXPECT_TRUE(s.venc.read().stopped());
}

TEST(PscTest, TransitionIsSeenOnlyAfterPtcmdAndItsTime) {
  System& s = sys();
  const std::uint32_t mdctl = 0xA00 + 4 * kLpscGpio, mdstat = 0x800 + 4 * kLpscGpio;
  EXPECT_TRUE(s.arm_on.read());
  EXPECT_FALSE(s.gpio_on.read());
  EXPECT_EQ(s.bp.read(mdstat) & 0x1F, 0u);
  s.bp.write(mdctl, s.bp.read(mdctl) | 3);
  run_until(now() + kPsPerMs);
  EXPECT_EQ(s.bp.read(mdstat) & 0x1F, 0u);  // NEXT alone does nothing
  s.bp.write(0x120, 1);
  const Picoseconds go = now();
  run_until(go + s.psc_params.transition_time() - 1);
  EXPECT_EQ(s.bp.read(0x128) & 1, 1u);
  EXPECT_FALSE(s.gpio_on.read());
  run_until(go + s.psc_params.transition_time());
  EXPECT_EQ(s.bp.read(0x128) & 1, 0u);
  EXPECT_EQ(s.bp.read(mdstat) & 0x1F, 3u);
  EXPECT_TRUE(s.gpio_on.read());
  for (std::uint32_t state : {1u, 2u, 0u}) {
    s.bp.write(mdctl, (s.bp.read(mdctl) & ~0x1Fu) | state);
    s.bp.write(0x120, 1);
    run_until(now() + s.psc_params.transition_time());
    EXPECT_EQ(s.bp.read(mdstat) & 0x1F, state);
    EXPECT_FALSE(s.gpio_on.read());
  }
  EXPECT_TRUE(s.arm_on.read());
}

TEST(PscTest, AReservedNextStateChangesNothing) {
  System& s = sys();
  const std::uint32_t mdctl = 0xA00 + 4 * kLpscTimer3, mdstat = 0x800 + 4 * kLpscTimer3;
  const std::uint32_t before = s.bp.read(mdstat);
  for (const std::uint32_t state : {4u, 0x1Fu}) {
    s.bp.write(mdctl, state);
    s.bp.write(0x120, 1);
    run_until(now() + s.psc_params.transition_time());
    EXPECT_EQ(s.bp.read(mdstat), before) << state;
    EXPECT_FALSE(s.timer3_on.read());
  }
  s.bp.write(mdctl, 0);
}

// 52 modules, 0 to 51; behind their registers there is nothing.
TEST(PscTest, TheRegistersEndWithTheLastModule) {
  System& s = sys();
  auto& notes = s.diagnostics;
  for (const std::uint32_t first : {0x800u, 0xA00u}) {
    notes.clear();
    s.bp.read(first + 4 * 51);
    EXPECT_TRUE(notes.counts().empty());
    EXPECT_EQ(s.bp.read(first + 4 * 52), 0u);
    EXPECT_EQ(notes.counts().size(), 1u) << std::hex << first;
  }
}

TEST(PscTest, GatedModuleAnswersAfterItsTransitionAndGivesAWarningBefore) {
  System& s = sys();
  s.diagnostics.clear();
  s.bt.write(0x18, 123);
  EXPECT_EQ(s.diagnostics.counts().size(), 1u);
  s.bp.write(0xA00 + 4 * kLpscTimer3, 3);
  s.bp.write(0x120, 1);
  run_until(now() + s.psc_params.transition_time());
  EXPECT_EQ(s.bt.read(0x18), 0u);  // the early write was lost
  s.bt.write(0x18, 124);
  EXPECT_EQ(s.bt.read(0x18), 124u);
}

TEST(SystemModuleTest, RegistersHaveTheirResetValues) {
  System& s = sys();
  const std::pair<std::uint32_t, std::uint32_t> values[] = {
      {0x00, 0},      {0x20, 0x700},      {0x28, 0x0B83E02F}, {0x2C, 0x00115500},
      {0x34, 0xC7},   {0x38, 0x13},       {0x3C, 0x00550011}, {0x40, 0x444},
      {0x4C, 0x176B}, {0x74, 0x00182077},  // VTPIOCR: READY is 0 although CLRZ is 1
      {0x78, ~0u},    {0x7C, ~0u},        {0x80, 1}};
  for (auto [offset, value] : values) EXPECT_EQ(s.bs.read(offset), value) << offset;
}

TEST(SystemModuleTest, PrioritiesAndMiscReachTheirPorts) {
  System& s = sys();
  EXPECT_EQ(s.mstpri0.read(), 0x00550011u);
  s.bs.write(0x3C, 0x00440022);
  EXPECT_EQ(s.mstpri0.read(), 0x00440022u);
  s.bs.write(0x38, 0x92);
  EXPECT_EQ(s.misc.read(), 0x92u);
  s.bs.write(0x28, 0);  // read-only
  EXPECT_EQ(s.bs.read(0x28), 0x0B83E02Fu);
}

TEST(SystemModuleTest, SettingsWithoutEffectAreNamed) {
  System& s = sys();
  auto& notes = s.diagnostics;
  struct Setting {
    std::uint32_t offset, harmless, word;
    const char* name;
  };
  for (const Setting& t :
       {Setting{0x30, 0, 1, "TIMER64_CTL.GIO1_2"}, Setting{0x30, 0, 2, "TIMER64_CTL.GIO3_4"},
        Setting{0x38, 0x393, 0xB3, "MISC.CLKSTP_BYP"},
        Setting{0x54, 0x1FFFFF, 0x80000000, "DEBOUNCE0.ENABLE"},
        Setting{0x70, 0x1FFFFF, 0x80000010, "DEBOUNCE7.ENABLE"}}) {
    notes.clear();
    s.bs.write(t.offset, t.harmless);
    EXPECT_TRUE(notes.counts().empty()) << t.name;
    s.bs.write(t.offset, t.word);
    s.bs.write(t.offset, t.word);
    const auto counts = notes.counts();
    ASSERT_EQ(counts.size(), 1u) << t.name;
    const auto& [what, times] = *counts.begin();
    EXPECT_EQ(what.first, Diagnostics::Kind::kNotModelled);
    EXPECT_TRUE(what.second.starts_with(std::string("SYSTEM ") + t.name + " (")) << what.second;
    EXPECT_TRUE(what.second.ends_with("): only 0 is modelled")) << what.second;
    EXPECT_EQ(times, 2u);
    s.bs.write(t.offset, t.offset == 0x38 ? 0x13 : 0);
  }
}

TEST(SystemModuleTest, VtpIsReadyAfterTheRiseOfClrz) {
  System& s = sys();
  s.bs.write(0x74, s.bs.read(0x74) & 0xFFFF9F3F);
  EXPECT_EQ(s.bs.read(0x74) & 0x8000, 0u);
  run_until(now() + kPsPerMs);
  EXPECT_EQ(s.bs.read(0x74) & 0x8000, 0u);
  s.bs.write(0x74, s.bs.read(0x74) | 0x2000);
  const Picoseconds rise = now();
  run_until(rise + s.system_params.vtp_time() - 1);
  EXPECT_EQ(s.bs.read(0x74) & 0x8000, 0u);
  run_until(rise + s.system_params.vtp_time());
  EXPECT_EQ(s.bs.read(0x74) & 0x8000, 0x8000u);
}

}  // namespace
}  // namespace fovea::periph

FOVEA_SC_TEST_MAIN
