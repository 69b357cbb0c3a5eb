// Stalls by cause, region and culprit, and the core's activity counters, with values worked out by
// hand.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <random>

#include "tb/iss/machine.h"

namespace fovea::cpu::test::stalls {
namespace {

constexpr std::uint32_t kA = 0x0020'0000, kB = 0x0030'0000, kDevice = 0x0040'0000;
constexpr std::uint32_t kWindow = 0x0001'0000;  // bytes of each region

/// Caches on, r4 = a, r5 = b, r9 = dev, all in the TLB, and nothing under way. r12 is lost.
const std::string kWait = " mov r12, #40\n9: subs r12, r12, #1\n bne 9b\n";
const std::string kStart = std::string(kCachesOn) +
                           " ldr r4, =0x00200000\n ldr r5, =0x00300000\n ldr r9, =0x00400000\n"
                           " ldr r0, [r4, #0xc00]\n ldr r0, [r5, #0xc40]\n ldr r0, [r9]\n" + kWait;

RegionMap regions(std::uint32_t a = kA, std::uint32_t b = kB) {
  RegionMap map;
  map.add("memory", kMemory, kMemoryBytes);
  map.add("itcm", 0, 0x8000);
  map.add("dtcm", 0x1'0000, 0x8000);
  map.add("a", a, kWindow);
  map.add("b", b, kWindow);
  map.add("dev", kDevice, kWindow);
  map.add("tables", kTables, 0x4000);
  return map;
}

/// `svc #3` notes the counters.
template <class Port>
struct Counting : MachineWith<Port> {
  std::vector<Counts> at;
  explicit Counting(const RegionMap& map = regions(),
                    const typename MachineWith<Port>::Settings& settings = {})
      : MachineWith<Port>(settings) {
    this->core.set_regions(map);
    this->section(kDevice, kDevice, 0, 0);
    this->on_svc = [this](std::uint32_t) { at.push_back(this->core.counts()); };
  }
  std::size_t region(const std::string& name) const {
    const auto& names = this->core.regions().names();
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  }
  /// Clocks between the last two notes.
  std::uint64_t clocks(Cause cause, const std::string& name, std::size_t culprit) const {
    const std::size_t r = region(name);
    return at.back().stalled(cause, r, culprit, at[at.size() - 2]);
  }
  std::uint64_t of_cause(Cause cause) const {
    return at.back().stall[index(cause)] - at[at.size() - 2].stall[index(cause)];
  }
};
using Noting = Counting<FlatPort>;

TEST(StallTest, FillsBelongToTheRegionOfTheirAddress) {
  Noting m;
  m.execute(kStart + "svc #3\n ldr r0, [r4]\n" + kWait + "ldr r0, [r5]\n" + kWait +
            "ldr r0, [r5, #32]\n" + kWait + "svc #3");
  // 80 ns on the bus are 20 clocks; one more leads into the core.
  EXPECT_EQ(m.clocks(Cause::kDcache, "a", kService), 20u);
  EXPECT_EQ(m.clocks(Cause::kDcache, "a", kCore), 1u);
  EXPECT_EQ(m.clocks(Cause::kDcache, "b", kService), 40u);
  EXPECT_EQ(m.clocks(Cause::kDcache, "b", kCore), 2u);
  EXPECT_EQ(m.of_cause(Cause::kDcache), 63u);
}

TEST(StallTest, ARegionThatMovesTakesItsStallsAlong) {
  for (const std::uint32_t at : {0x0020'0000u, 0x0030'0000u, 0x0035'0000u}) {
    Noting m(regions(at, at + 0x0040'0000));
    m.execute(kStart + "ldr r4, =" + std::to_string(at) + "\n ldr r0, [r4, #0x100]\n" + kWait +
              "svc #3\n ldr r0, [r4]\n ldr r1, [r4, #28]\n svc #3");
    EXPECT_EQ(m.clocks(Cause::kDcache, "a", kCore), 1u);
    // The seventh beat behind the critical one comes 14 clocks later; one went by with the second
    // load's own start.
    EXPECT_EQ(m.clocks(Cause::kDcache, "a", kService), 20u + 14 - 1);
    EXPECT_EQ(m.of_cause(Cause::kDcache), 34u);
  }
}

TEST(StallTest, TheWriteThatHoldsUpIsCharged) {
  Noting m;
  m.execute(kStart +
            "svc #3\n str r0, [r4]\n str r0, [r4, #64]\n str r0, [r4, #128]\n str r0, [r4, #192]\n"
            "str r0, [r5]\n svc #3");
  EXPECT_GT(m.of_cause(Cause::kWriteBuffer), 0u);
  EXPECT_EQ(m.clocks(Cause::kWriteBuffer, "a", kService), m.of_cause(Cause::kWriteBuffer));
}

TEST(StallTest, DrainIsChargedToTheWritesThatGoOut) {
  Noting m;
  m.execute(kStart + "mov r1, #0\n svc #3\n str r0, [r5]\n mcr p15, 0, r1, c7, c10, 4\n svc #3");
  EXPECT_EQ(m.of_cause(Cause::kDrain),
            m.clocks(Cause::kDrain, "b", kService) + m.clocks(Cause::kDrain, "b", kCore));
  EXPECT_GE(m.clocks(Cause::kDrain, "b", kService), 8u);
}

TEST(StallTest, UncachedAccessesAndWalks) {
  Noting m;
  m.execute(kStart + "svc #3\n ldr r0, [r9]\n str r0, [r9, #4]\n svc #3");
  // A read of 20 clocks and one into the core, a write of 10.
  EXPECT_EQ(m.clocks(Cause::kUncached, "dev", kService), 30u);
  EXPECT_EQ(m.clocks(Cause::kUncached, "dev", kCore), 1u);
  Noting w;
  w.execute(kStart + "ldr r1, =0x00500000\n svc #3\n ldr r0, [r1]\n svc #3");
  EXPECT_EQ(w.clocks(Cause::kTlb, "tables", kService), 20u);
  EXPECT_EQ(w.clocks(Cause::kTlb, "tables", kCore), 3u + 1) << "the walk's own clocks";
  EXPECT_EQ(w.of_cause(Cause::kTlb), 24u);
  EXPECT_EQ(w.clocks(Cause::kDcache, "memory", kCore), 1u);
}

TEST(StallTest, InstructionsAndInternalRam) {
  Noting m;
  const Program code = assemble("bx lr\n", kA);
  m.load(code);
  m.execute(kStart + "svc #3\n mov lr, pc\n bx r4\n svc #3");
  EXPECT_EQ(m.clocks(Cause::kIcache, "a", kService), 20u);
  EXPECT_EQ(m.clocks(Cause::kIcache, "a", kCore), 1u);
  Noting t(regions(), {{"cpu.tcm.wait_states", "1 cycles"}});
  t.execute(kStart + "ldr r1, =0x00014000\n svc #3\n ldr r0, [r1]\n svc #3");
  EXPECT_EQ(t.clocks(Cause::kTcm, "itcm", kCore), 2u) << "the load's fetch and the mark's";
  EXPECT_EQ(t.clocks(Cause::kTcm, "dtcm", kCore), 1u);
}

/// With the I-cache off a fetch is an uncached read of four words: three beats of two clocks behind the
/// first, at 20 clocks, and one clock into the core. `bx lr` comes with the same burst.
TEST(StallTest, FetchesPastTheCacheAreUncached) {
  for (const bool cache : {false, true}) {
    Noting m;
    m.load(assemble("mov r0, r0\n mov r0, r0\n bx lr\n", kA));
    m.execute(kStart + (cache ? "" : "mrc p15, 0, r1, c1, c0, 0\n bic r1, r1, #0x1000\n"
                                     "mcr p15, 0, r1, c1, c0, 0\n nop\n nop\n nop\n") +
              "svc #3\n mov lr, pc\n bx r4\n svc #3");
    EXPECT_EQ(m.of_cause(Cause::kIcache) > 0, cache);
    EXPECT_EQ(m.of_cause(Cause::kUncached) > 0, !cache);
    EXPECT_EQ(m.clocks(cache ? Cause::kIcache : Cause::kUncached, "a", kService),
              cache ? 20u + 2 : 20u + 3 * 2);
    EXPECT_EQ(m.clocks(cache ? Cause::kIcache : Cause::kUncached, "a", kCore), 1u);
  }
}

/// Says who was waited for: of a read 16 ns the bridge and 24 ns the display, of a write all
/// another master.
class TellingPort : public FlatPort {
 public:
  using FlatPort::FlatPort;
  void submit(BusAccess& a, Picoseconds t) override {
    FlatPort::submit(a, t);
    if (a.write) {
      a.parts.add(culprit(Master::kVpfe), write_latency);
    } else {
      a.parts.add(Culprit::kBridge, 16'000);
      a.parts.add(culprit(Master::kVpbe), 24'000);
    }
  }
};

TEST(StallTest, CulpritsAreThoseOfTheTransaction) {
  Counting<TellingPort> m;
  m.execute(kStart + "svc #3\n ldr r0, [r4]\n" + kWait + "svc #3");
  EXPECT_EQ(m.clocks(Cause::kDcache, "a", index(Culprit::kBridge)), 4u);
  EXPECT_EQ(m.clocks(Cause::kDcache, "a", index(culprit(Master::kVpbe))), 6u);
  EXPECT_EQ(m.clocks(Cause::kDcache, "a", kService), 10u) << "clocks that no part of the transaction explains";
  EXPECT_EQ(m.clocks(Cause::kDcache, "a", kCore), 1u);
  Counting<TellingPort> w;
  w.execute(kStart +
            "svc #3\n str r0, [r4]\n str r0, [r4, #64]\n str r0, [r4, #128]\n str r0, [r4, #192]\n"
            "str r0, [r5]\n svc #3");
  EXPECT_GT(w.of_cause(Cause::kWriteBuffer), 0u);
  EXPECT_EQ(w.clocks(Cause::kWriteBuffer, "a", index(culprit(Master::kVpfe))),
            w.of_cause(Cause::kWriteBuffer));
}

TEST(StallTest, AMissingChargeIsFound) {
  Noting m;
  m.execute(kStart + "ldr r0, [r4]\n str r0, [r9]");
  ASSERT_EQ(m.core.counts().unexplained(), Cause::kCount);
  for (std::size_t k = 1; k < kCauseTable.size(); ++k) {
    Counts missing = m.core.counts(), twice = m.core.counts();
    ++missing.stall[k];
    EXPECT_EQ(missing.unexplained(), static_cast<Cause>(k));
    twice.stalls.add(static_cast<Cause>(k), RegionMap::kOther, kService, 1);
    EXPECT_EQ(twice.unexplained(), static_cast<Cause>(k));
  }
}

TEST(SplitTest, PartsAddUpAndAreInProportion) {
  const std::uint64_t seed =
      std::getenv("FOVEA_SEED") ? std::strtoull(std::getenv("FOVEA_SEED"), nullptr, 0) : 7;
  std::cout << "seed " << seed << "\n";
  std::mt19937_64 random(seed);
  for (unsigned n = 0; n < 20'000; ++n) {
    const unsigned scale = n % 3 == 0 ? 20 : n % 3 == 1 ? 33 : 45;  // up to half a minute
    RequestWaits parts;
    std::array<std::uint64_t, kCulprits> want{};
    std::uint64_t named = 0;
    for (unsigned k = 0; k < random() % 8; ++k) {
      const auto c = static_cast<Culprit>(random() % kCulprits);
      const std::uint64_t ps = random() >> (64 - scale + random() % 12);
      parts.add(c, ps);
      want[index(c)] += ps;
      named += ps;
    }
    const std::uint64_t span = named + (random() & 1u ? random() >> (64 - scale) : 0);
    want[kService] += span - named;
    const std::uint64_t clocks = span / (1000 + random() % 9000) + random() % 3;
    std::array<std::uint64_t, kCulprits> got{};
    auto table = std::make_unique<StallTable>();
    table->split(Cause::kDcache, RegionMap::kOther, clocks, parts, span);
    EXPECT_EQ(table->total(Cause::kDcache), clocks);
    for (std::size_t c = 0; c < kCulprits; ++c)
      got[c] = table->at(Cause::kDcache, RegionMap::kOther, c);
    std::uint64_t sum = 0;
    for (std::size_t c = 0; c < kCulprits; ++c) {
      sum += got[c];
      if (span == 0) continue;
      // Both ends of a part lie within half a clock of their place; service may be two parts.
      const long double exact = static_cast<long double>(want[c]) * clocks / span;
      EXPECT_NEAR(static_cast<double>(got[c]), static_cast<double>(exact),
                  c == kService ? 2.0 : 1.0);
    }
    ASSERT_EQ(sum, clocks);
  }
}

/// What is read is the difference of two states: no share of it is below zero, and they add up.
TEST(StallTableTest, SharesOfAWindowAreOfTheWindow) {
  std::mt19937_64 random(5);
  auto table = std::make_unique<StallTable>();
  for (unsigned window = 0; window < 2000; ++window) {
    const auto before = std::make_unique<StallTable>(*table);
    std::uint64_t clocks = 0;
    for (std::uint64_t n = random() % 4; n > 0; --n) {
      RequestWaits parts;
      parts.clear();
      for (std::uint64_t k = random() % 5; k > 0; --k)
        parts.add(static_cast<Culprit>(random() % kCulprits), random() % 20'000);
      const std::uint64_t now = random() % 9;
      table->split(Cause::kIcache, RegionMap::kOther, now, parts, parts.total());
      clocks += now;
    }
    std::uint64_t sum = 0;
    for (std::size_t c = 0; c < kStallCulprits; ++c) {
      const std::uint64_t n = table->by(Cause::kIcache, c, *before);
      ASSERT_LE(n, clocks) << "window " << window << ", culprit " << stall_culprit_name(c);
      sum += n;
    }
    ASSERT_EQ(sum, clocks);
  }
}

TEST(RegionMapTest, TheLastRangeWins) {
  std::mt19937 random(3);
  for (unsigned n = 0; n < 200; ++n) {
    RegionMap map;
    std::array<std::string, 256> pages;  // of 16 MB
    pages.fill("other");
    for (unsigned k = 0; k < 20; ++k) {
      const std::uint32_t first = random() % 256, pages_long = random() % (257 - first);
      const std::string name = "r" + std::to_string(random() % 9);
      ASSERT_TRUE(map.add(name, std::uint64_t{first} << 24, std::uint64_t{pages_long} << 24));
      std::fill_n(pages.begin() + first, pages_long, name);
    }
    for (std::uint32_t p = 0; p < 256; ++p) {
      EXPECT_EQ(map.names()[map.find(p << 24)], pages[p]);
      EXPECT_EQ(map.names()[map.find((p << 24) + 0xFF'FFFF)], pages[p]);
    }
  }
}

TEST(RegionMapTest, ANameTooManyIsRefused) {
  RegionMap map;
  for (std::size_t k = map.names().size(); k < RegionMap::kMax; ++k)
    ASSERT_TRUE(map.add("r" + std::to_string(k), 0x1000 * k, 0x1000));
  EXPECT_FALSE(map.add("more", 0, 0xFFFF'FFFF));
  EXPECT_EQ(map.find(0), RegionMap::kOther);
  EXPECT_TRUE(map.add("r2", 0, 16)) << "a known name";
  EXPECT_EQ(map.names()[map.find(15)], "r2");
  EXPECT_EQ(map.find(16), RegionMap::kOther);
}

/// The same work cold, warm, and cold again: look-ups are the program's, whatever was decoded.
TEST(ActivityTest, LookUpsDoNotDependOnWhatWasDecodedBefore) {
  for (const bool thumb : {false, true}) {
    Noting m;
    const Program work = assemble(std::string(thumb ? ".syntax unified\n.thumb\n" : "") + R"(
      movs r1, #9
    1: adds r2, r2, r1
      cmp r1, #4
      bgt 2f
      nop
      nop
      nop
      nop
      nop
      nop
      nop
      nop
      nop
    2: subs r1, r1, #1
      cmp r1, #0
      bne 1b
      bx lr
    )", kA);
    m.load(work);
    m.execute(kStart + (thumb ? "add r4, r4, #1\n" : "") +
              "mov r11, #0\n mov r8, #3\n"
              "1: svc #3\n mov lr, pc\n bx r4\n svc #3\n"
              "mov lr, pc\n bx r4\n svc #3\n mcr p15, 0, r11, c7, c5, 0\n"
              "subs r8, r8, #1\n bne 1b");
    ASSERT_EQ(m.at.size(), 9u);
    // 9 turns of 6 instructions, 9 more in 4 of them, and three; branches: 5 over the middle, 8
    // back, the return.
    const std::uint64_t executed = 9 * 6 + 4 * 9 + 2, redirects = 5 + 8 + 1;
    const std::uint64_t words =
        thumb ? (executed + 3 * redirects) / 2 : executed + 2 * redirects;
    for (const std::size_t k : {0u, 1u, 3u, 4u, 6u, 7u})
      EXPECT_EQ(m.at[k + 1].icache_accesses() - m.at[k].icache_accesses(), words) << k;
    EXPECT_GT(m.at[4].icache_fills, m.at[3].icache_fills) << "cold again";
    EXPECT_EQ(m.at[2].icache_fills, m.at[1].icache_fills);
  }
}

TEST(ActivityTest, WhatEachInstructionAddsByHand) {
  Noting m;
  m.section(0x0060'0000, 0x0060'0000, 0, 1);  // uncached, buffered
  m.execute(kStart + R"(
    ldr r6, =0x00014000
    ldr r7, =0x00004000
    ldr r10, =0x00600000
    ldr r0, [r10]
    mov r8, #10
    svc #3
  1: ldr r0, [r6]
    ldrb r0, [r6, #1]
    strh r0, [r6, #2]
    ldmia r6, {r0-r3}
    ldr r0, [r7]
    str r0, [r7, #4]
    stmia r7, {r0, r1}
    ldr r0, [r4, #0xc00]
    strb r0, [r4, #0xc04]
    ldr r0, [r9]
    str r0, [r9]
    str r0, [r10]
    stmia r10, {r0-r3}
    mul r0, r1, r2
    umull r0, r1, r2, r3
    smlabb r0, r1, r2, r3
    mulne r0, r1, r2
    muleq r0, r1, r2
    mrc p15, 0, r0, c0, c0, 0
    subs r8, r8, #1
    bne 1b
    svc #3
  )");
  const Counts &from = m.at[0], &to = m.at[1];
  EXPECT_EQ(to.dtcm_reads - from.dtcm_reads, 10u * (1 + 1 + 4));
  EXPECT_EQ(to.dtcm_writes - from.dtcm_writes, 10u * 1);
  EXPECT_EQ(to.itcm_reads - from.itcm_reads, 10u * 1);
  EXPECT_EQ(to.itcm_writes - from.itcm_writes, 10u * (1 + 2));
  EXPECT_EQ(to.dcache_reads - from.dcache_reads, 10u);
  EXPECT_EQ(to.dcache_writes - from.dcache_writes, 10u);
  EXPECT_EQ(to.multiplies - from.multiplies, 10u * 4) << "one of mulne and muleq is executed";
  EXPECT_EQ(to.coprocessor - from.coprocessor, 10u);
  // Fetched from internal RAM: 21 instructions, the mark's, two words behind a taken branch.
  EXPECT_EQ(to.words_fetched(FetchFrom::kTcm) - from.words_fetched(FetchFrom::kTcm),
            10u * 21 + 9 * 2 + 1);
  EXPECT_EQ(to.redirects - from.redirects, 9u);
  EXPECT_EQ(to.icache_accesses(), from.icache_accesses());
  // Each word fetched, each load and store, in internal RAM as elsewhere.
  EXPECT_EQ(to.tlb_lookups() - from.tlb_lookups(),
            10u * 21 + 9 * 2 + 1 + 10u * (6 + 1 + 1 + 3) + 10u * (1 + 1 + 1 + 1 + 1 + 4));
  EXPECT_EQ(to.tlb_walks, from.tlb_walks);
  EXPECT_EQ(to.d_read_beats - from.d_read_beats, 10u);
  EXPECT_EQ(to.d_write_beats - from.d_write_beats, 10u * (1 + 1 + 4));
  EXPECT_EQ(to.i_read_beats, from.i_read_beats);
}

TEST(ActivityTest, WriteBacksAndFillsByHand) {
  Noting m;
  m.execute(kStart + "ldr r0, [r5]\n ldr r0, [r5, #32]\n" + kWait +
            "svc #3\n ldr r0, [r4]\n str r0, [r4, #4]\n str r0, [r5]\n str r0, [r5, #16]\n"
            "mcr p15, 0, r4, c7, c10, 1\n mcr p15, 0, r5, c7, c10, 1\n svc #3");
  const Counts &from = m.at[0], &to = m.at[1];
  EXPECT_EQ(to.writeback_words - from.writeback_words, 4u + 8) << "a half, and a whole line";
  EXPECT_EQ(to.d_write_beats - from.d_write_beats, 12u);
  EXPECT_EQ(to.d_read_beats - from.d_read_beats, 8u);
}

TEST(ActivityTest, NoTranslationWithoutTheMmu) {
  Noting m;
  m.execute("ldr r4, =0x00200000\n ldr r0, [r4]\n str r0, [r4]");
  EXPECT_EQ(m.core.counts().tlb_lookups(), 0u);
  EXPECT_EQ(m.core.counts().tlb_walks, 0u);
}

/// Loads from internal RAM count while the MMU is on: three of the five, and the words of that time.
TEST(ActivityTest, TranslationsInInternalRamAreThoseWithTheMmuOn) {
  Noting m;
  m.execute("ldr r4, =0x14000\n ldr r0, [r4]\n" + kStart +
            "ldr r4, =0x14000\n svc #3\n ldr r0, [r4]\n str r0, [r4]\n ldr r0, [r4]\n svc #3\n"
            "mrc p15, 0, r1, c1, c0, 0\n bic r1, r1, #1\n mcr p15, 0, r1, c1, c0, 0\n"
            "nop\n nop\n svc #3\n ldr r0, [r4]\n str r0, [r4]\n svc #3");
  ASSERT_EQ(m.at.size(), 4u);
  EXPECT_EQ(m.at[1].tlb_lookups() - m.at[0].tlb_lookups(), 1u + 3 + 3);
  // The mark and three; both instructions behind the one that turns it off were fetched before.
  EXPECT_EQ(m.at[2].tlb_lookups() - m.at[1].tlb_lookups(), 1u + 3 + 2);
  EXPECT_EQ(m.at[3].tlb_lookups(), m.at[2].tlb_lookups());
}

}  // namespace
}  // namespace fovea::cpu::test::stalls
