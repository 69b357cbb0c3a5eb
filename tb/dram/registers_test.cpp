// From the words that boot code writes to the time of a command: each field changes what it should.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/mem/ddr_decode.h"
#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

using mem::Cmd;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
constexpr std::uint32_t kSdbcr = 0x08, kSdrcr = 0x0C, kSdtimr = 0x10, kSdtimr2 = 0x14,
                        kPbbpr = 0x20, kDdrphycr = 0xE4,
                        kSdbcr2 = 0x1C;

/// The words of a shipped DM368 board (U-Boot, configs/cam_enc_4xx.h), field by field.
struct Words {
  std::uint32_t sdbcr = 0x0053'4A32;  // 8 banks, 1024-word page, CL 5, 16 bit
  std::uint32_t sdrcr = 0x768;
  std::uint32_t sdtimr =
      66u << 25 | 4u << 22 | 4u << 19 | 5u << 16 | 14u << 11 | 19u << 6 | 2u << 3 | 2u;
  std::uint32_t sdtimr2 = 8u << 27 | 2u << 25 | 69u << 16 | 199u << 8 | 2u << 5 | 2u;
  std::uint32_t pbbpr = 0xFE, ddrphycr = 0xC7, sdbcr2 = 0;
};

void write(mem::DdrRegs& regs, const Words& w) {
  const std::pair<std::uint32_t, std::uint32_t> writes[] = {
      {kSdbcr, w.sdbcr},     {kSdrcr, w.sdrcr}, {kSdtimr, w.sdtimr},
      {kSdtimr2, w.sdtimr2}, {kPbbpr, w.pbbpr}, {kDdrphycr, w.ddrphycr},
      {kSdbcr2, w.sdbcr2}};
  for (const auto& [offset, value] : writes)
    EXPECT_EQ(regs.write(offset, 4, value), Access::kOk) << offset;
}
// Only PBBPR's value after reset is public; of any other that is not 0 its description says that it is assumed.
TEST(RegisterTest, ResetValuesWithoutASourceAreSaidToBeAssumed) {
  const mem::DdrRegs regs;
  std::size_t assumed = 0;
  for (const Reg* r : regs.regs()) {
    const bool said = r->sentence().find("reset value assumed") != std::string::npos;
    EXPECT_EQ(said, r->reset_value() != 0 && r->name() != "PBBPR" && r->offset() > 4) << r->name();
    assumed += said;
  }
  EXPECT_EQ(assumed, 5u);
}

mem::DdrConfig decoded(const Words& w) {
  mem::DdrRegs regs;
  write(regs, w);
  return mem::decode(regs);
}
/// What is said about these words with this part.
std::vector<std::string> invalid_register_values(const Words& w, const char* part = "mt47h64m16") {
  mem::DdrRegs regs;
  write(regs, w);
  mem::DdrParams params;
  params.part.set(part);
  return mem::invalid_register_values(regs, params);
}

/// Two refreshes apart at least, and time for a row to be closed, refreshed, opened and used.
TEST(DdrRegistersTest, ARefreshIntervalLeavesRequestsTheirTurn) {
  const auto interval = [](unsigned rate, unsigned nRFC, unsigned nRC, unsigned ibank) {
    Words w;
    w.sdbcr = (w.sdbcr & ~0x70u) | ibank << 4;
    w.sdrcr = rate;
    w.sdtimr = (nRFC - 1) << 25 | 4u << 22 | 4u << 19 | 5u << 16 | 14u << 11 | (nRC - 1) << 6 | 2u << 3 | 2u;
    return decoded(w).refresh_interval;
  };
  // nRAS 15, nRP 5 and with 8 banks one more, nRFC 10; then nRRD 3, nRCD 5 and 2.
  EXPECT_EQ(interval(1, 10, 20, 3), 41u);
  EXPECT_EQ(interval(41, 10, 20, 3), 41u);
  EXPECT_EQ(interval(42, 10, 20, 3), 42u);
  EXPECT_EQ(interval(1, 10, 20, 2), 40u) << "four banks";
  EXPECT_EQ(interval(1, 10, 31, 3), 41u);
  EXPECT_EQ(interval(1, 10, 32, 3), 42u) << "nRC is longer";
  EXPECT_EQ(interval(1, 42, 20, 3), 84u) << "two refreshes";
  EXPECT_EQ(interval(0, 10, 20, 3), 0u) << "no refreshes are wanted";
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
  EXPECT_EQ(c.row_intervals, 9u);
  EXPECT_EQ(c.refreshed_log2, 0u);
  EXPECT_THAT(invalid_register_values({}), IsEmpty());
}

