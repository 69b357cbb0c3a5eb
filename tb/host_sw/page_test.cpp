// The parameter page: its layout as documented, and what the firmware refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "model/common/check.h"
#include "model/contract/param_page.h"
#include "model/contract/switches.h"
#include "model/contract/words.h"
#include "sw/lens/lens.h"

namespace {

param_page_t good_page(unsigned cameras = 1) {
  param_page_t page{};
  page.clocks.pll1.multiplier = page.clocks.pll2.multiplier = 81;
  page.console.divisor = 13;
  std::fill(std::begin(page.priority), std::end(page.priority), std::uint8_t{PRIORITY_OF_RESET});
  page.camera_count = cameras;
  for (unsigned i = 0; i < cameras; ++i) lens_view_default(&page.camera[i].view);
  param_page_seal(&page);
  return page;
}

/// The checksum, computed apart from the library, over `bytes` bytes.
void sum_up(param_page_t& page) {
  page.checksum = 0;
  std::uint32_t sum = 0, word;
  for (std::size_t i = 0; i < std::min<std::size_t>(page.bytes, sizeof page); i += 4) {
    std::memcpy(&word, reinterpret_cast<const char*>(&page) + i, 4);
    sum += word;
  }
  page.checksum = 0 - sum;
}

param_page_result_t result(param_page_t page, bool summed = true) {
  if (summed) sum_up(page);
  return param_page_check(&page);
}

TEST(ParamPageTest, LayoutIsTheDocumentedOne) {
  EXPECT_EQ(sizeof(param_page_t), 9224u);
  EXPECT_EQ(offsetof(param_page_t, clocks.sdtimr), 60u);
  EXPECT_EQ(offsetof(param_page_t, priority), 80u);
  EXPECT_EQ(offsetof(param_page_t, tables), 112u);
  EXPECT_EQ(offsetof(param_page_t, watchdog_us), 132u);
  EXPECT_EQ(offsetof(param_page_t, camera[1]), 136u + 1136u);
  const param_page_t page = good_page();
  EXPECT_EQ(0, memcmp(&page.magic, "FOVA", 4));
  EXPECT_EQ(page.version, 5u);
  EXPECT_EQ(page.bytes, 1272u);
  EXPECT_EQ(good_page(8).bytes, sizeof(param_page_t));
}

TEST(ParamPageTest, ASealedPageIsAcceptedAndEachFlippedBitRefused) {
  param_page_t page = good_page(2);
  ASSERT_EQ(param_page_check(&page), PARAM_PAGE_OK);
  auto* bytes = reinterpret_cast<unsigned char*>(&page);
  for (unsigned i = 0; i < page.bytes; ++i)
    for (unsigned bit = 0; bit < 8; ++bit) {
      if (i >= 8 && i < 12) continue;  // the size: below
      bytes[i] ^= 1u << bit;
      EXPECT_NE(param_page_check(&page), PARAM_PAGE_OK) << "byte " << i << " bit " << bit;
      bytes[i] ^= 1u << bit;
    }
  EXPECT_EQ(param_page_check(&page), PARAM_PAGE_OK);
  bytes[page.bytes] ^= 1;  // behind it
  EXPECT_EQ(param_page_check(&page), PARAM_PAGE_OK);
}

TEST(ParamPageTest, TheChecksumIsOfTheBytesThatThePageHas) {
  param_page_t page = good_page(3), again = page;
  sum_up(again);
  EXPECT_EQ(page.checksum, again.checksum);
  page.camera[2].view.fov_deg = 10;
  EXPECT_EQ(result(page, false), PARAM_PAGE_BAD_CHECKSUM);
  EXPECT_EQ(result(page), PARAM_PAGE_OK);
}

TEST(ParamPageTest, WrongMagicVersionOrSizeIsRefusedThoughTheSumFits) {
  param_page_t page = good_page();
  page.magic ^= 1;
  EXPECT_EQ(result(page), PARAM_PAGE_BAD_MAGIC);
  for (const std::uint32_t version : {0u, 4u, 6u}) {
    page = good_page();
    page.version = version;
    EXPECT_EQ(result(page), PARAM_PAGE_BAD_VERSION);
  }
  for (const unsigned cameras : {1u, 2u, 8u}) {
    page = good_page(cameras);
    page.bytes -= 4;
    EXPECT_EQ(result(page), PARAM_PAGE_TOO_SMALL) << cameras;
    page.bytes += 8;
    EXPECT_EQ(result(page), PARAM_PAGE_TOO_LARGE) << cameras;
  }
  page = good_page();
  page.bytes = 16;
  EXPECT_EQ(result(page), PARAM_PAGE_TOO_SMALL) << "the camera count is not inside";
  page.bytes = 0xFFFF'FFFC;
  EXPECT_EQ(result(page, false), PARAM_PAGE_TOO_LARGE) << "nothing behind the page is read";
  page = good_page();
  page.camera_count = 0;
  EXPECT_EQ(result(page), PARAM_PAGE_BAD_CAMERAS);
  page.camera_count = 9;
  EXPECT_EQ(result(page), PARAM_PAGE_BAD_CAMERAS);
}

TEST(ParamPageTest, ClocksConsoleAndPrioritiesAtTheirLimits) {
  const auto with = [](auto change) {
    param_page_t page = good_page();
    change(page);
    return result(page);
  };
  EXPECT_EQ(with([](auto& p) { p.clocks.pll1.multiplier = 1023; }), PARAM_PAGE_OK);
  EXPECT_EQ(with([](auto& p) { p.clocks.pll1.multiplier = 1024; }), PARAM_PAGE_BAD_CLOCKS);
  EXPECT_EQ(with([](auto& p) { p.clocks.pll2.multiplier = 0; }), PARAM_PAGE_BAD_CLOCKS);
  EXPECT_EQ(with([](auto& p) { p.clocks.pll2.pre_divider = 31; }), PARAM_PAGE_OK);
  EXPECT_EQ(with([](auto& p) { p.clocks.pll2.pre_divider = 32; }), PARAM_PAGE_BAD_CLOCKS);
  EXPECT_EQ(with([](auto& p) { p.clocks.pll1.post_divider = 32; }), PARAM_PAGE_BAD_CLOCKS);
  EXPECT_EQ(with([](auto& p) { p.clocks.pll1.dividers[0] = 31; }), PARAM_PAGE_OK);
  EXPECT_EQ(with([](auto& p) { p.clocks.pll1.dividers[0] = 32; }), PARAM_PAGE_BAD_CLOCKS);
  EXPECT_EQ(with([](auto& p) { p.clocks.pll1.dividers[8] = 31; }), PARAM_PAGE_OK);
  EXPECT_EQ(with([](auto& p) { p.clocks.pll1.dividers[8] = 32; }), PARAM_PAGE_BAD_CLOCKS);
  EXPECT_EQ(with([](auto& p) { p.console.uart = 1; }), PARAM_PAGE_BAD_CONSOLE);
  EXPECT_EQ(with([](auto& p) { p.console.divisor = 0; }), PARAM_PAGE_BAD_CONSOLE);
  EXPECT_EQ(with([](auto& p) { p.console.divisor = 0xFFFF; }), PARAM_PAGE_OK);
  EXPECT_EQ(with([](auto& p) { p.console.divisor = 0x10000; }), PARAM_PAGE_BAD_CONSOLE);
  EXPECT_EQ(with([](auto& p) { p.priority[15] = 7; }), PARAM_PAGE_OK);
  EXPECT_EQ(with([](auto& p) { p.priority[15] = 8; }), PARAM_PAGE_BAD_PRIORITY);
  EXPECT_EQ(with([](auto& p) { p.priority[0] = 254; }), PARAM_PAGE_BAD_PRIORITY);
}

TEST(ParamPageTest, EachResultHasItsOwnSentence) {
  std::set<std::string> seen;
  for (int r = 0; r < PARAM_PAGE_RESULTS; ++r)
    seen.insert(param_page_text(static_cast<param_page_result_t>(r)));
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(PARAM_PAGE_RESULTS));
  EXPECT_EQ(seen.count("unknown"), 0u);
}

