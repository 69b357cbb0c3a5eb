// From the words that boot code writes to the time of a command: each field changes what it should.
#include <gtest/gtest.h>

#include "model/mem/ddr_decode.h"
#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

using mem::Cmd;
constexpr std::uint32_t kSdbcr = 0x08, kSdrcr = 0x0C, kSdtimr = 0x10, kSdtimr2 = 0x14,
                        kPbbpr = 0x20, kDdrphycr = 0xE4;

/// The words of a shipped DM368 board (dram.md 3, last table), field by field as the manual has
/// them.
struct Words {
  std::uint32_t sdbcr = 0x0053'4A32;  // 8 banks, 1024-word page, CL 5, 16 bit
  std::uint32_t sdrcr = 0x768;
  std::uint32_t sdtimr =
      66u << 25 | 4u << 22 | 4u << 19 | 5u << 16 | 14u << 11 | 19u << 6 | 2u << 3 | 2u;
  std::uint32_t sdtimr2 = 8u << 27 | 2u << 25 | 69u << 16 | 199u << 8 | 2u << 5 | 2u;
  std::uint32_t pbbpr = 0xFE, ddrphycr = 0xC7;
};

mem::DdrConfig decoded(const Words& w) {
  mem::DdrRegs regs;
  const std::pair<std::uint32_t, std::uint32_t> writes[] = {
      {kSdbcr, w.sdbcr},     {kSdrcr, w.sdrcr}, {kSdtimr, w.sdtimr},
      {kSdtimr2, w.sdtimr2}, {kPbbpr, w.pbbpr}, {kDdrphycr, w.ddrphycr}};
  for (const auto& [offset, value] : writes)
    EXPECT_EQ(regs.write(offset, 4, value), Access::kOk) << offset;
  return mem::decode(regs);
}

TEST(DdrRegistersTest, ShippedWordsMeanTheirClocks) {
  const mem::DdrConfig c = decoded({});
  const mem::DdrTiming& t = c.timing;
  EXPECT_EQ(t.CL, 5u);
  EXPECT_EQ(t.banks, 8u);
  EXPECT_FALSE(t.mobile);
  EXPECT_EQ(t.nRFC, 67u);
  EXPECT_EQ(t.nRP, 5u);
  EXPECT_EQ(t.nRCD, 5u);
  EXPECT_EQ(t.nWR, 6u);
  EXPECT_EQ(t.nRAS, 15u);
  EXPECT_EQ(t.nRC, 20u);
  EXPECT_EQ(t.nRRD, 3u);
  EXPECT_EQ(t.nWTR, 3u);
  EXPECT_EQ(t.nRTP, 3u);
  EXPECT_EQ(t.nXP, 3u);
  EXPECT_EQ(t.nXSNR, 70u);
  EXPECT_EQ(t.nXSRD, 200u);
  EXPECT_EQ(t.nCKE, 3u);
  EXPECT_EQ(c.read_latency, 7u);
  EXPECT_EQ(c.refresh_interval, 1896u);
  EXPECT_EQ(c.old_count, 0xFEu);
  EXPECT_EQ(c.page_log2, 11u);
  EXPECT_FALSE(c.bank_on_top);
  EXPECT_EQ(c.low_power, mem::LowPower::kOff);
}

/// Clock of the first command of this kind for a read that an idle controller sees at clock 501.
std::uint64_t first(const Words& w, Cmd cmd) {
  BenchOptions o;
  o.config = decoded(w);
  o.params = {{"request_latency", "0 cycles"}};
  DdrBench b(o);
  Request r;
  r.address = at(1, 0);
  EXPECT_TRUE(b.submit(r, 500));
  b.drain();
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  return b.clock_of(cmd);
}

TEST(DdrRegistersTest, LowPowerBitsCostTheirExit) {
  Words w;
  EXPECT_EQ(first(w, Cmd::kAct), 501u);
  w.sdrcr |= 1u << 23;
  EXPECT_EQ(first(w, Cmd::kAct), 501u) << "SR_PD alone does nothing";
  w.sdrcr |= 1u << 31;
  EXPECT_EQ(first(w, Cmd::kAct), 501u + 3) << "power-down: T_XP + 1";
  w.sdtimr2 += 1u << 25;
  EXPECT_EQ(first(w, Cmd::kAct), 501u + 4);
  w.sdrcr &= ~(1u << 23);
  EXPECT_EQ(first(w, Cmd::kAct), 501u + 70) << "self-refresh: T_XSNR + 1";
  w.sdtimr2 += 5u << 16;
  EXPECT_EQ(first(w, Cmd::kAct), 501u + 75);
  EXPECT_EQ(first(w, Cmd::kRd), 501u + 200) << "T_XSRD + 1";
  w.sdtimr2 += 9u << 8;
  EXPECT_EQ(first(w, Cmd::kRd), 501u + 209);
}

TEST(DdrRegistersTest, MobilePartsWriteEarlier) {
  const auto turnaround = [](const Words& w) {
    BenchOptions o;
    o.config = decoded(w);
    DdrBench b(o);
    Request one, two;
    one.write = true;
    one.address = two.address = at(1, 0, 0, o.config.timing.banks);
    two.master = Master::kArmD;
    b.submit(one, 100);
    b.submit(two, 101 + 5);  // ready when the write has its column
    b.drain();
    EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
    return b.clock_of(Cmd::kRd) - b.clock_of(Cmd::kWr);
  };
  Words w;
  w.sdbcr = (w.sdbcr & ~0x70u) | 2u << 4;  // 4 banks
  EXPECT_EQ(turnaround(w), 4u + 4 + 3) << "WL + BL/2 + tWTR, WL = CL - 1";
  w.sdbcr |= 1u << 25;  // MSDRAMEN
  EXPECT_EQ(turnaround(w), 1u + 4 + 3) << "WL = 1";
}

}  // namespace
}  // namespace fovea::dram
