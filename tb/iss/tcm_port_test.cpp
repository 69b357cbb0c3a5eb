// Internal RAM shared with a DMA: data, and clocks counted by hand. A core clock is 4 ns, and a
// burst arrives between two of them. Unless stated otherwise: two banks of 16 KB, words of two
// clocks, a latency of two clocks, the core goes first.
#include <array>
#include <deque>
#include <memory>

#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

using Side = TcmPort::Side;

/// A machine whose program runs at 0 in internal RAM, from clock 1 on, and bursts at given clocks.
struct Shared : Machine {
  explicit Shared(const Settings& settings = {}) : Machine(settings) {}
  struct Burst {
    std::array<std::uint8_t, 64> data{};
    Picoseconds over = 0;
  };
  std::deque<Burst> bursts;

  /// Arrives just behind clock `c`, so that its first word wants the bank at c + 1 + latency.
  Burst& burst(std::uint64_t c, bool write, std::uint32_t offset, unsigned bytes,
               Master who = Master::kEdmaTc0Read) {
    Burst& b = bursts.emplace_back();
    const Picoseconds at = c * kClock + 1;
    port.schedule(at, [=, this, &b] {
      core.tcm_burst_begins({offset, bytes, who}, at);
      look(b, write);
    });
    return b;
  }
  /// The core's accesses of the same instant come before the burst's.
  void look(Burst& b, bool write) {
    port.schedule(core.tcm_burst_over() + 1, [=, this, &b] {
      if (core.tcm_burst_over() >= port.now) return look(b, write);
      b.over = port.now - 1;
      core.tcm_burst_ends(write, b.data.data());
    });
  }
  std::uint64_t tcm_stall(Master m) const {
    return core.counts().stalls.by(Cause::kTcm, index(culprit(m)));
  }
  std::uint64_t waited(Side s) const { return core.tcm_port().waited(s); }
};

std::string nops(unsigned n) { return ".rept " + std::to_string(n) + "\n mov r0, r0\n .endr\n"; }

/// 200 instructions in bank 0, one a clock, between two marks; a burst of 64 bytes in their midst.
struct Straight : Shared {
  explicit Straight(const Settings& s, std::uint32_t offset = 0x2000, unsigned bytes = 64)
      : Shared(s) {
    burst(60, false, offset, bytes);
    execute("svc #1\n" + nops(200) + "svc #1\n" + nops(80));
  }
};

TEST(TcmPortTest, TheCoreGoesFirstAndTheDmaWaits) {
  Straight m(Machine::Settings{});
  EXPECT_EQ(m.between(), 200u);
  EXPECT_EQ(m.stall(Cause::kTcm), 0u);
  // Only the clocks of the marks are free: each mark takes three, the first of them for its fetch.
  EXPECT_GT(m.waited(Side::kFetch), 100u);
  EXPECT_EQ(m.waited(Side::kData), 0u);
}

TEST(TcmPortTest, TheDmaGoesFirstAndTheCoreWaitsForTheWholeBurst) {
  Straight m(Machine::Settings{{"cpu.tcm.first", "dma"}});
  EXPECT_EQ(m.between(), 200u + 16 * 2);
  EXPECT_EQ(m.stall(Cause::kTcm), 32u);
  EXPECT_EQ(m.tcm_stall(Master::kEdmaTc0Read), 32u);
  EXPECT_EQ(m.waited(Side::kFetch), 0u);
  // Arrived behind clock 60: words from clock 63 to 94; the data move in the last of these.
  EXPECT_EQ(m.bursts[0].over, 94 * Machine::kClock);
}

TEST(TcmPortTest, EachParameterHasItsEffect) {
  const auto stalled = [](Machine::Settings s, std::uint32_t offset = 0x2000, unsigned bytes = 64) {
    s.emplace_back("cpu.tcm.first", "dma");
    return Straight(s, offset, bytes).stall(Cause::kTcm);
  };
  EXPECT_EQ(stalled({{"cpu.tcm.dma_word_clocks", "1cycles"}}), 16u);
  EXPECT_EQ(stalled({{"cpu.tcm.dma_word_clocks", "3cycles"}}), 48u);
  EXPECT_EQ(stalled({}, 0x2000, 32), 16u);
  EXPECT_EQ(stalled({}, 0x2000, 4), 2u);
  EXPECT_EQ(stalled({}, 0x3FC0), 32u) << "the end of the core's bank";
  EXPECT_EQ(stalled({}, 0x4000), 0u) << "the other bank";
  EXPECT_EQ(stalled({{"cpu.tcm.banks", "1"}}, 0x4000), 32u);
  Straight late(Machine::Settings{{"cpu.tcm.first", "dma"}, {"cpu.tcm.dma_latency", "7cycles"}});
  EXPECT_EQ(late.bursts[0].over, (94 + 5) * Machine::kClock);
}