/// The words with a field of a register set to `value`.
Words with(std::uint32_t Words::*word, unsigned lsb, unsigned width, std::uint32_t value,
           Words w = {}) {
  const std::uint32_t mask = ((1u << width) - 1u) << lsb;
  w.*word = (w.*word & ~mask) | value << lsb;
  return w;
}

TEST(DdrRegistersTest, ReservedValuesAreNamedAndTakenAsOthers) {
  for (unsigned cl = 0; cl < 8; ++cl) {
    const Words w = with(&Words::sdbcr, 9, 3, cl);
    const bool reserved = cl < 2 || cl > 5;
    EXPECT_EQ(decoded(w).timing.CL, reserved ? 5 : cl);
    if (reserved) {
      EXPECT_THAT(invalid_register_values(w), ElementsAre("SDBCR CL = " + std::to_string(cl) +
                                           " is reserved; taken as 5"));
    } else {
      EXPECT_THAT(invalid_register_values(w), IsEmpty()) << cl;
    }
  }
  for (unsigned n = 0; n < 8; ++n) {
    const Words banks = with(&Words::sdbcr, 4, 3, n), page = with(&Words::sdbcr, 0, 3, n);
    EXPECT_EQ(decoded(banks).timing.banks, n > 3 ? 8u : 1u << n);
    EXPECT_EQ(decoded(page).page_log2, n > 3 ? 12u : 9 + n);
    const std::string value = std::to_string(n);
    if (n > 3) {
      EXPECT_THAT(invalid_register_values(banks),
                  ElementsAre("SDBCR IBANK = " + value + " is reserved; taken as 3, 8 banks"));
      EXPECT_THAT(invalid_register_values(page),
                  Contains("SDBCR PAGESIZE = " + value + " is reserved; taken as 3, 2048 words"));
    }
  }
}

TEST(DdrRegistersTest, NonsenseOfSdbcrIsNamed) {
  EXPECT_THAT(invalid_register_values(with(&Words::sdbcr, 14, 1, 0)),
              ElementsAre("SDBCR NM = 0: a 32-bit bus, but the chip has 16 bits; taken as 16"));
  EXPECT_THAT(invalid_register_values(with(&Words::sdbcr, 20, 1, 0)),
              ElementsAre(HasSubstr("SDBCR DDR2EN = 0: not the type of ddr.part = mt47h64m16")));
  EXPECT_THAT(invalid_register_values(with(&Words::sdbcr, 17, 1, 0)), ElementsAre(HasSubstr("SDBCR DDREN = 0")));
  EXPECT_THAT(invalid_register_values(with(&Words::sdbcr, 25, 1, 1)),
              ElementsAre("SDBCR MSDRAMEN = 1, but ddr.part = mt47h64m16 is DDR2; timed as "
                          "programmed"));
  EXPECT_THAT(invalid_register_values(with(&Words::sdbcr, 4, 3, 2), "mt46h64m16lf"),
              ElementsAre("SDBCR MSDRAMEN = 0, but ddr.part = mt46h64m16lf is mobile DDR; timed as "
                          "programmed"));
  EXPECT_THAT(invalid_register_values(with(&Words::sdbcr, 4, 3, 2)),
              ElementsAre(HasSubstr("SDBCR IBANK: 4 banks, but ddr.part = mt47h64m16 has 8")));
  EXPECT_THAT(invalid_register_values({}, "mt47h32m16"), ElementsAre(HasSubstr("8 banks, but ddr.part = mt47h32m16 "
                                                                "has 4")));
  EXPECT_THAT(invalid_register_values(with(&Words::sdbcr, 0, 3, 1)),
              ElementsAre(HasSubstr("SDBCR PAGESIZE: rows of 512 words, but ddr.part = mt47h64m16")));
}

TEST(DdrRegistersTest, RowsOfTheOtherAddressMapComeFromThePart) {
  // 8192 rows: 13 address bits are ROWSIZE 4. The part of 256 MiB has 16384.
  for (unsigned size = 0; size < 8; ++size) {
    Words w = with(&Words::sdbcr, 26, 1, 1);
    w.sdbcr2 = size;
    EXPECT_EQ(invalid_register_values(w).empty(), size == 4) << size;
    EXPECT_EQ(invalid_register_values(w, "mt47h128m16").empty(), size == 5) << size;
    w.sdbcr = Words{}.sdbcr;
    EXPECT_THAT(invalid_register_values(w), IsEmpty()) << "not looked at without IBANK_POS";
  }
  Words w = with(&Words::sdbcr, 26, 1, 1);
  EXPECT_THAT(invalid_register_values(w), ElementsAre("SDBCR2 ROWSIZE = 0 with IBANK_POS, but ddr.part = "
                                       "mt47h64m16 has 13 row address bits; taken as 4"));
}