// The words of an experiment stand for the codes of the documentation, whatever their order.
TEST(ParamPageTest, WordsHaveTheDocumentedCodes) {
  using namespace fovea::contract;
  EXPECT_EQ(code_of(kKernels, "plain"), 0u);
  EXPECT_EQ(code_of(kKernels, "ldm"), 1u);
  EXPECT_EQ(code_of(kFlows, "serial"), 1u);
  EXPECT_EQ(code_of(kPairMethods, "B"), 1u);
  EXPECT_EQ(code_of(kMappings, "none"), 0u);
  EXPECT_EQ(code_of(kMappings, "equisolid"), 4u);
  EXPECT_EQ(code_of(kMappings, "kannala_brandt"), 6u);
  EXPECT_EQ(code_of(kMasterWords, "vpfe"), 5u);
  EXPECT_EQ(code_of(kKernels, "simd"), ~0u);
  constexpr std::array turned = {Word{"ldm", 1}, Word{"plain", 0}};
  static_assert(code_of(turned, "plain") == 0 && code_of(turned, "ldm") == 1);
}

TEST(SwitchesTest, FieldsDoNotOverlapAndFillFifteenSwitches) {
  const std::uint32_t fields[] = {
      SWITCH_PUT(SWITCH_STANDARD_IN, ~0u), SWITCH_PUT(SWITCH_STANDARD_OUT, ~0u),
      SWITCH_PUT(SWITCH_SIZE_IN, ~0u),     SWITCH_PUT(SWITCH_SIZE_OUT, ~0u),
      SWITCH_PUT(SWITCH_MAPPING, ~0u),     SWITCH_PUT(SWITCH_SHIFT_X, ~0u),
      SWITCH_PUT(SWITCH_SHIFT_Y, ~0u)};
  std::uint32_t all = 0;
  for (const std::uint32_t f : fields) {
    EXPECT_EQ(all & f, 0u);
    all |= f;
  }
  EXPECT_EQ(all, 0x7FFFu);
  EXPECT_EQ(SWITCH_GET(0x7FFFu & ~SWITCH_PUT(SWITCH_MAPPING, 2), SWITCH_MAPPING), 5u);
}

}  // namespace
