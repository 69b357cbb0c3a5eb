// The firmware's register header and the page of blocks are what the declarations say.
#include "model/soc/platform_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "model/soc/rtl_text.h"
#include "tb/periph/bench.h"

namespace fovea::soc {
namespace {

using testing::HasSubstr;

const PlatformText& text() {
  static const PlatformText made = platform_text();
  return made;
}

std::string file(const std::string& name) {
  std::ifstream in(SOURCE "/" + name);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

TEST(PlatformText, RegisterHeaderIsFresh) {
  EXPECT_EQ(file("sw/firmware/registers.h"), text().registers_h)
      << "write it again: build/release/model/soc/platform_text registers.h > sw/firmware/registers.h";
}

TEST(PlatformText, PageOfBlocksIsFresh) {
  EXPECT_EQ(file("model/soc/BLOCKS.md"), text().blocks_md)
      << "write it again: build/release/model/soc/platform_text BLOCKS.md > model/soc/BLOCKS.md";
}

TEST(PlatformText, PackageOfTheEnginesRegistersIsFresh) {
  EXPECT_EQ(file("rtl/remap/remap_regs_pkg.sv"), rtl_text().package)
      << "write it again: build/release/model/soc/platform_text remap_regs_pkg.sv > "
         "rtl/remap/remap_regs_pkg.sv";
}

TEST(PlatformText, TableOfTheEnginesRegistersIsFresh) {
  EXPECT_THAT(file("rtl/README.md"), HasSubstr("\n|---|---|---|---|\n" + rtl_text().table + "\n"))
      << "write it again: build/release/model/soc/platform_text rtl-registers";
}

TEST(PlatformText, TextsOfRegistersSayBitsModesAndWhatIsWritable) {
  RegBank bank("PLANTED");
  const Reg number(bank, "NUMBER", 0x04, Mode::kRo, "a number", 7), free(bank, "FREE", 0x3FC, Mode::kRw, "anything");
  Reg mixed(bank, "MIXED", 0x80, "some of each");
  const Field one(mixed, "ONE", 0, 1, Mode::kRw, "first"), two(mixed, "TWO", 1, 2, Mode::kW1c, "second"),
      three(mixed, "THREE", 8, 4, Mode::kWo, "third"), four(mixed, "FOUR", 30, 2, Mode::kRw, "fourth");
  const RtlText text = rtl_text(bank);
  const std::string zeros = "00000000_";
  EXPECT_THAT(text.package, testing::EndsWith("256'h80000000_" + zeros + zeros + zeros + zeros + zeros +
      "00000001_00000002;\n"
      "  // 0x04 NUMBER: a number\n"
      "  localparam logic [7:0] NUMBER_WORD = 8'd1;\n"
      "  localparam logic [31:0] NUMBER_RESET = 32'h00000007;\n"
      "  // 0x3FC FREE: anything\n"
      "  localparam logic [7:0] FREE_WORD = 8'd255;\n"
      "  localparam logic [31:0] FREE_WRITABLE = 32'hFFFFFFFF;\n"
      "  // 0x80 MIXED: some of each\n"
      "  localparam logic [7:0] MIXED_WORD = 8'd32;\n"
      "  localparam logic [31:0] MIXED_WRITABLE = 32'hC0000001;\n"
      "  localparam int unsigned MIXED_ONE_LSB = 0, MIXED_ONE_BITS = 1;\n"
      "  localparam int unsigned MIXED_TWO_LSB = 1, MIXED_TWO_BITS = 2;\n"
      "  localparam int unsigned MIXED_THREE_LSB = 8, MIXED_THREE_BITS = 4;\n"
      "  localparam int unsigned MIXED_FOUR_LSB = 30, MIXED_FOUR_BITS = 2;\n"
      "endpackage\n"));
  EXPECT_EQ(text.table, "| 0x04 `NUMBER` | 31:0 | ro | a number |\n"
                        "| 0x3FC `FREE` | 31:0 | rw | anything |\n"
                        "| 0x80 `MIXED` | 0 | rw | `ONE`: first |\n"
                        "|  | 2:1 | 1 clears | `TWO`: second |\n"
                        "|  | 11:8 | wo | `THREE`: third |\n"
                        "|  | 31:30 | rw | `FOUR`: fourth |\n");
}

// Addresses, masks and numbers typed in from the public drivers (Linux dm365.c, irqs.h, psc.h, TI's register
// headers).
TEST(PlatformText, HeaderHasAddressesFieldsGatesAndInterrupts) {
  for (const char* line :
       {"#define TIMER0_TIM34 0x01C21414u\n", "#define TIMER0_TGCR_TIM34RS 0x00000002u\n",
        "#define SYSTEM_PINMUX(n) (0x01C40000u + 4u * (n))\n",
        "#define PSC_MDCTL(n) (0x01C41A00u + 4u * (n))\n", "#define PLL2_PLLM 0x01C40D10u\n",
        "#define PLL1_PLLDIV4 0x01C40960u\n", "#define SYSTEM_VTPIOCR_CLRZ 0x00002000u\n",
        "#define DDR_SDRCR 0x2000000Cu\n", "#define LPSC_UART0 19u\n", "#define LPSC_VPSS 47u\n",
        "#define IRQ_UART0 40u\n", "#define IRQ_TIMER0_TINT34 33u\n",
        "#define IRQ_VPSS_VPSSINT8 8u\n", "#define VENC_VSTAT 0x01C71EB8u\n"})
    EXPECT_THAT(text().registers_h, HasSubstr(line));
}

// The same for the page, once for each kind of row.
TEST(PlatformText, PageHasBlocksGapsAndMasters) {
  for (const char* line :
       {"\n| `edma` | EDMA3 channel controller | 0x01C00000 | 0x10000 | fast | SYSCLK4 | 0 | ccint0 16, ccerrint 17 "
        "(second) | ",
        "\n| `timer2` | TIMER2 (watchdog) | 0x01C21C00 | 0x400 | slow | AUXCLK | – | tint12 13 (second), tint34 14 | ",
        "\n| 0x01D11000 | 0x800 | MMCSD0 |\n",
        "\n| 6 | `vpfe` | `vpfe` | video | BCR.WR_PRI | 32 | – | yes | a block |\n"})
    EXPECT_THAT(text().blocks_md, HasSubstr(line));
}

}  // namespace
}  // namespace fovea::soc

FOVEA_SC_TEST_MAIN