TEST(DdrRegistersTest, PartialArrayOfMobilePartsOnly) {
  constexpr unsigned kKept[] = {0, 1, 2, 0, 0, 3, 4, 0};  // log2; 3, 4, 7 are reserved
  Words mobile = with(&Words::sdbcr, 25, 1, 1);
  mobile = with(&Words::sdbcr, 4, 3, 2, mobile);
  mobile = with(&Words::sdbcr, 20, 1, 0, mobile);
  EXPECT_THAT(invalid_register_values(mobile, "mt46h64m16lf"), IsEmpty());
  for (unsigned pasr = 0; pasr < 8; ++pasr) {
    mobile.sdbcr2 = pasr << 16;
    const bool reserved = pasr == 3 || pasr == 4 || pasr == 7;
    EXPECT_EQ(decoded(mobile).refreshed_log2, kKept[pasr]) << pasr;
    EXPECT_EQ(invalid_register_values(mobile, "mt46h64m16lf").size(), reserved ? 1u : 0u) << pasr;
    Words w;
    w.sdbcr2 = pasr << 16;
    EXPECT_EQ(decoded(w).refreshed_log2, 0u);
    if (pasr) {
      EXPECT_THAT(invalid_register_values(w), Contains(HasSubstr("without MSDRAMEN; all banks are refreshed")));
    }
  }
}

TEST(DdrRegistersTest, TimesThatContradictEachOtherAreNamed) {
  const auto ras = [](unsigned n) { return with(&Words::sdtimr, 11, 5, n); };
  EXPECT_THAT(invalid_register_values(ras(4)), IsEmpty()) << "T_RCD is 4";
  EXPECT_THAT(invalid_register_values(ras(3)), ElementsAre(HasSubstr("SDTIMR T_RAS below T_RCD")));
  EXPECT_THAT(invalid_register_values(ras(18)), IsEmpty()) << "T_RC is 19";
  EXPECT_THAT(invalid_register_values(ras(19)), ElementsAre(HasSubstr("SDTIMR T_RC not above T_RAS")));
  const auto rfc = [](unsigned n) { return with(&Words::sdtimr, 25, 7, n); };
  EXPECT_THAT(invalid_register_values(rfc(5)), IsEmpty()) << "T_RP is 4";
  EXPECT_THAT(invalid_register_values(rfc(4)), ElementsAre(HasSubstr("SDTIMR T_RFC not above T_RP")));
  Words sleep = with(&Words::sdrcr, 31, 1, 1);
  EXPECT_THAT(invalid_register_values(with(&Words::sdtimr2, 8, 8, 69, sleep)), IsEmpty()) << "T_XSNR is 69";
  EXPECT_THAT(invalid_register_values(with(&Words::sdtimr2, 8, 8, 68, sleep)),
              ElementsAre(HasSubstr("SDTIMR2 T_XSRD below T_XSNR")));
}

// T_RFC is 67 clocks: two of them are the least that leaves time for anything else.
TEST(DdrRegistersTest, RefreshIntervalLeavesTimeForRequests) {
  const auto rr = [](unsigned n) { return with(&Words::sdrcr, 0, 16, n); };
  EXPECT_EQ(decoded(rr(134)).refresh_interval, 134u);
  EXPECT_THAT(invalid_register_values(rr(134)), IsEmpty());
  for (const unsigned n : {1u, 133u}) {
    EXPECT_EQ(decoded(rr(n)).refresh_interval, 134u);
    EXPECT_THAT(invalid_register_values(rr(n)), ElementsAre("SDRCR RR = " + std::to_string(n) +
                                             " leaves no time between refreshes of 67 clocks; taken "
                                             "as 134"));
  }
  EXPECT_EQ(decoded(rr(0)).refresh_interval, 0u);
  EXPECT_THAT(invalid_register_values(rr(0)), ElementsAre(HasSubstr("SDRCR RR = 0: the SDRAM is never refreshed")));
  // The least interval does leave it: a stream of reads ends.
  BenchOptions o;
  o.config = decoded(rr(1));
  DdrBench b(o);
  std::vector<Request> all(500);
  for (unsigned i = 0; i < all.size(); ++i) {
    all[i].address = i * 16;
    while (b.input_taken()) b.step();
    b.submit_at(all[i], std::max<Picoseconds>(b.now(), kTck));
  }
  b.drain();
  for (const Request& r : all) EXPECT_EQ(r.done, 1u);
  EXPECT_LT(b.now() / kTck, 500u * 4 * 12);
}