/// A loop of four clocks whose two fetches leave two free: a word of the DMA fits in.
TEST(TcmPortTest, WordsGoBetweenTheFetchesOfALoop) {
  const auto loop = [](const char* clocks) {
    auto m = std::make_unique<Shared>(Machine::Settings{{"cpu.tcm.dma_word_clocks", clocks}});
    m->burst(60, false, 0x2000, 64);
    m->execute("mov r1, #100\n svc #1\n1: subs r1, r1, #1\n bne 1b\n svc #1");
    return m;
  };
  const auto two = loop("2cycles");
  EXPECT_EQ(two->between(), 100u * 4 - 2) << "the last branch is not taken";
  EXPECT_EQ(two->stall(Cause::kTcm), 0u);
  // The loop begins at clock 5: fetches at 61 and 62, 65 and 66, ...; words at 63, 67, ... 123, the
  // first as it comes, each later one two clocks behind the end of the one before.
  EXPECT_EQ(two->bursts[0].over, 124 * Machine::kClock);
  EXPECT_EQ(two->waited(Side::kFetch), 15u * 2);
  // A word of three clocks holds up the next fetch for one of them.
  const auto three = loop("3cycles");
  EXPECT_EQ(three->stall(Cause::kTcm), 16u);
  EXPECT_EQ(three->between(), two->between() + 16);
}

/// Loads from bank 1 every six clocks, code in bank 0: words of two clocks end in the middle of it.
TEST(TcmPortTest, LoadsAndWordsTakeTurns) {
  Shared m;
  m.burst(60, true, 0x6000, 64, Master::kEdmaTc1Write);
  m.execute("ldr r2, =0x17000\n mov r1, #100\n svc #1\n"
            "1: ldr r0, [r2]\n subs r1, r1, #1\n mov r3, r3\n bne 1b\n svc #1");
  // The loop begins at clock 6 (1, 2, and three of the mark): loads at 60, 66. Words at 63, 65: the
  // load at 66 waits for clock 67; the DMA, which wanted 67, for 68. Words at 68, 70, 72; the load,
  // due at 73, waits for 74, the DMA for 75, and so on: three words between two loads.
  const unsigned loads = 5;  // 2 + 3 + 3 + 3 + 3 words are begun at the fifth, the last two behind it
  EXPECT_EQ(m.stall(Cause::kTcm), loads);
  EXPECT_EQ(m.tcm_stall(Master::kEdmaTc1Write), loads);
  EXPECT_EQ(m.waited(Side::kData), loads);
  EXPECT_EQ(m.between(), 100u * 6 - 2 + loads);
  Shared other;
  other.burst(60, true, 0x6000, 64, Master::kEdmaTc1Write);
  other.execute("ldr r2, =0x13000\n mov r1, #100\n svc #1\n"
                "1: ldr r0, [r2]\n subs r1, r1, #1\n mov r3, r3\n bne 1b\n svc #1");
  EXPECT_EQ(other.stall(Cause::kTcm), 0u) << "the other bank";
}

TEST(TcmPortTest, DataGoBothWays) {
  Shared m;
  auto& in = m.burst(100, true, 0x5000, 64);
  for (unsigned k = 0; k < 64; ++k) in.data[k] = static_cast<std::uint8_t>(k * 7 + 1);
  auto& out = m.burst(1000, false, 0x5040, 32);
  // Copies what has come, from one window to what the other reads.
  m.execute("ldr r2, =0x15000\n ldr r3, =0x5040\n ldr r6, [r2]\n"
            "1: ldr r0, [r2, #60]\n cmp r0, #0\n beq 1b\n"
            "ldmia r2!, {r4, r5, r8-r11}\n stmia r3!, {r4, r5, r8-r11}\n mov r7, #255\n"
            "2: subs r7, r7, #1\n bne 2b\n");
  EXPECT_EQ(m.core.reg(6), 0u) << "not there yet";
  EXPECT_EQ(std::memcmp(out.data.data(), in.data.data(), 24), 0);
  EXPECT_EQ(out.data[24], 0u);
}

