// The firmware's register header and the page of blocks are what the declarations say.
#include "model/soc/platform_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

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
       {"\n| `edma` | EDMA3 channel controller | 0x01C00000 | 0x10000 | fast | SYSCLK4 | 0 | ccint0 16, ccerrint 17 (second) | ",
        "\n| `timer2` | TIMER2 (watchdog) | 0x01C21C00 | 0x400 | slow | AUXCLK | – | tint12 13 (second), tint34 14 | ",
        "\n| 0x01D11000 | 0x800 | MMCSD0 |\n",
        "\n| 6 | `vpfe` | `vpfe` | video | BCR.WR_PRI | 32 | – | yes | a block |\n"})
    EXPECT_THAT(text().blocks_md, HasSubstr(line));
}

}  // namespace
}  // namespace fovea::soc

FOVEA_SC_TEST_MAIN