// A refresh that becomes urgent between each ACT and its column would let no request through: T_RAS, T_RP
// and T_RCD count beside T_RFC.
TEST(DdrRegistersTest, LeastRefreshIntervalLetsRequestsThroughWhateverTheTimes) {
  Rng rng(21);
  for (int n = 0; n < 300; ++n) {
    Words w = with(&Words::sdrcr, 0, 16, 1 + rng.below(130));
    w.sdtimr = static_cast<std::uint32_t>(rng.below(std::uint64_t{1} << 32));
    if (n % 2) w.sdtimr = (w.sdtimr & 0x01FF'FFFF) | static_cast<unsigned>(rng.below(32)) << 25;
    BenchOptions o;
    o.config = decoded(w);
    DdrBench b(o);
    b.keep_log = false;
    std::vector<Request> all(60);
    unsigned steps = 0;
    for (Request& r : all) {
      r.master = static_cast<Master>(rng.below(3));
      r.write = rng.below(3) == 0;
      r.bytes = 64;
      r.address = static_cast<std::uint32_t>(rng.below(1u << 14) * 64);
      while (b.input_taken() && ++steps < 100'000) b.step();
      ASSERT_FALSE(b.input_taken()) << std::hex << w.sdtimr << ", RR " << w.sdrcr;
      b.submit_at(r, std::max<Picoseconds>(b.now(), kTck));
    }
    while (b.ddr.next_decision() != kNever && ++steps < 100'000) b.step();
    ASSERT_EQ(b.ddr.next_decision(), kNever) << std::hex << w.sdtimr << ", RR " << w.sdrcr;
  }
}

TEST(DdrRegistersTest, ClockStopsInSelfRefreshOnly) {
  const auto sdrcr = [](unsigned lpmoden, unsigned mclkstopen, unsigned sr_pd) {
    Words w;
    w.sdrcr |= lpmoden << 31 | mclkstopen << 30 | sr_pd << 23;
    return w;
  };
  using enum mem::LowPower;
  EXPECT_EQ(decoded(sdrcr(0, 1, 0)).low_power, kOff);
  EXPECT_EQ(decoded(sdrcr(1, 0, 0)).low_power, kSelfRefresh);
  EXPECT_EQ(decoded(sdrcr(1, 1, 0)).low_power, kClockStop);
  EXPECT_EQ(decoded(sdrcr(1, 0, 1)).low_power, kPowerDown);
  EXPECT_EQ(decoded(sdrcr(1, 1, 1)).low_power, kPowerDown);
  EXPECT_THAT(invalid_register_values(sdrcr(0, 1, 0)), IsEmpty());
  EXPECT_THAT(invalid_register_values(sdrcr(1, 1, 0)), IsEmpty());
  EXPECT_THAT(invalid_register_values(sdrcr(1, 1, 1)),
              ElementsAre(HasSubstr("SDRCR MCLKSTOPEN with SR_PD: the clock must not stop")));
}

TEST(DdrRegistersTest, ReadLatencyBelowClIsNamed) {
  const auto rl = [](unsigned n) { return with(&Words::ddrphycr, 0, 3, n); };
  EXPECT_THAT(invalid_register_values(rl(5)), IsEmpty());
  EXPECT_THAT(invalid_register_values(rl(4)), ElementsAre("DDRPHYCR RL = 4 below CL = 5: read data would be "
                                           "missed; taken as CL"));
}

TEST(DdrRegistersTest, EveryOldCountIsAllowed) {
  for (const unsigned n : {0u, 1u, 0xFEu, 0xFFu}) {
    Words w;
    w.pbbpr = n;
    EXPECT_EQ(decoded(w).old_count, n);
    EXPECT_THAT(invalid_register_values(w), IsEmpty());
  }
}

TEST(DdrRegistersTest, RowsMayBeOpenForTheProgrammedIntervals) {
  for (const unsigned n : {0u, 7u, 15u})
    EXPECT_EQ(decoded(with(&Words::sdtimr2, 27, 4, n)).row_intervals, n + 1);
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
