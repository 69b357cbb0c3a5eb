// Bursts of the EDMA and the core's accesses to internal RAM in a replay: who waits for whom, in the file as well.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "sw/fovea/replay/core_ram.h"
#include "tb/replay/recorder_feed.h"
#include "tb/replay/support.h"

namespace fovea::replay::core_ram {
namespace {

using app::CoreRam;
using testing::HasSubstr;
using trace::RamRun;

constexpr Picoseconds kNanosecond = kPsPerNs;
const Clock kCoreClock(Frequency(250'000'000), 0);  // 4 ns
constexpr std::uint32_t kBank = INTERNAL_RAM_BYTES / 2;

/// Two clocks before the first word, two for each, two banks.
trace::EdmaInfo with_banks(bool core_first = true) {
  trace::EdmaInfo edma{8, 256, 4, 2, 2, 40'000};
  edma.ram_banks = 2;
  edma.ram_core_first = core_first;
  return edma;
}

Record with_runs(std::vector<RamRun> runs, std::uint64_t gap = 100) {
  Record r;
  r.release = Release::kAfter;
  r.gap = gap;
  r.ram = std::move(runs);
  return r;
}

MemRequest burst_of(unsigned bytes, std::uint32_t offset = 0) {
  MemRequest r;
  r.master = edma_write(0);
  r.address = INTERNAL_RAM_DATA_BASE + offset;
  r.bytes = static_cast<std::uint8_t>(bytes);
  return r;
}

/// The clock in which a burst ends that arrives right before clock 10: alone in 12 + two clocks a word - 1.
std::uint64_t end_of(const MemRequest& burst, CoreRam& ram) {
  MemRequest r = burst;
  ram.arrive(r, 9 * 4 * kNanosecond);
  ram.begin(kCoreClock);
  return kCoreClock.edge_at_or_after(ram.over(kCoreClock));
}

std::uint64_t end_beside(const std::vector<RamRun>& runs, std::uint64_t from, const trace::EdmaInfo& edma,
                         std::uint64_t* waited = nullptr) {
  CoreRam ram(edma);
  const Record r = with_runs(runs);
  ram.gap_begins(r, from);
  const std::uint64_t end = end_of(burst_of(16), ram);
  if (waited) *waited = ram.waited();
  return end;
}

TEST(CoreRamTest, ABurstAloneTakesItsWords) {
  CoreRam ram(with_banks());
  EXPECT_EQ(end_of(burst_of(16), ram), 10u + 2 + 4 * 2 - 1);
  MemRequest behind = burst_of(4);
  ram.arrive(behind, 0);
  EXPECT_FALSE(ram.waiting()) << "one burst after the other";
  ram.finish(kCoreClock.edge(19));
  ASSERT_TRUE(ram.waiting());
  ram.begin(kCoreClock);
  EXPECT_EQ(kCoreClock.edge_at_or_after(ram.over(kCoreClock)), 20u + 2 + 2 - 1);
}

// The words want the bank at 12, 14, 16 and 18.
TEST(CoreRamTest, CoreAndBurstWaitForEachOtherInOneBank) {
  std::uint64_t waited = 0;
  EXPECT_EQ(end_beside({{0, 1, 0}}, 12, with_banks(), &waited), 20u) << "the core comes first";
  EXPECT_EQ(waited, 0u);
  EXPECT_EQ(end_beside({{0, 1, 0}}, 13, with_banks(), &waited), 20u) << "but does not stop a word, and is first then";
  EXPECT_EQ(waited, 1u);
  EXPECT_EQ(end_beside({{0, 1, 0}}, 12, with_banks(false), &waited), 19u) << "the EDMA comes first, with all its words";
  EXPECT_EQ(waited, 8u);
  EXPECT_EQ(end_beside({{0, 1, 1}}, 12, with_banks(), &waited), 19u) << "another bank";
  EXPECT_EQ(waited, 0u);
  EXPECT_EQ(end_beside({{0, 1, 0}}, 19, with_banks(), &waited), 19u) << "the last word has begun";
  EXPECT_EQ(waited, 1u);
  EXPECT_EQ(end_beside({{0, 1, 0}}, 20, with_banks(), &waited), 19u) << "the burst is over";
  EXPECT_EQ(waited, 0u);
}

// Accesses in a row leave no clock to the burst; those of the other bank do, up to their end.
TEST(CoreRamTest, RunsAreAccessesOneByOne) {
  EXPECT_EQ(end_beside({{0, 30, 0}}, 8, with_banks()), 19u + 26) << "from 8 to 37";
  std::vector<RamRun> singles{{0, 1, 0}};
  for (unsigned n = 1; n < 30; ++n) singles.push_back({1, 1, 0});
  EXPECT_EQ(end_beside(singles, 8, with_banks()), 19u + 26);
  EXPECT_EQ(end_beside({{0, 30, 1}, {1, 5, 0}}, 8, with_banks()), 19u);
  EXPECT_EQ(end_beside({{0, 3, 1}, {4, 1, 0}}, 8, with_banks()), 20u) << "at 14: four clocks from the third begin";
}

// An instruction that has begun has done all its accesses for a burst that arrives then.
TEST(CoreRamTest, ABurstWaitsForNoInstructionThatHasBegun) {
  EXPECT_EQ(end_beside({{0, 8, 0, true}}, 9, with_banks()), 19u);
  EXPECT_EQ(end_beside({{0, 8, 0, true}}, 10, with_banks()), 19u + 6) << "from 10 to 17";
  EXPECT_EQ(end_beside({{0, 8, 0, true}, {1, 8, 0, true}}, 9, with_banks()), 19u + 8) << "but for the next one";
}

// What the program does behind its wait for a word is looks, which end when it sees the word.
TEST(CoreRamTest, LooksAreRepeated) {
  CoreRam ram(with_banks());
  Record r = with_runs({}, 0);
  r.look_after = 2;
  r.look_clocks = 4;
  ram.gap_begins(r, 10);  // looks at 12, 16, 20
  EXPECT_EQ(end_of(burst_of(16), ram), 19u) << "not known yet";
  ram.looks_until(12);
  ram.follow();
  EXPECT_EQ(kCoreClock.edge_at_or_after(ram.over(kCoreClock)), 19u) << "before the first look";
  ram.looks_until(13);
  ram.follow();
  EXPECT_EQ(kCoreClock.edge_at_or_after(ram.over(kCoreClock)), 20u);
  ram.looks_until(1000);
  ram.follow();  // 13, 15; a look at 16 gets 17 behind the word, the next one at 21 comes first
  EXPECT_EQ(kCoreClock.edge_at_or_after(ram.over(kCoreClock)), 21u);
}

/// The message of the error that reading a trace of one record gives; empty if it is read as written.
std::string error_of(const Record& r, unsigned stream = 0, unsigned banks = 2) {
  trace::TraceInfo info = edma_info();
  info.edma.ram_banks = banks;
  trace::TraceWriter writer(static_cast<unsigned>(info.streams.size()));
  Record first;
  first.bytes = 4;
  first.at = 2'000'000;
  first.master = stream == 0 ? Master::kArmD : Master::kVpfe;
  writer.add(stream, first);
  writer.add(stream, r);
  std::string bytes;
  writer.finish(info, [&](std::string_view piece) { bytes += piece; });
  try {
    trace::TraceFile file("t", std::move(bytes));
    Record read;
    file.next(stream, read);
    file.next(stream, read);
    EXPECT_EQ(read, r);
    EXPECT_EQ(file.info().edma, info.edma);
  } catch (const UserError& e) {
    return e.what();
  }
  return {};
}

TEST(CoreRamFileTest, AccessesAreReadAsTheyWereWritten) {
  Record r = with_runs({{0, 4, 0, true}, {1, 1, 1}, {70'000, 300, 0}});
  r.bytes = 4;
  r.back = 1;
  EXPECT_EQ(error_of(r), "");
  r.kind = trace::Kind::kStep;
  r.bytes = 0;
  r.look_after = 9;
  r.look_clocks = 8;
  r.look_bank = 1;
  EXPECT_EQ(error_of(r), "");
  r.ram.clear();
  EXPECT_EQ(error_of(r), "");
}

TEST(CoreRamFileTest, WhatNoRecorderWritesIsRefused) {
  Record good = with_runs({{0, 1, 1}});
  good.bytes = 4;
  good.back = 1;
  ASSERT_EQ(error_of(good), "");
  EXPECT_THAT(error_of(good, 0, 0), HasSubstr("of another stream than the core's")) << "it has no such accesses";
  EXPECT_THAT(error_of(good, 0, 1), HasSubstr("an unknown bank"));
  EXPECT_THAT(error_of(good, 0, trace::kMaxRamBanks + 1), HasSubstr("an impossible internal RAM"));
  Record r = good;
  r.master = Master::kVpfe;
  EXPECT_THAT(error_of(r, 1), HasSubstr("of another stream than the core's"));
  r = good;
  r.ram[0].count = 0;
  EXPECT_THAT(error_of(r), HasSubstr("an impossible access to internal RAM"));
  r = good;
  r.look_clocks = 8;
  EXPECT_THAT(error_of(r), HasSubstr("of a record without a gap")) << "only a step looks";
  r = good;
  r.release = Release::kAt;
  r.at = 3'000'000;
  EXPECT_THAT(error_of(r), HasSubstr("of a record without a gap"));
  for (const std::size_t runs : {trace::kMaxRamRuns, trace::kMaxRamRuns + 1}) {
    r = good;
    r.ram.assign(runs, {1, 1, 0});
    EXPECT_EQ(error_of(r).empty(), runs == trace::kMaxRamRuns) << runs;
  }
}

// A block ends early where its records are long, and is read back.
TEST(CoreRamFileTest, LongRecordsMakeShortBlocks) {
  trace::TraceInfo info = edma_info();
  info.edma.ram_banks = 2;
  trace::TraceWriter writer(static_cast<unsigned>(info.streams.size()));
  Record r;
  r.bytes = 4;
  r.at = 2'000'000;
  writer.add(0, r);
  r = with_runs(std::vector<RamRun>(trace::kMaxRamRuns, RamRun{~0u, ~0u, 1, true}));
  r.bytes = 4;
  r.back = 1;
  for (unsigned n = 0; n < 40; ++n) writer.add(0, r);
  std::string bytes;
  writer.finish(info, [&](std::string_view piece) { bytes += piece; });
  trace::TraceFile file("t", std::move(bytes));
  unsigned records = 0;
  for (Record back; file.next(0, back); ++records) EXPECT_EQ(back.ram.size(), records ? trace::kMaxRamRuns : 0u);
  EXPECT_EQ(records, 41u);
}

trace::Surroundings with_ram() {
  trace::Surroundings s;
  s.edma = with_banks();
  return s;
}

class RamFeed : public Feed {
 public:
  RamFeed()
      : Feed({{Master::kArmD, Pace::kCore, 1, 1, true},
              {edma_read(0), Pace::kTransfers, 4, 4, true, edma_write(0)},
              {edma_write(0), Pace::kTransfers, 4, 4, true, edma_read(0)}},
             with_ram()) {}
  void access(std::uint64_t clock, std::uint32_t pc, std::uint32_t offset = 0, std::uint64_t waited = 0) {
    recorder().accessed({offset, pc, clock, waited, core.room_waits});
  }
};

TEST(CoreRamRecorderTest, AccessesInAGapAreRuns) {
  RamFeed f;
  f.read(100, 100, 120, 130);
  f.access(110, 1);                                               // before the gap: no part of it
  for (unsigned n = 0; n < 4; ++n) f.access(122 + n, 0x10);       // one instruction
  for (unsigned n = 0; n < 3; ++n) f.access(126 + n, 0x14 + 4 * n);
  f.access(129, 0x20, kBank);
  f.access(135, 0x24, kBank, 3);                                  // wanted at 132
  f.access(136, 0x28, kBank);
  f.access(160, 0x2C);                                            // comes to what follows
  f.read(150, 150, 170, 180);
  f.read(175, 176, 190, 200);
  const auto r = f.records();
  ASSERT_EQ(r.size(), 3u);
  EXPECT_EQ(r[1].ram, (std::vector<RamRun>{{2, 4, 0, true}, {1, 3, 0}, {1, 1, 1}, {3, 2, 1}}));
  EXPECT_EQ(r[1].gap, 30u - 3) << "what the core waited for the EDMA is not its own";
  EXPECT_TRUE(r[2].ram.empty()) << "the core waited for the read then";
}

TEST(CoreRamRecorderTest, MoreRunsThanARecordHoldsAreLeftOut) {
  for (const std::size_t runs : {trace::kMaxRamRuns, trace::kMaxRamRuns + 1}) {
    RamFeed f;
    f.read(100, 100, 120, 130);
    for (std::size_t n = 0; n < runs; ++n) f.access(130 + 3 * n, 0x10);
    f.read(100'000, 100'000, 100'010, 100'020);
    const auto r = f.records();
    ASSERT_EQ(r.size(), 2u);
    EXPECT_EQ(r[1].ram.size(), trace::kMaxRamRuns);
  }
}

}  // namespace
}  // namespace fovea::replay::core_ram