/// A load sees the data from the clock behind the burst's last one on.
TEST(TcmPortTest, TheDataAreThereBehindTheLastClock) {
  for (unsigned before : {0u, 1u, 2u, 3u}) {
    Shared m;
    m.burst(60, true, 0x5000, 4).data = {0x11, 0x22, 0x33, 0x44};
    // The word has clocks 63 and 64. Four instructions from clock 1: the load's clock is 63 to 66, less
    // what it waits for.
    m.execute("ldr r2, =0x15000\n" + nops(61 + before) + "ldr r0, [r2]");
    const unsigned clock = 1 + 1 + 61 + before;
    EXPECT_EQ(m.core.reg(0), clock > 63 ? 0x4433'2211u : 0u) << clock;
    EXPECT_EQ(m.stall(Cause::kTcm), clock == 64 ? 1u : 0u) << "the word is not stopped: " << clock;
  }
}

TEST(TcmPortTest, DecodedCodeDies) {
  Shared m;
  const Program other = assemble("add r0, r0, #16\n", 0);
  auto& in = m.burst(400, true, 0x2004, 4);
  std::memcpy(in.data.data(), other.bytes.data(), 4);
  m.execute("mov r0, #0\n mov r4, #200\n"
            "1: bl f\n subs r4, r4, #1\n bne 1b\n b 9f\n"
            ".org 0x2000\nf: mov r0, r0\n add r0, r0, #1\n bx lr\n9:\n");
  const std::uint32_t calls = 200, late = (m.core.reg(0) - calls) / 15;
  EXPECT_EQ((m.core.reg(0) - calls) % 15, 0u);
  EXPECT_GT(late, 100u);
  EXPECT_LT(late, 190u);
}

/// Also when the core learns of the burst only in the middle of an instruction: a walk comes between.
TEST(TcmPortTest, AWalkBeforeTheAccessLetsTheBurstIn) {
  const auto run = [](std::uint64_t at) {
    auto m = std::make_unique<Shared>();
    m->burst(at, true, 0x5000, 4).data = {1, 0, 0, 0};
    m->execute(std::string(kCachesOn) + "ldr r2, =0x15000\n mov r5, #50\n1: subs r5, r5, #1\n"
               "bne 1b\n mcr p15, 0, r0, c8, c5, 0\n svc #1\n ldr r0, [r2]\n svc #1",
               kMemory);
    return m;
  };
  // Where the walk lies.
  const auto probe = run(100'000'000);
  const std::uint64_t walk = probe->marks[0] + 3;
  ASSERT_EQ(probe->core.reg(0), 0u);
  ASSERT_GT(probe->between(), 20u) << "no walk";
  EXPECT_EQ(run(walk + 8)->core.reg(0), 1u);
  EXPECT_EQ(run(walk + probe->between() + 8)->core.reg(0), 0u);
}

/// Eight words of an STM go to memory, four to the RAM: a burst that arrives meanwhile is seen. A store
/// under way keeps the buffered words from looking at the bus.
TEST(TcmPortTest, BufferedWordsBeforeTheAccessLetTheBurstIn) {
  const auto run = [](std::uint64_t at) {
    auto m = std::make_unique<Shared>(Machine::Settings{{"cpu.tcm.first", "dma"}});
    const std::uint32_t table = kTables + 0x8000;
    m->port.set_word(kTables + 4 * 0x80, table | 0x11u);
    m->port.set_word(table, 0x0030'0000u | 0xFF6u);      // buffered
    m->port.set_word(table + 4, 0x0001'4000u | 0xFF2u);  // the data window, bank 1
    m->port.write_latency = 4'000'000;
    m->burst(at, false, 0x6000, 64);
    m->execute(std::string(kCachesOn) +
               "ldr r14, =0x08000000\n ldr r0, [r14]\n add r12, r14, #0x1000\n ldr r0, [r12]\n"
               "sub r12, r12, #32\n mov r0, #200\n 1: subs r0, r0, #1\n bne 1b\n"
               "str r0, [r14]\n svc #1\n stmia r12, {r0-r11}\n svc #1\n");
    return m;
  };
  const auto probe = run(100'000'000);
  const std::uint64_t begin = probe->marks[0] + 3;
  EXPECT_EQ(probe->stall(Cause::kTcm), 0u);
  EXPECT_EQ(probe->between(), 12u);
  // Arrived behind clock begin + 4: its words want the bank from begin + 7 to begin + 38.
  const auto met = run(begin + 4);
  EXPECT_EQ(met->stall(Cause::kTcm), 31u) << "from begin + 8 to begin + 39";
  EXPECT_EQ(met->between(), 12u + 31);
}

TEST(TcmPortTest, WaitStatesAreTheCoresOwn) {
  Straight shared(Machine::Settings{{"cpu.tcm.wait_states", "1cycles"}}, 0x4000);
  Shared alone(Machine::Settings{{"cpu.tcm.wait_states", "1cycles"}});
  alone.execute("svc #1\n" + nops(200) + "svc #1\n" + nops(80));
  EXPECT_EQ(shared.between(), alone.between());
  EXPECT_EQ(shared.core.counts().stall, alone.core.counts().stall);
}

/// The core against itself: loads and stores in the bank of the code, each word of several.
TEST(TcmPortTest, FetchAndDataMayMeet) {
  const auto clocks = [](const char* lost, const char* address, std::uint32_t base = 0) {
    Shared m(Machine::Settings{{"cpu.tcm.own_conflict", lost}});
    m.execute(std::string("ldr r2, =") + address +
                  "\n svc #1\n ldr r0, [r2]\n strh r5, [r2]\n ldmia r2, {r0, r1, r3}\n svc #1",
              base);
    EXPECT_EQ(m.core.counts().stalls.by(Cause::kTcm, kCore), m.stall(Cause::kTcm));
    return m.between();
  };
  const std::uint64_t usual = 1 + 1 + 3;
  EXPECT_EQ(clocks("0cycles", "0x12000"), usual);
  EXPECT_EQ(clocks("1cycles", "0x12000"), usual + 1 + 1 + 3);
  EXPECT_EQ(clocks("1cycles", "0x16000"), usual) << "the other bank";
  EXPECT_EQ(clocks("1cycles", "0x16000", 0x4000), usual + 1 + 1 + 3) << "code there as well";
}

}  // namespace
}  // namespace fovea::cpu::test
