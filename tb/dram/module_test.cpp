// Crossbar and DDR controller as modules, with the kernel between them: whatever moves the
// controller's next decision must reach the crossbar's process, which waits for it.
#include <gtest/gtest.h>

#include <systemc>

#include "model/bus/config_bus.h"
#include "model/bus/scr.h"
#include "model/common/burst_master.h"
#include "model/common/end_of_instant.h"
#include "model/mem/ddr_module.h"
#include "tb/own_diagnostics.h"

namespace fovea::dram {
namespace {

constexpr std::uint32_t kDdr = 0x8000'0000;
constexpr Frequency kFast(243'000'000), kSlow(1'000'000);

struct SlowRegs : RegBank {
  Reg value{*this, "VALUE", 0, Mode::kRw, "any"};
  SlowRegs() : RegBank("SLOW") {}
};
struct SlowBlock : WithRegs<SlowRegs>, BusTarget {
  explicit SlowBlock(sc_core::sc_module_name name) : BusTarget(name, regs) {}
};

struct Bench {
  OwnDiagnostics diagnostics;
  bus::CrossbarParams xbar_params;
  bus::ConfigBusParams config_params;
  mem::DdrParams ddr_params;
  EndOfInstant end_of_instant{"end_of_instant"};
  bus::Scr scr{"scr", xbar_params, ddr_params, {}, false};
  bus::ConfigBus config{"config",
                        config_params,
                        end_of_instant,
                        {{"ddr", 0x2000'0000, 0x8000, bus::ConfigBus::Speed::kFast},
                         {"slow", 0x01C2'0000, 0x100, bus::ConfigBus::Speed::kSlow}}};
  mem::DdrModule ddr{"ddr", ddr_params, scr.memory()};
  SlowBlock slow{"slow_block"};
  BurstMaster master{"master", Master::kLoad, 4}, other{"other", Master::kVpbe, 4};
  ClockSignal ddr_clk{"ddr_clk", kFast}, scr_clk{"scr_clk", Frequency(121'500'000)};
  sc_core::sc_signal<bool> on{"on", true};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority{"priority", kMasterCount};
  struct Done {
    Picoseconds seen, first, last;
    bool error;
  };
  std::vector<Done> done;

  Bench() {
    scr.clk(scr_clk);
    scr.config_socket.bind(config.socket);
    ddr.ddr_clk(ddr_clk);
    ddr.scr_clk(scr_clk);
    ddr.enabled(on);
    config.to("ddr").bind(ddr.reg_socket);
    config.to("slow").bind(slow.reg_socket);
    for (std::size_t i = 0; i < kMasterCount; ++i) scr.priority[i](priority[i]);
    master.socket.bind(*scr.target[index(Master::kLoad)]);
    other.socket.bind(*scr.target[index(Master::kVpbe)]);
    master.on_done = [this](const BurstMaster::Completion& c) {
      done.push_back({kernel_time(), c.first, c.last, c.error});
    };
    ddr.regs.write(0x0C, 4, 1895);
    ddr.regs.write(0x08, 4, 0x00D34A32);  // BOOTUNLOCK, for the type of the part
    ddr.regs.write(0x08, 4, 0x00534A32);
  }
};
Bench* bench = nullptr;

class ModuleTest : public testing::Test {
 protected:
  Bench& b = *bench;
  void SetUp() override {
    b.ddr_clk.write(kFast);
    b.scr_clk.write(Frequency(121'500'000));
    run_for(10 * kPsPerUs);
    b.done.clear();
  }
  /// The end is a kernel event, so that the path does not run past it.
  void run_for(Picoseconds t) {
    end_.at(kernel_time() + t);
    sc_core::sc_start(ps_time(t));
  }
  Picoseconds read_alone(std::uint32_t address, unsigned bytes);
  Timer end_;
};

TEST_F(ModuleTest, RequestQueuedWhenTheSdramClockStopsIsServedAfterItsRestart) {
  b.ddr_clk.write(kSlow);
  run_for(5 * kPsPerUs);
  b.master.read(kDdr, 64);
  run_for(2 * kPsPerUs);
  ASSERT_TRUE(b.done.empty());
  b.ddr_clk.write(Frequency());
  run_for(50 * kPsPerUs);
  ASSERT_TRUE(b.done.empty());
  b.ddr_clk.write(kFast);
  run_for(10 * kPsPerUs);
  ASSERT_EQ(b.done.size(), 1u);
  EXPECT_FALSE(b.done[0].error);
  EXPECT_EQ(b.done[0].seen, b.done[0].last);
}

TEST_F(ModuleTest, FasterSdramClockBringsTheNextDecisionForward) {
  b.ddr_clk.write(kSlow);
  run_for(5 * kPsPerUs);
  b.master.read(kDdr + 0x10000, 64);
  run_for(2 * kPsPerUs);
  ASSERT_TRUE(b.done.empty());
  b.ddr_clk.write(kFast);
  run_for(100 * kPsPerUs);
  ASSERT_EQ(b.done.size(), 1u);
  EXPECT_FALSE(b.done[0].error);
  EXPECT_EQ(b.done[0].seen, b.done[0].last) << "the outcome is reported at its last beat";
}

TEST_F(ModuleTest, RequestWhileTheSdramClockStandsEndsInABusError) {
  b.ddr_clk.write(Frequency());
  run_for(5 * kPsPerUs);
  b.master.read(kDdr, 64);
  run_for(5 * kPsPerUs);
  ASSERT_EQ(b.done.size(), 1u);
  EXPECT_TRUE(b.done[0].error);
}

// A refusal takes no time at the controller; the master sees it behind the data it asked for before.
TEST_F(ModuleTest, RefusedReadDoesNotOvertakeAnOlderOneOfItsMaster) {
  const std::uint32_t end = kDdr + (256u << 20);
  b.master.read(kDdr + 0x20000, 64);
  b.master.read(kDdr + 0x40000, 64);
  b.master.read(end, 64);
  b.master.read(end + 64, 64);
  run_for(10 * kPsPerUs);
  ASSERT_EQ(b.done.size(), 4u);
  for (unsigned i = 0; i < 4; ++i) {
    EXPECT_EQ(b.done[i].error, i >= 2) << i;
    EXPECT_EQ(b.done[i].seen, b.done[i].last);
    if (i > 0) {
      EXPECT_GE(b.done[i].first, b.done[i - 1].last) << i;
    }
  }
  EXPECT_GT(b.done[1].last - b.done[1].first, 0u);
}

TEST_F(ModuleTest, RefusedReadAloneEndsAtOnce) {
  b.master.read(kDdr + (256u << 20), 64);
  b.master.read(kDdr + 0x20000, 64);
  run_for(10 * kPsPerUs);
  ASSERT_EQ(b.done.size(), 2u);
  EXPECT_TRUE(b.done[0].error);
  EXPECT_FALSE(b.done[1].error);
  EXPECT_LT(b.done[0].last, b.done[1].first);
}

/// Time from the port to the first data of a read alone.
Picoseconds ModuleTest::read_alone(std::uint32_t address, unsigned bytes) {
  b.done.clear();
  const Picoseconds issued = kernel_time();
  b.master.read(address, bytes);
  run_for(20 * kPsPerUs);
  EXPECT_EQ(b.done.size(), 1u);
  EXPECT_FALSE(b.done.at(0).error);
  return b.done.at(0).first - issued;
}

// Registers of the auxiliary clock's domain answer later than others, by the difference of the two
// parameters, give or take an edge of the crossbar.
TEST_F(ModuleTest, SlowRegisterBlocksAnswerLaterThanFastOnes) {
  const Picoseconds edge = kPsPerSecond / 121'500'000;
  const Picoseconds fast = read_alone(0x2000'0004, 4), slow = read_alone(0x01C2'0000, 4);
  const Picoseconds more = b.config_params.slow_latency() - b.config_params.fast_latency();
  ASSERT_GT(more, 2 * edge);
  EXPECT_GE(slow, fast + more - edge);
  EXPECT_LE(slow, fast + more + edge);
}

// A timer tick of Linux waits 27 us for registers here and takes 63 to 112 us on the DM365 EVM (README of model/bus):
// the intervals of belief reach the factor that would be missing if all of its time went there.
TEST_F(ModuleTest, BeliefInRegisterLatenciesReachesTheTickOfTheEvm) {
  const auto high = [](const IntParam& p) {
    ParamGroup group("high");
    IntParam time(group, "time", IntParam::Unit::kTime, 1, 1, kPsPerSecond, "", Origin::kChoice, "");
    time.set(p.belief().high);
    return time();
  };
  const auto& p = b.config_params;
  EXPECT_GE(high(p.fast_latency), p.fast_latency() * 112 / 27);
  EXPECT_GE(high(p.slow_latency), p.slow_latency() * 112 / 27);
  for (const IntParam* each : {&p.fast_latency, &p.slow_latency})
    EXPECT_NE(each->belief().reason.find("63 to 112 us on the DM365 EVM"), std::string::npos);
}

// Of requests at one edge the port goes first whose priority signal is lower, as it is at that time.
TEST_F(ModuleTest, ThePrioritySignalsDecideAtTheCrossbar) {
  // Bridges of equal latency, so that both arrive at one edge.
  std::vector<Picoseconds> first(2);
  b.other.on_done = [&](const BurstMaster::Completion& c) { first[1] = c.first; };
  for (const unsigned urgent : {0u, 1u, 0u}) {
    b.priority[index(Master::kLoad)].write(urgent == 0 ? 2 : 5);
    b.priority[index(Master::kVpbe)].write(urgent == 0 ? 5 : 2);
    run_for(10 * kPsPerUs);
    b.done.clear();
    b.master.read(kDdr + 0x50000, 64);
    b.other.read(kDdr + 0x50040, 64);
    run_for(10 * kPsPerUs);
    ASSERT_EQ(b.done.size(), 1u);
    first[0] = b.done[0].first;
    EXPECT_LT(first[urgent], first[1 - urgent]) << urgent;
  }
  b.priority[index(Master::kLoad)].write(0);
  b.priority[index(Master::kVpbe)].write(0);
  run_for(10 * kPsPerUs);
}

// Latency is from the port to the first data, not to the last.
TEST_F(ModuleTest, LatencyStatisticsTakeTheFirstBeat) {
  bus::LatencyStats& stats = *b.scr.latency[stat_index(Master::kLoad)];
  stats.reset();
  const Picoseconds first = read_alone(kDdr + 0x30000, 64);
  const bus::LatencyHistogram latency = stats.read_first();
  EXPECT_GT(b.done.at(0).last, b.done.at(0).first) << "the two can be told apart";
  ASSERT_EQ(latency.count(), 1u);
  EXPECT_EQ(latency.min(), first);
  EXPECT_EQ(latency.max(), first);
}

/// Warnings that contain this text.
std::uint64_t warnings(const std::string& text) {
  std::uint64_t n = 0;
  for (const auto& [what, count] : bench->diagnostics.counts())
    if (what.second.find(text) != std::string::npos) n += count;
  return n;
}

// The row address bits above the part's are not connected: U-Boot's get_ram_size() writes at powers of
// two up to the largest size and finds the part's where a write comes back at the beginning.
TEST_F(ModuleTest, AddressesRepeatAtThePartsSizeUpToTheEndOfTheWindow) {
  b.diagnostics.clear();
  constexpr std::uint32_t kSize = 128u << 20, kAt = 0x12340;
  std::array<std::uint8_t, 64> bytes{};
  const auto round_trip = [&](std::uint32_t to, std::uint32_t from, std::uint8_t value) {
    b.done.clear();
    bytes.fill(value);
    b.master.write(to, bytes);
    run_for(5 * kPsPerUs);
    const std::uint8_t there = *b.ddr.store().at(from - kDdr);
    return b.done.size() == 1 && !b.done[0].error && there == value;
  };
  EXPECT_TRUE(round_trip(kDdr + kAt, kDdr + kAt, 1));
  EXPECT_EQ(warnings("it repeats from its beginning"), 0u);
  EXPECT_TRUE(round_trip(kDdr + kSize + kAt, kDdr + kAt, 2));
  EXPECT_TRUE(round_trip(kDdr + kSize, kDdr, 3));
  EXPECT_TRUE(round_trip(kDdr + 2 * kSize - 64, kDdr + kSize - 64, 4));
  EXPECT_TRUE(round_trip(kDdr + kSize - 64, kDdr + kSize - 64, 5));
  EXPECT_FALSE(round_trip(kDdr + 2 * kSize, kDdr, 6));
  EXPECT_EQ(warnings("access beyond the SDRAM's end (ddr.part, 128 MiB): it repeats from its beginning"),
            3u);
  EXPECT_EQ(warnings("access beyond the SDRAM's 256 MiB of the memory map"), 1u);
  // A read finds the row that the other address has opened.
  b.master.read(kDdr + kAt, 64);
  run_for(300 * kPsPerNs);
  const std::uint64_t hits = b.ddr.controller().stats.row_hits.count();
  b.master.read(kDdr + kSize + kAt, 64);
  run_for(5 * kPsPerUs);
  EXPECT_EQ(b.ddr.controller().stats.row_hits.count() - hits, 1u);
  // A debugger sees the same, up to the end of the part in one piece.
  MemRequest r;
  r.data = bytes.data();
  r.bytes = 64;
  r.address = kDdr + kSize + kAt;
  EXPECT_EQ(b.master.socket->transport_dbg(r), 64u);
  EXPECT_EQ(bytes[0], 2);
  r.address = kDdr + 2 * kSize - 16;
  EXPECT_EQ(b.master.socket->transport_dbg(r), 16u);
  r.address = kDdr + 2 * kSize;
  EXPECT_EQ(b.master.socket->transport_dbg(r), 0u);
}

// For whoever waits for it, as a synthetic load does: timing programmed and locked, power and clock on.
TEST_F(ModuleTest, SdramIsInitialisedWhenItsTimingIsLockedAndPowerAndClockAreOn) {
  auto& r = b.ddr.regs;
  const auto initialised = [&] {
    run_for(kPsPerNs);
    return b.ddr.initialised.read();
  };
  r.write(0x08, 4, 0x0053'CA32);
  EXPECT_FALSE(initialised()) << "TIMUNLOCK";
  r.write(0x08, 4, 0x00D3'4A32);
  EXPECT_FALSE(initialised()) << "BOOTUNLOCK";
  r.write(0x08, 4, 0x0053'4A32);
  EXPECT_TRUE(initialised());
  b.on.write(false);
  EXPECT_FALSE(initialised()) << "LPSC";
  b.on.write(true);
  EXPECT_TRUE(initialised());
  b.ddr_clk.write(Frequency());
  EXPECT_FALSE(initialised()) << "clock";
  b.ddr_clk.write(kFast);
  EXPECT_TRUE(initialised());
  for (const std::uint32_t word : {0x00D3'4A32u, 0x0052'4A32u}) r.write(0x08, 4, word);
  EXPECT_FALSE(initialised()) << "SDRAMEN";
  for (const std::uint32_t word : {0x00D2'4A32u, 0x0053'4A32u}) r.write(0x08, 4, word);
  EXPECT_TRUE(initialised());
}

// The registers hold their reset pattern but for SDRCR: all times are long, T_RC is not above T_RAS.
TEST_F(ModuleTest, ProgrammingIsLookedAtOnceWithTheFirstAccessAfterAChange) {
  b.diagnostics.clear();
  const auto write = [&](std::uint32_t offset, std::uint32_t value) {
    EXPECT_EQ(b.ddr.regs.write(offset, 4, value), Access::kOk);
  };
  const auto read_some = [&] {
    b.master.read(kDdr, 64);
    run_for(5 * kPsPerUs);
    b.master.read(kDdr + 64, 64);
    run_for(5 * kPsPerUs);
  };
  write(0x0C, 1896);
  EXPECT_EQ(b.diagnostics.counts().size(), 0u) << "others may be written still";
  read_some();
  EXPECT_EQ(warnings("SDRCR RR: 1896 clocks programmed, MT47H64M16-3 needs tREFI at most 7800 ns = "
                    "1895 at 243 MHz: 1 over"),
            1u);
  EXPECT_EQ(warnings("SDTIMR T_RC not above T_RAS"), 1u);
  write(0x0C, 1895);
  read_some();
  EXPECT_EQ(warnings("SDRCR"), 1u) << "no more of them";
  EXPECT_EQ(warnings("SDTIMR T_RC not above T_RAS"), 2u) << "once for each change";
  b.ddr_clk.write(Frequency(216'000'000));
  run_for(kPsPerUs);
  read_some();
  EXPECT_EQ(warnings("needs tREFI at most 7800 ns = 1684 at 216 MHz: 211 over"), 1u);
}

TEST_F(ModuleTest, SdramThatIsSwitchedOffAnswersWithABusErrorUntilItIsOnAgain) {
  b.diagnostics.clear();
  const auto read_fails = [&](std::uint32_t sdbcr) {
    for (const std::uint32_t word : {sdbcr | 1u << 23, sdbcr}) b.ddr.regs.write(0x08, 4, word);
    b.done.clear();
    b.master.read(kDdr, 64);
    run_for(5 * kPsPerUs);
    EXPECT_EQ(b.done.size(), 1u);
    return b.done.empty() || b.done[0].error;
  };
  EXPECT_TRUE(read_fails(0x0052'4A32)) << "SDRAMEN = 0";
  EXPECT_TRUE(read_fails(0x0053'CA32)) << "not locked yet";
  EXPECT_EQ(warnings("access to the SDRAM before its controller runs"), 2u);
  EXPECT_FALSE(read_fails(0x0053'4A32));
}

TEST_F(ModuleTest, TimingIsWrittenWithTimunlockOnly) {
  b.diagnostics.clear();
  auto& r = b.ddr.regs;
  const std::uint32_t was = r.sdtimr.get(), was2 = r.sdtimr2.get();
  r.write(0x10, 4, 0x12345678);
  r.write(0x14, 4, 0x02345678);
  EXPECT_EQ(r.sdtimr.get(), was);
  EXPECT_EQ(r.sdtimr2.get(), was2);
  EXPECT_EQ(warnings("SDTIMR written without SDBCR TIMUNLOCK: write lost"), 1u);
  EXPECT_EQ(warnings("SDTIMR2 written without SDBCR TIMUNLOCK: write lost"), 1u);
  r.write(0x08, 4, 0x0053CA32);
  r.write(0x10, 4, 0x12345678);
  r.write(0x14, 4, 0x02345678);
  EXPECT_EQ(r.sdtimr.get(), 0x12345678u);
  EXPECT_EQ(r.sdtimr2.get(), 0x02345678u);
  r.write(0x10, 4, was);
  r.write(0x14, 4, was2);
  r.write(0x08, 4, 0x00534A32);
  EXPECT_EQ(warnings("write lost"), 2u);
}

// TIMUNLOCK by the manual, BOOTUNLOCK by what the boot loader does; in the write or before it.
TEST_F(ModuleTest, LatencyIsWrittenWithAnUnlockBitOnly) {
  b.diagnostics.clear();
  auto& r = b.ddr.regs;
  const auto latency_after = [&](std::uint32_t sdbcr) {
    r.write(0x08, 4, sdbcr);
    std::uint32_t word = 0;
    EXPECT_EQ(r.read(0x08, 4, word), Access::kOk);
    EXPECT_EQ(b.ddr.programmed().timing.CL, word >> 9 & 7u);
    return word >> 9 & 7u;
  };
  const auto lost = [&] { return warnings("SDBCR CL written without TIMUNLOCK or BOOTUNLOCK"); };
  EXPECT_EQ(latency_after(0x0053'4A32), 5u);
  EXPECT_EQ(latency_after(0x0053'4832), 5u) << "4, locked";
  EXPECT_EQ(lost(), 1u);
  EXPECT_EQ(latency_after(0x0053'C832), 4u) << "TIMUNLOCK";
  EXPECT_EQ(latency_after(0x0053'4632), 3u) << "with the write that locks again";
  EXPECT_EQ(latency_after(0x0053'4832), 3u);
  EXPECT_EQ(lost(), 2u);
  EXPECT_EQ(latency_after(0x00D3'4832), 4u) << "BOOTUNLOCK";
  EXPECT_EQ(latency_after(0x0053'4A32), 5u);
  EXPECT_EQ(latency_after(0x0053'4A32), 5u) << "the same again is no change";
  EXPECT_EQ(lost(), 2u);
}

// The manuals' order is a write of BOOTUNLOCK and then the values with 0 in it; TI's boot loader writes them locked
// first.
TEST_F(ModuleTest, TypeIsWrittenBehindBootunlockOnly) {
  b.diagnostics.clear();
  auto& r = b.ddr.regs;
  const auto after = [&](std::uint32_t sdbcr) {
    r.write(0x08, 4, sdbcr);
    return r.sdbcr.get();
  };
  const auto told = [&](const char* text) {
    b.master.read(kDdr, 64);
    run_for(5 * kPsPerUs);
    return warnings(text);
  };
  constexpr std::uint32_t kAll = 0x1B7F'0000, kIs = 0x0053'0000;  // what it opens; as the bench leaves it
  constexpr const char* kLost = "written without BOOTUNLOCK in the write before: write lost";
  EXPECT_EQ(after(0x0053'4A32 ^ kAll), 0x0053'4A32u) << "locked";
  EXPECT_EQ(told(kLost), 1u);
  EXPECT_EQ(warnings("SDBCR type bits 0x1b7f0000 written without"), 1u);
  EXPECT_EQ(after((0x00D3'4A32 ^ kAll)), 0x00D3'4A32u) << "the write that unlocks it";
  EXPECT_EQ(after(0x0053'4A32 ^ kAll), (kIs ^ kAll) | 0x4A32u);
  EXPECT_EQ(after(0x0053'4A32), (kIs ^ kAll) | 0x4A32u) << "locked again";
  r.write(0x08, 4, 0x00D3'4A32 ^ kAll);
  EXPECT_EQ(after(0x0053'4A32), 0x0053'4A32u);
  EXPECT_EQ(told(kLost), 1u) << "nothing is lost in the end, as with the boot loader";
  // One byte at a time.
  r.write(0x0A, 1, 0xD3);
  r.write(0x0A, 1, 0x13);
  EXPECT_EQ(r.sdbcr.get(), 0x0013'4A32u);
  r.write(0x0A, 1, 0x53);
  EXPECT_EQ(r.sdbcr.get(), 0x0013'4A32u);
  for (const std::uint32_t word : {0x00D3'4A32u, 0x0053'4A32u}) r.write(0x08, 4, word);
}

// LPMODEN, then MCLKSTOPEN: PHYRDY goes low; an access brings the clock back.
TEST_F(ModuleTest, PhyIsNotReadyWhileTheMemorysClockStands) {
  auto& r = b.ddr.regs;
  const auto phy = [&] {
    std::uint32_t word = 0;
    EXPECT_EQ(r.read(0x04, 4, word), Access::kOk);
    return word >> 2 & 1u;
  };
  EXPECT_EQ(phy(), 1u);
  r.write(0x0C, 4, 1u << 31 | 1895);
  run_for(10 * kPsPerUs);
  EXPECT_EQ(phy(), 1u) << "self-refresh with the clock";
  r.write(0x0C, 4, 3u << 30 | 1895);
  run_for(kPsPerUs);
  EXPECT_EQ(phy(), 0u);
  b.master.read(kDdr, 64);
  run_for(600 * kPsPerNs);  // tXSRD is longer
  EXPECT_EQ(phy(), 1u);
  run_for(10 * kPsPerUs);
  EXPECT_EQ(b.done.size(), 1u);
  EXPECT_EQ(phy(), 0u) << "asleep again";
  b.diagnostics.clear();
  b.ddr_clk.write(Frequency());
  run_for(kPsPerMs);
  EXPECT_EQ(warnings("outside self-refresh"), 0u);
  b.ddr_clk.write(kFast);
  run_for(kPsPerUs);
  r.write(0x0C, 4, 1895);
  run_for(10 * kPsPerUs);
  EXPECT_EQ(phy(), 1u);
  b.ddr_clk.write(Frequency());
  run_for(kPsPerUs);
  EXPECT_EQ(warnings("outside self-refresh"), 1u);
}

}  // namespace
}  // namespace fovea::dram

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  fovea::dram::Bench bench;
  fovea::dram::bench = &bench;
  return RUN_ALL_TESTS();
}
