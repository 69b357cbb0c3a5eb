// The register sequences of the boot code, checked by their meaning for the chip: clocks in MHz
// (PLL formula of TI's boot loader and Linux clk/davinci) and DRAM timings in clocks (JEDEC times
// of the part).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/board/clock_presets.h"
#include "register_recorder.h"
#include "sw/fovea/config/clock_setting.h"

extern "C" {
#include "sw/firmware/boot/boot.h"
#include "sw/firmware/drivers/priority.h"

uint32_t mmio_read32(uint32_t address) { return RegisterRecorder::current()->read(address); }
void mmio_write32(uint32_t address, uint32_t value) {
  RegisterRecorder::current()->write(address, value);
}
}

namespace {

constexpr std::uint32_t kPllc1 = 0x01C40800, kPllc2 = 0x01C40C00;

// A chip on which every request succeeds at once.
class BootTest : public testing::Test {
 protected:
  /// A page with a preset's clocks.
  static param_page_t page_of(unsigned preset) {
    const fovea::board::ClockSetting& clocks = fovea::board::kClockPresets[preset].setting;
    const auto ddr = fovea::app::ddr_registers(clocks.ddr());
    param_page_t page{};
    page.clocks = {clocks.pll1, clocks.pll2, clocks.vpss_clk_ctrl, 297'000, 243'000,
                   ddr.sdtimr, ddr.sdtimr2, ddr.sdrcr};
    page.console.divisor = 13;
    for (std::uint8_t& p : page.priority) p = PRIORITY_OF_RESET;
    page.camera_count = 1;
    return page;
  }
  void boot(unsigned preset) {
    param_page_t page = page_of(preset);
    param_page_seal(&page);
    EXPECT_EQ(boot(page), PARAM_PAGE_OK);
  }
  param_page_result_t boot(const param_page_t& page) {
    values.clear();
    recorder.accesses.clear();
    sent.clear();
    values[0x01C40084] = values[0x01C40088] = 0x07000000;
    values[0x01C20014] = 0x60;
    values[0x01C40074] = 0x00182077;  // VTPIOCR out of reset
    recorder.on_write = [this](std::uint32_t address, std::uint32_t value) {
      values[address] = value;
      if (address == 0x01C20000) sent.push_back(static_cast<char>(value));
      if (address == 0x01C41120)  // PTCMD: modules reach the state asked for
        for (unsigned n = 0; n < 52; ++n)
          values[0x01C41800 + 4 * n] = values[0x01C41A00 + 4 * n] & 0x1F;
      if (address == 0x01C40074 && (value & 0x2000)) vtp_looks = 0;
    };
    recorder.on_read = [this](std::uint32_t address) {
      // The VTP controller is ready when it is looked at for the third time.
      if (address == 0x01C40074 && (values[address] & 0x2000) && ++vtp_looks == 3) values[address] |= 0x8000;
      return values[address];
    };
    return boot_init(&page);
  }
  double sysclk(std::uint32_t base, unsigned n) {
    const auto divider = [&](std::uint32_t offset) {
      EXPECT_TRUE(values[base + offset] & 0x8000);
      return (values[base + offset] & 0x1F) + 1.0;
    };
    return 24.0 * 2 * values[base + 0x110] / divider(0x114) / divider(0x128) /
           divider(n <= 3 ? 0x118 + 4 * (n - 1) : 0x160 + 4 * (n - 4));
  }
  unsigned field(std::uint32_t address, unsigned low, unsigned bits) {
    return (values[address] >> low) & ((1u << bits) - 1);
  }
  std::size_t index_of_write(std::uint32_t address, std::uint32_t value, std::size_t from = 0) {
    for (std::size_t i = from; i < recorder.accesses.size(); ++i)
      if (recorder.accesses[i] == RegisterAccess{'w', address, value}) return i;
    ADD_FAILURE() << std::hex << "no write of " << value << " to " << address;
    return 0;
  }
  RegisterRecorder recorder;
  std::map<std::uint32_t, std::uint32_t> values;
  std::string sent;  // by UART0
  unsigned vtp_looks = 0;
};

TEST_F(BootTest, EachPresetGivesItsClocks) {
  struct {
    double arm, ddr, vpss, edma;
  } const expected[] = {{297, 243, 243, 121.5},
                        {297, 270, 270, 135},
                        {270, 216, 216, 108},
                        {216, 172.5, 172.5, 86.25},
                        {432, 340, 340, 170}};
  for (unsigned preset = 0; preset < 5; ++preset) {
    SCOPED_TRACE(preset);
    boot(preset);
    EXPECT_DOUBLE_EQ(sysclk(kPllc2, 2), expected[preset].arm);
    EXPECT_DOUBLE_EQ(sysclk(kPllc1, 7) / 2, expected[preset].ddr);
    EXPECT_DOUBLE_EQ(sysclk(kPllc1, 5), expected[preset].vpss);
    EXPECT_DOUBLE_EQ(sysclk(kPllc1, 4), expected[preset].edma);
    EXPECT_EQ(values[0x01C40048], 0x243F04FCu);
    EXPECT_TRUE(values[kPllc1 + 0x100] & 1);  // PLLEN
    EXPECT_TRUE(values[kPllc2 + 0x100] & 1);
    // The encoder gets 27 MHz from the PLL that VPSS_CLK_CTRL will name.
    const auto source = page_of(preset).clocks.vpss_clk_ctrl >> 5 & 3;
    EXPECT_DOUBLE_EQ(source == 0 ? sysclk(kPllc1, 6) : sysclk(kPllc2, 5), 27.0);
  }
}

TEST_F(BootTest, SaysItsClocks) {
  boot(0);
  EXPECT_EQ(sent, "boot: clocks 297000/243000 kHz\r\nboot: DDR2 up\r\n");
}

// Nothing but the console was touched: no clock, no SDRAM.
TEST_F(BootTest, ABadPageIsRefusedWithASentence) {
  param_page_t page = page_of(0);
  param_page_seal(&page);
  page.version = 1;
  EXPECT_EQ(boot(page), PARAM_PAGE_BAD_VERSION);
  EXPECT_EQ(sent, "failed: parameter page: unknown version; this firmware reads version 5\r\n");
  EXPECT_EQ(values[0x01C67064], 7u) << "phase pins: failed";
  for (const RegisterAccess& a : recorder.writes()) {
    EXPECT_FALSE(a.address >= kPllc1 && a.address < kPllc2 + 0x400) << a;
    EXPECT_FALSE(a.address >> 28 == 2) << a;
  }
  EXPECT_EQ(values[0x01C20020], 13u) << "115200 Bd";
}

TEST_F(BootTest, TheConsolesRateIsThatOfThePage) {
  param_page_t page = page_of(0);
  page.console.divisor = 0x19C;
  param_page_seal(&page);
  EXPECT_EQ(boot(page), PARAM_PAGE_OK);
  EXPECT_EQ(values[0x01C20020], 0x9Cu);
  EXPECT_EQ(values[0x01C20024], 0x01u);
}

TEST_F(BootTest, PrioritiesGoIntoTheirFieldsAndNowhereElse) {
  boot(0);
  values[0x01C4003C] = 0x00550011;
  values[0x01C00284] = 0x7777;
  values[0x01C70008] = 0x2;
  recorder.accesses.clear();
  std::uint8_t priority[PRIORITY_COUNT];
  for (std::uint8_t& p : priority) p = PRIORITY_OF_RESET;
  priority_set(priority);
  EXPECT_TRUE(recorder.accesses.empty()) << "of reset: not even read";
  priority[PRIORITY_ARM] = 6;
  priority_set(priority);
  EXPECT_EQ(values[0x01C4003C], 0x00550016u);
  priority[PRIORITY_IMCOP] = 2;
  priority[PRIORITY_EDMA_TC0] = 1;
  priority[PRIORITY_EDMA_TC1] = 0;
  priority[PRIORITY_EDMA_TC2] = 3;
  priority[PRIORITY_EDMA_TC3] = 4;
  priority[PRIORITY_VPFE] = 5;
  priority[PRIORITY_VPBE] = 7;
  priority_set(priority);
  EXPECT_EQ(values[0x01C4003C], 0x00520016u);
  EXPECT_EQ(values[0x01C00284], 0x4301u);
  EXPECT_EQ(values[0x01C70008], 0x2u | 7u << 2 | 5u << 5);
  EXPECT_EQ(values[0x01C41800], 3u) << "the EDMA is on";
}

TEST_F(BootTest, DramTimingsAreThoseOfTheTable) {
  struct {
    unsigned preset, rfc, rp, rcd, wr, ras, rc, rrd, wtr, xsnr;
  } const rows[] = {{2, 28, 5, 5, 4, 10, 15, 3, 3, 30},
                    {0, 31, 5, 5, 4, 11, 16, 4, 3, 34},
                    {1, 35, 6, 6, 5, 13, 18, 4, 3, 38}};
  for (const auto& row : rows) {
    SCOPED_TRACE(row.preset);
    boot(row.preset);
    const std::uint32_t sdtimr = 0x20000010, sdtimr2 = 0x20000014;
    EXPECT_EQ(field(sdtimr, 25, 7) + 1, row.rfc);
    EXPECT_EQ(field(sdtimr, 22, 3) + 1, row.rp);
    EXPECT_EQ(field(sdtimr, 19, 3) + 1, row.rcd);
    EXPECT_EQ(field(sdtimr, 16, 3) + 1, row.wr);
    EXPECT_EQ(field(sdtimr, 11, 5) + 1, row.ras);
    EXPECT_EQ(field(sdtimr, 6, 5) + 1, row.rc);
    EXPECT_EQ(field(sdtimr, 3, 3) + 1, row.rrd);
    EXPECT_EQ(field(sdtimr, 0, 3) + 1, row.wtr);
    EXPECT_EQ(field(sdtimr2, 16, 7) + 1, row.xsnr);
    EXPECT_EQ(field(sdtimr2, 8, 8), 199u);
  }
  boot(0);
  EXPECT_EQ(values[0x2000000C], 1895u);  // refresh, 7.8 us at 243 MHz
  EXPECT_EQ(values[0x20000008], 0x00534A32u);
  EXPECT_EQ(values[0x200000E4], 0xC5u);
  EXPECT_EQ(values[0x20000020], 0xFEu);
}

// The controller has no field for tFAW, 50 ns for the x16 parts of speed grade -3: four T_RRD must
// take as long, and one clock less each would not.
TEST_F(BootTest, FourActivationsTakeFawAtLeast) {
  const double megahertz[] = {243, 270, 216, 172.5, 340};
  for (unsigned preset = 0; preset < 5; ++preset) {
    boot(preset);
    const unsigned rrd = field(0x20000010, 3, 3) + 1;
    EXPECT_GE(4 * rrd * 1000 / megahertz[preset], 50.0) << preset;
    EXPECT_LT(4 * (rrd - 1) * 1000 / megahertz[preset], 50.0) << preset;
  }
}

// 7.8 us at most, and less than 0.1 us wasted, at the clock that the PLL really gives.
TEST_F(BootTest, RefreshesOftenEnough) {
  const double megahertz[] = {243, 270, 216, 172.5, 340};
  for (unsigned preset = 0; preset < 5; ++preset) {
    boot(preset);
    EXPECT_LE(values[0x2000000C] / megahertz[preset], 7.8) << preset;
    EXPECT_GT(values[0x2000000C] / megahertz[preset], 7.7) << preset;
  }
}

TEST_F(BootTest, TheSequenceIsTheLoaders) {
  boot(0);
  const std::size_t pll1 = index_of_write(kPllc1 + 0x138, 1);
  const std::size_t pll2 = index_of_write(kPllc2 + 0x138, 1);
  const std::size_t mux = index_of_write(0x01C40048, 0x243F04FC);
  const std::size_t vtp = index_of_write(0x01C40074, 0x00182037);
  const std::size_t reset = index_of_write(0x01C41A00 + 4 * 13, 1);
  const std::size_t enabled = index_of_write(0x01C41A00 + 4 * 13, 3, reset);
  const std::size_t phy = index_of_write(0x200000E4, 0xC5);
  const std::size_t unlock = index_of_write(0x20000008, 0x0053C832);
  const std::size_t timing = index_of_write(0x20000010, values[0x20000010]);
  const std::size_t final_bank = index_of_write(0x20000008, 0x00534A32);
  const std::size_t refresh = index_of_write(0x2000000C, 1895);
  const std::size_t second_reset = index_of_write(0x01C41A00 + 4 * 13, 1, refresh);
  EXPECT_TRUE(pll1 < pll2 && pll2 < mux && mux < vtp && vtp < reset && reset < enabled &&
              enabled < phy && phy < unlock && unlock < timing && timing < final_bank && final_bank < refresh &&
              refresh < second_reset);
  EXPECT_EQ(values[0x01C41800 + 4 * 13], 3u) << "DDR2 enabled at the end";
}

// TENABLE, TENABLEDIV and TINITZ fall one after the other, and TENABLE rises again, as in TI's boot loader: behind
// multiplier and pre-divider, before the dividers are taken over.
TEST_F(BootTest, EachPllGoesThroughItsInitialisationBeforeItsDividersAct) {
  boot(0);
  for (const std::uint32_t base : {kPllc1, kPllc2}) {
    SCOPED_TRACE(base);
    std::vector<std::uint32_t> written;
    for (const RegisterAccess& a : recorder.writes())
      if (a.address == base + 0x108) written.push_back(a.value);
    EXPECT_THAT(written, testing::ElementsAre(0x00470000, 0x00460000, 0x00400000, 0x00410000));
    const std::size_t first = index_of_write(base + 0x108, 0x00470000);
    EXPECT_LT(index_of_write(base + 0x110, values[base + 0x110]), first) << "PLLM";
    EXPECT_LT(index_of_write(base + 0x114, values[base + 0x114]), first) << "PREDIV";
    EXPECT_LT(index_of_write(base + 0x108, 0x00410000), index_of_write(base + 0x138, 1)) << "PLLCMD.GOSET";
  }
}

// Power up with CLRZ low, raise it, wait for READY (bit 15); then LOCK, and the power-down bits again.
TEST_F(BootTest, TheVtpControllerIsCalibratedAndThenLocked) {
  boot(0);
  std::vector<std::uint32_t> written;
  for (const RegisterAccess& a : recorder.writes())
    if (a.address == 0x01C40074) written.push_back(a.value);
  EXPECT_THAT(written, testing::ElementsAre(0x00180037, 0x00182037, 0x0018A0B7, 0x0018E0F7));
}

TEST_F(BootTest, NothingTouchesDdrItself) {
  boot(4);
  for (const RegisterAccess& a : recorder.accesses) EXPECT_LT(a.address, 0x80000000u);
}

TEST_F(BootTest, ModulesThatTheFirmwareUsesAreOn) {
  boot(0);
  for (unsigned module : {13, 18, 19, 26, 27, 47}) EXPECT_EQ(values[0x01C41800 + 4 * module], 3u);
  EXPECT_EQ(values[0x01C40000], 0x00FD0000u) << "video input pins";
  EXPECT_EQ(values[0x01C40004], 0x00145555u) << "video output pins";
  EXPECT_EQ(values[0x01C4000C], 1u << 19 | 1u << 20 | 2u << 21 | 2u << 23) << "UART0, SCL, SDA";
  EXPECT_EQ(values[0x01C67064], 1u) << "phase pins: boot";
  EXPECT_EQ(values[0x01C67060] & 0xFFFu, 0u) << "phase pins: outputs";
}

}  // namespace
