// The driver of the EDMA against a recorder. Addresses and values are literals from SPRUEE4A and Linux
// drivers/dma/ti/edma.c.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "register_recorder.h"

extern "C" {
#include "sw/firmware/drivers/edma.h"

uint32_t mmio_read32(uint32_t address) { return RegisterRecorder::current()->read(address); }
void mmio_write32(uint32_t address, uint32_t value) {
  RegisterRecorder::current()->write(address, value);
}
}

namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using A = RegisterAccess;
constexpr std::uint32_t kCc = 0x01C00000;

TEST(EdmaTest, StartSwitchesOnTheFiveModulesAndLeavesNothingPending) {
  RegisterRecorder chip;
  chip.values[0x01C40038] = 0x13;  // MISC out of reset
  chip.on_write = [&](std::uint32_t address, std::uint32_t value) {
    if (address >= 0x01C41A00 && address < 0x01C41B00) chip.values[address - 0x200] = value & 0x1F;
  };
  edma_init();
  for (unsigned module = 0; module < 5; ++module)
    EXPECT_EQ(chip.values[0x01C41A00 + 4 * module], 3u) << module;
  EXPECT_EQ(chip.values[0x01C40038], 0x93u);  // TPTC1_BST
  EXPECT_EQ(chip.values[kCc + 0x280], 0x3210u);
  for (const std::uint32_t both : {kCc + 0x340, kCc + 0x2028, kCc + 0x2008, kCc + 0x2058,
                                   kCc + 0x2070, kCc + 0x308, kCc + 0x2040})
    for (const std::uint32_t address : {both, both + 4})
      EXPECT_THAT(chip.accesses, Contains(A{'w', address, ~0u})) << std::hex << address;
  EXPECT_THAT(chip.accesses, Contains(A{'w', kCc + 0x31C, 0x1000F}));
  for (const std::uint32_t quick : {kCc + 0x380, kCc + 0x2088, kCc + 0x2094, kCc + 0x314})
    EXPECT_THAT(chip.accesses, Contains(A{'w', quick, 0xFF})) << std::hex << quick;
  for (unsigned tc = 0; tc < 4; ++tc)
    EXPECT_THAT(chip.accesses, Contains(A{'w', 0x01C10128 + 0x400 * tc, 13})) << tc;
}

TEST(EdmaTest, AChannelsQueueIsOneFieldOfFourBits) {
  RegisterRecorder chip;
  chip.values[kCc + 0x240] = 0x33333333;
  chip.values[kCc + 0x25C] = 0;
  edma_map(0, 1);
  edma_map(7, 2);
  edma_map(63, 3);
  EXPECT_EQ(chip.values[kCc + 0x240], 0x23333331u);
  EXPECT_EQ(chip.values[kCc + 0x25C], 0x30000000u);
}

TEST(EdmaTest, AQuickChannelHasASetATriggerWordAndAQueue) {
  RegisterRecorder chip;
  chip.values[kCc + 0x260] = 0x33333333;
  edma_open_quick(7, 255, 3, 2);
  EXPECT_THAT(chip.writes(), ElementsAre(A{'w', kCc + 0x21C, 255u << 5 | 3 << 2},
                                         A{'w', kCc + 0x260, 0x23333333},
                                         A{'w', kCc + 0x208C, 0x80}));
  edma_close_quick();
  EXPECT_THAT(chip.accesses, Contains(A{'w', kCc + 0x2088, 0xFF}));
  EXPECT_THAT(chip.accesses, Contains(A{'w', kCc + 0x2094, 0xFF}));
}

TEST(EdmaTest, ASetIsEightWords) {
  RegisterRecorder chip;
  const edma_set_t set = {EDMA_AB_SYNC | EDMA_INTERRUPT | EDMA_CODE(63),
                          0x80001000,
                          EDMA_PAIR(192, 39),
                          0x10F00,
                          EDMA_PAIR(-1440, 192),
                          EDMA_PAIR(EDMA_LINK(255), 0),
                          EDMA_PAIR(1, -1),
                          7};
  edma_write_set(255, &set);
  const std::uint32_t at = kCc + 0x4000 + 32 * 255;
  EXPECT_THAT(chip.accesses,
              ElementsAre(A{'w', at, 1u << 20 | 63u << 12 | 4}, A{'w', at + 4, 0x80001000},
                          A{'w', at + 8, 39u << 16 | 192}, A{'w', at + 12, 0x10F00},
                          A{'w', at + 16, 192u << 16 | 0xFA60}, A{'w', at + 20, 0x5FE0},
                          A{'w', at + 24, 0xFFFF0001}, A{'w', at + 28, 7}));
}

TEST(EdmaTest, ChannelsAndCodesOfBothHalves) {
  RegisterRecorder chip;
  edma_start(31);
  edma_start(32);
  edma_clear(31);
  edma_clear(63);
  edma_open_interrupt(33);
  EXPECT_THAT(chip.accesses,
              ElementsAre(A{'w', kCc + 0x2010, 1u << 31}, A{'w', kCc + 0x2014, 1},
                          A{'w', kCc + 0x2070, 1u << 31}, A{'w', kCc + 0x2074, 1u << 31},
                          A{'w', kCc + 0x2064, 2}));
  chip.values[kCc + 0x2068] = 0x80000000;
  chip.values[kCc + 0x206C] = 1;
  EXPECT_TRUE(edma_done(31));
  EXPECT_TRUE(edma_done(32));
  EXPECT_FALSE(edma_done(30));
  EXPECT_FALSE(edma_done(33));
}

TEST(EdmaTest, WaitingEndsWithTheCodeOrTheLastLook) {
  RegisterRecorder chip;
  unsigned looks = 0;
  chip.on_read = [&](std::uint32_t address) {
    if (address != kCc + 0x2068) return 0u;
    return ++looks == 3 ? 1u << 5 : 0u;
  };
  EXPECT_FALSE(edma_wait(5, 2));
  EXPECT_THAT(chip.writes(), IsEmpty());
  EXPECT_TRUE(edma_wait(5, 1));
  EXPECT_THAT(chip.writes(), ElementsAre(A{'w', kCc + 0x2070, 1u << 5}));
}

TEST(EdmaTest, EachErrorHasItsBit) {
  RegisterRecorder chip;
  EXPECT_EQ(edma_errors(), 0u);
  const std::pair<std::uint32_t, std::uint32_t> kSources[] = {
      {kCc + 0x300, 1}, {kCc + 0x304, 1}, {kCc + 0x310, 1}, {kCc + 0x318, 2},   {0x01C10120, 0x10},
      {0x01C10520, 0x20}, {0x01C10920, 0x40}, {0x01C10D20, 0x80}};
  for (const auto& [address, error] : kSources) {
    chip.values[address] = 1u << 16;
    EXPECT_EQ(edma_errors(), error) << std::hex << address;
    chip.values[address] = 0;
  }
}

}  // namespace
