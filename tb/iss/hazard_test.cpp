// Each kind of hazard by itself, with the place and the times that are reported, and its nearest neighbour
// that is none.
#include "tb/iss/hazard_bench.h"

namespace fovea::cpu::test {
namespace {

class HazardTest : public ::testing::Test {
 protected:
  HazardBench bench;
  static constexpr std::uint32_t kLine = line_used(0, 6);
  static Step dma(bool write, std::uint32_t address, unsigned bytes, Picoseconds delay = 0) {
    Step s{Do::kDma, address, 5};
    s.write = write;
    s.bytes = bytes;
    s.delay = delay;
    return s;
  }
  /// Counts by kind, in the order of HazardKind.
  std::array<std::uint64_t, kHazardKinds> counts(const std::vector<Step>& steps) {
    visible = bench.run(steps);
    std::array<std::uint64_t, kHazardKinds> out;
    for (std::size_t k = 0; k < kHazardKinds; ++k) out[k] = bench.count(static_cast<HazardKind>(k));
    return out;
  }
  using Counts = std::array<std::uint64_t, kHazardKinds>;
  static constexpr Counts kNone{0, 0, 0, 0, 0};
  Visible visible;
};

TEST_F(HazardTest, StaleLoadNamesPlaceAndTimes) {
  EXPECT_EQ(counts({{Do::kLoad, kLine}, dma(true, kLine + 4, 4, 500'000), {Do::kLoad, kLine + 4}}),
            (Counts{1, 0, 0, 0, 0}));
  ASSERT_EQ(bench.places.size(), 1u);
  const Hazard& h = bench.places[0];
  EXPECT_EQ(h.kind, HazardKind::kStaleLoad);
  EXPECT_EQ(h.master, Master::kEdmaTc0Write);
  EXPECT_EQ(h.address, kLine + 4);
  EXPECT_EQ(h.pc, bench.handler(Do::kLoad));
  EXPECT_LT(h.filled, h.before);
  EXPECT_LT(h.before, h.after);
  EXPECT_GE(h.before - h.filled, 500'000u);
  EXPECT_LT(h.after - h.before, 500'000u);
}

TEST_F(HazardTest, OnlyTheBytesWrittenAreStale) {
  const Step fill{Do::kLoad, kLine}, write = dma(true, kLine + 8, 4);
  EXPECT_EQ(counts({fill, write, {Do::kLoad, kLine + 4}, {Do::kLoad, kLine + 12}}), kNone);
  EXPECT_EQ(counts({fill, write, {Do::kLoadByte, kLine + 7}, {Do::kLoadByte, kLine + 12}}), kNone);
  EXPECT_EQ(counts({fill, write, {Do::kLoadByte, kLine + 8}}), (Counts{1, 0, 0, 0, 0}));
  EXPECT_EQ(counts({fill, write, {Do::kLoadByte, kLine + 11}}), (Counts{1, 0, 0, 0, 0}));
  // Words 1 to 4 contain word 2; words 3 to 6 do not.
  EXPECT_EQ(counts({fill, write, {Do::kLoadFour, kLine + 4}}), (Counts{1, 0, 0, 0, 0}));
  EXPECT_EQ(counts({fill, write, {Do::kLoadFour, kLine + 12}}), kNone);
  // The whole line, and the last byte before and the first one behind it.
  EXPECT_EQ(counts({fill, dma(true, kLine - 4, 4), dma(true, kLine + 32, 4), {Do::kLoadFour, kLine},
                    {Do::kLoadFour, kLine + 16}}), kNone);
}

TEST_F(HazardTest, EachLoadCountsButAPlaceIsReportedOnce) {
  EXPECT_EQ(counts({{Do::kLoad, kLine}, dma(true, kLine, 32), {Do::kLoad, kLine}, {Do::kLoad, kLine},
                    {Do::kLoad, kLine + 8}, {Do::kLoadByte, kLine}}), (Counts{4, 0, 0, 0, 0}));
  EXPECT_EQ(bench.places.size(), 2u);  // the word and the byte load
  EXPECT_EQ(bench.checker->places(), 2u);
}

TEST_F(HazardTest, AnInvalidatedOrReplacedLineIsNotStale) {
  const Step fill{Do::kLoad, kLine}, write = dma(true, kLine, 32), again{Do::kLoad, kLine};
  EXPECT_EQ(counts({fill, write, {Do::kInvalidateLine, kLine}, again, again}), kNone);
  EXPECT_EQ(counts({fill, {Do::kInvalidateLine, kLine}, write, again}), kNone);
  EXPECT_EQ(counts({fill, write, {Do::kCleanInvalidateAll}, again}), kNone);
  // A clean alone does not help.
  EXPECT_EQ(counts({fill, write, {Do::kCleanLine, kLine}, again}), (Counts{1, 0, 0, 0, 0}));
}

TEST_F(HazardTest, TheCoresOwnStoreMakesStaleBytesFresh) {
  const Step fill{Do::kLoad, kLine}, write = dma(true, kLine, 8);
  EXPECT_EQ(counts({fill, write, {Do::kStore, kLine, 1}, {Do::kLoad, kLine}}), kNone);
  EXPECT_EQ(counts({fill, write, {Do::kStore, kLine, 1}, {Do::kLoad, kLine + 4}}), (Counts{1, 0, 0, 0, 0}));
  EXPECT_EQ(counts({fill, write, {Do::kStoreByte, kLine, 1}, {Do::kLoad, kLine}}), (Counts{1, 0, 0, 0, 0}));
}

TEST_F(HazardTest, DirtyHalfUnderARead) {
  const Step fill{Do::kLoad, kLine}, store{Do::kStore, kLine + 16, 7};
  EXPECT_EQ(counts({fill, store, dma(false, kLine, 32, 300'000)}), (Counts{0, 1, 0, 0, 0}));
  ASSERT_EQ(bench.places.size(), 1u);
  const Hazard& h = bench.places[0];
  EXPECT_EQ(h.kind, HazardKind::kDirtyRead);
  EXPECT_EQ(h.master, Master::kEdmaTc0Read);
  EXPECT_EQ(h.address, kLine + 16);
  EXPECT_EQ(h.pc, bench.handler(Do::kStore));
  EXPECT_GE(h.after - h.before, 300'000u);
  EXPECT_LT(h.after - h.before, 600'000u);
  // Named is the store that made the half dirty, not a later one of the same or of the other half.
  EXPECT_EQ(counts({fill, store, {Do::kStoreByte, kLine + 20, 1}, {Do::kStoreByte, kLine + 16, 1},
                    dma(false, kLine + 16, 16, 300'000)}), (Counts{0, 1, 0, 0, 0}));
  EXPECT_EQ(bench.places.back().pc, bench.handler(Do::kStore));
  // The other half, the neighbouring lines, and after a clean.
  EXPECT_EQ(counts({fill, store, dma(false, kLine, 16)}), kNone);
  EXPECT_EQ(counts({fill, store, dma(false, kLine + 12, 8)}), (Counts{0, 1, 0, 0, 0}));
  EXPECT_EQ(counts({fill, store, dma(false, kLine + 32, 32), dma(false, kLine - 32, 32)}), kNone);
  EXPECT_EQ(counts({fill, store, {Do::kCleanLine, kLine}, {Do::kDrain}, dma(false, kLine, 32)}), kNone);
  EXPECT_EQ(counts({fill, store, {Do::kStore, kLine, 7}, dma(false, kLine, 32)}), (Counts{0, 2, 0, 0, 0}));
}

TEST_F(HazardTest, PendingWriteUnderARead) {
  bench.m.port.decide_late = true;
  bench.m.port.write_latency = 1'000'000;
  const std::uint32_t uncached = line_used(2, 6);
  const Step store{Do::kStore, uncached, 7}, stored_before{Do::kStore, uncached + 64, 7};
  EXPECT_EQ(counts({store, dma(false, uncached, 4)}), (Counts{0, 0, 1, 0, 0}));
  EXPECT_EQ(counts({stored_before, store, dma(false, uncached, 4)}), (Counts{0, 0, 1, 0, 0}));
  EXPECT_EQ(counts({store, dma(false, uncached + 4, 4), dma(false, uncached - 4, 4)}), kNone);
  EXPECT_EQ(counts({store, {Do::kDrain}, dma(false, uncached, 4)}), kNone);
  EXPECT_EQ(counts({store, dma(false, uncached, 4, 2'000'000)}), kNone);  // it has gone by then
  // A line on its way from the victim buffer; and a line that misses is not allocated by a store.
  EXPECT_EQ(counts({{Do::kLoad, kLine}, {Do::kStore, kLine, 7}, {Do::kCleanLine, kLine}, dma(false, kLine, 4)}),
            (Counts{0, 0, 1, 0, 0}));
  EXPECT_EQ(counts({{Do::kStore, kLine, 7}, dma(false, kLine, 4)}), (Counts{0, 0, 1, 0, 0}));
}

/// Bytes in a buffer that a line held: the store's place and time. Others: where the core is, and no time.
TEST_F(HazardTest, PendingWritesNameTheStoreThatALineHeld) {
  bench.m.port.decide_late = true;
  bench.m.port.write_latency = 1'000'000;
  const std::uint32_t through = line_used(1, 6), uncached = line_used(2, 6);
  const Step clean{Do::kCleanLine, kLine};
  const auto place = [&](const std::vector<Step>& steps) {
    counts(steps);
    EXPECT_EQ(bench.places.size(), 1u);
    return bench.places.empty() ? Hazard{} : bench.places[0];
  };
  const auto is_store = [&](const Hazard& h, Do what, unsigned into = 0) {
    EXPECT_EQ(h.pc, bench.handler(what) + into);
    EXPECT_LT(h.stored, h.after);
    EXPECT_GT(h.stored, h.after - 600'000);
    EXPECT_EQ(h.before, h.after);
  };
  // The victim buffer: the first store into the half, whatever the other half has.
  is_store(place({{Do::kLoad, kLine}, {Do::kStoreByte, kLine + 20, 7}, {Do::kStore, kLine, 7}, clean,
                  dma(false, kLine + 20, 4)}), Do::kStoreByte);
  is_store(place({{Do::kLoad, kLine}, {Do::kStore, kLine, 7}, clean, dma(false, kLine + 12, 8)}), Do::kStore);
  is_store(place({{Do::kLoad, kLine}, {Do::kStore, kLine, 7}, clean, dma(true, kLine, 4)}), Do::kStore);
  // A line that is written through: the store into the word that waits.
  const Step fill{Do::kLoad, through};
  is_store(place({fill, {Do::kStore, through, 7}, {Do::kStoreByte, through + 4, 7}, dma(false, through + 4, 4)}),
           Do::kStoreByte);
  is_store(place({fill, {Do::kStoreFour, through, 7}, dma(false, through + 12, 4)}), Do::kStoreFour, 12);
  is_store(place({fill, {Do::kStoreHalf, through + 2, 7}, dma(true, through, 4)}), Do::kStoreHalf);
  // No line: the core was waiting for the DMA.
  for (const std::uint32_t address : {uncached, kLine, through}) {
    const Hazard h = place({{Do::kStore, address, 7}, dma(false, address, 4)});
    EXPECT_EQ(h.stored, 0u);
    EXPECT_GE(h.pc, bench.handler(Do::kDma));
    EXPECT_LT(h.pc, bench.handler(Do::kSwap));
  }
}

TEST_F(HazardTest, WriteBackOverNewerBytes) {
  const Step fill{Do::kLoad, kLine}, store{Do::kStore, kLine, 7};
  EXPECT_EQ(counts({fill, store, dma(true, kLine + 12, 4), {Do::kCleanLine, kLine}}), (Counts{0, 0, 0, 1, 0}));
  ASSERT_EQ(bench.places.size(), 1u);
  EXPECT_EQ(bench.places[0].kind, HazardKind::kOverwrite);
  EXPECT_EQ(bench.places[0].pc, bench.handler(Do::kStore));
  EXPECT_EQ(bench.places[0].address, kLine + 12);
  EXPECT_LT(bench.places[0].before, bench.places[0].after);
  // The clean half is not written back.
  EXPECT_EQ(counts({fill, store, dma(true, kLine + 16, 4), {Do::kCleanLine, kLine}}), kNone);
  // The store may come after the DMA's write: the half contains stale bytes.
  EXPECT_EQ(counts({fill, dma(true, kLine + 12, 4), store, {Do::kCleanLine, kLine}}), (Counts{0, 0, 0, 1, 0}));
  EXPECT_EQ(counts({fill, dma(true, kLine, 4), store, {Do::kCleanLine, kLine}}), kNone);
  EXPECT_EQ(counts({fill, store, dma(true, kLine, 4), {Do::kInvalidateLine, kLine}}), kNone);
  // A replaced line: five others of its set.
  std::vector<Step> replace{{Do::kLoad, line_used(0, 0)}, {Do::kStore, line_used(0, 0), 7},
                            dma(true, line_used(0, 0), 4)};
  for (unsigned round = 0; round < 8; ++round)
    for (unsigned n = 1; n < 6; ++n) replace.push_back({Do::kLoad, line_used(0, n)});
  EXPECT_EQ(counts(replace), (Counts{0, 0, 0, 1, 0}));
}

TEST_F(HazardTest, PendingWriteOverNewerBytes) {
  bench.m.port.decide_late = true;
  bench.m.port.write_latency = 1'000'000;
  const std::uint32_t uncached = line_used(2, 6);
  EXPECT_EQ(counts({{Do::kStore, uncached, 7}, dma(true, uncached, 4)}), (Counts{0, 0, 0, 1, 0}));
  EXPECT_EQ(counts({{Do::kStore, uncached, 7}, dma(true, uncached + 4, 4)}), kNone);
}

/// The DMA's write comes between the read at the memory and the line's arrival at the core.
TEST_F(HazardTest, WriteDuringTheFill) {
  bench.m.port.decide_late = true;
  bench.m.port.read_latency = 1'000'000;
  bench.write_during_fill(kLine);
  EXPECT_EQ(counts({{Do::kLoad, kLine}, {Do::kLoad, kLine}}), (Counts{1, 0, 0, 0, 0}));
}

/// The SDRAM controller may serve a fill before a write of another master that came earlier (`ddr.scheduler` = ti).
TEST_F(HazardTest, AFillThatPassesAWrite) {
  bench.m.port.decide_late = true;
  bench.m.port.read_latency = 1'000'000;
  bench.write_passed_by_fill(kLine);
  EXPECT_EQ(counts({{Do::kLoad, kLine + 8}, {Do::kLoad, kLine + 4}}), kNone) << "other bytes of the line";
  bench.write_passed_by_fill(kLine);
  EXPECT_EQ(counts({{Do::kLoad, kLine + 8}, {Do::kLoad, kLine}}), (Counts{1, 0, 0, 0, 0}));
  EXPECT_EQ(visible.loaded.back() & 0xFFu, initial_byte(kLine));
  ASSERT_EQ(bench.places.size(), 1u);
  EXPECT_EQ(bench.places[0].address, kLine);
  EXPECT_EQ(bench.places[0].master, Master::kEdmaTc0Write);
  EXPECT_LE(bench.places[0].before, bench.places[0].filled);
  // A line that is filled after the write, or filled again, holds what memory does.
  EXPECT_EQ(counts({dma(true, kLine, 4), {Do::kLoad, kLine + 8}, {Do::kLoad, kLine}}), kNone);
  bench.write_passed_by_fill(kLine);
  EXPECT_EQ(counts({{Do::kLoad, kLine + 8}, {Do::kInvalidateLine, kLine}, {Do::kLoad, kLine + 8}, {Do::kLoad, kLine}}),
            kNone);
}

TEST_F(HazardTest, CodeThatWasChangedInMemory) {
  static constexpr std::uint32_t kFunction = code_line(7) + 8;
  const auto change = [](std::uint32_t address, std::uint32_t value) {
    Step s = dma(true, address, 4, 300'000);
    s.code = true;
    s.value = value;
    return s;
  };
  const Step call{Do::kCall, kFunction}, neighbour{Do::kCall, kFunction + 8};
  const Step invalidate{Do::kInvalidateCode, kFunction};
  EXPECT_EQ(counts({call, change(kFunction, 99), call}), (Counts{0, 0, 0, 0, 1}));
  EXPECT_EQ(visible.loaded, (std::vector<std::uint32_t>{2, 2}));
  ASSERT_EQ(bench.places.size(), 1u);
  const Hazard& h = bench.places[0];
  EXPECT_EQ(h.kind, HazardKind::kStaleFetch);
  EXPECT_EQ(h.master, Master::kEdmaTc0Write);
  EXPECT_EQ(h.pc, kFunction);
  EXPECT_EQ(h.address, kFunction);
  EXPECT_LT(h.filled, h.before);
  EXPECT_LT(h.before, h.after);
  EXPECT_GE(h.before - h.filled, 300'000u);
  EXPECT_LT(h.after - h.before, 300'000u);
  EXPECT_EQ(counts({call, change(kFunction, 99), call, call}), (Counts{0, 0, 0, 0, 2}));
  EXPECT_EQ(bench.checker->places(), 1u);
  // Other words of the line, and the lines beside it.
  EXPECT_EQ(counts({call, change(kFunction, 99), neighbour}), kNone);
  EXPECT_EQ(counts({call, change(kFunction + 8, 99), call}), kNone);
  EXPECT_EQ(counts({call, change(code_line(8), 99), change(code_line(6), 99), call}), kNone);
  // The line is filled again, or was never held.
  EXPECT_EQ(counts({call, change(kFunction, 99), invalidate, call}), kNone);
  EXPECT_EQ(visible.loaded, (std::vector<std::uint32_t>{2, 99}));
  EXPECT_EQ(counts({call, invalidate, change(kFunction, 98), call, call}), kNone);
  EXPECT_EQ(visible.loaded, (std::vector<std::uint32_t>{2, 98, 98}));
  EXPECT_EQ(counts({change(kFunction, 97), call, change(kFunction, 96), invalidate, call}), kNone);
  EXPECT_EQ(visible.loaded, (std::vector<std::uint32_t>{97, 96}));
  EXPECT_EQ(counts({neighbour, change(kFunction, 95), call}), (Counts{0, 0, 0, 0, 1}));
}

/// Watches a line from its fill to its second load.
struct Listener : LineWatch {
  explicit Listener(Core& c) : core(c) {}
  bool is_it(unsigned line) const { return core.view().data.lines().line(line).pa == address; }
  void filled(unsigned line) override {
    if (!is_it(line)) return;
    ++fills;
    core.watch_line(line, true);
  }
  void loaded(unsigned line, unsigned offset, unsigned) override {
    if (!is_it(line)) return;
    loads.push_back(offset);
    if (loads.size() == 2) core.watch_line(line, false);
  }
  void stored(unsigned, unsigned, unsigned) override { ++stores; }
  void written_back(unsigned, unsigned halves) override { written.push_back(halves); }
  Core& core;
  std::uint32_t address = 0;
  std::vector<unsigned> loads, written;
  unsigned fills = 0, stores = 0;
};

/// Another observer neither takes the checker's place nor ends what the checker still watches.
TEST_F(HazardTest, SeveralObserversSeeTheSameLines) {
  const std::vector<Step> steps{{Do::kLoad, kLine}, dma(true, kLine, 32), {Do::kLoad, kLine + 4},
                                {Do::kLoad, kLine + 8}, {Do::kStore, kLine + 20, 9}, {Do::kCleanAll}};
  Listener first(bench.m.core), second(bench.m.core);
  first.address = second.address = kLine;
  Subscription first_on = bench.m.core.observe_lines(first);
  const Subscription second_on = bench.m.core.observe_lines(second);
  EXPECT_EQ(counts(steps), (Counts{2, 0, 0, 1, 0}));
  for (const Listener* l : {&first, &second}) {
    EXPECT_EQ(l->fills, 1u);
    EXPECT_EQ(l->loads, (std::vector<unsigned>{0, 4, 8}));  // the checker still watches for the third
    EXPECT_EQ(l->stores, 1u);
    EXPECT_EQ(l->written, (std::vector<unsigned>{2}));  // the upper half
  }
  first_on.reset();
  second.loads.clear();
  EXPECT_EQ(counts(steps), (Counts{2, 0, 0, 1, 0}));
  EXPECT_EQ(first.fills, 1u);
  EXPECT_EQ(first.loads.size(), 3u);
  EXPECT_EQ(second.fills, 2u);
  EXPECT_EQ(second.loads, (std::vector<unsigned>{0, 4, 8}));
}

/// The checker changes nothing but the host's time.
TEST_F(HazardTest, TimesAreThoseWithoutIt) {
  const std::vector<Step> steps{{Do::kLoad, kLine},
                                dma(true, kLine, 32),
                                {Do::kLoad, kLine},
                                {Do::kStore, kLine + 4, 9},
                                {Do::kStore, kLine + 8, 9},
                                {Do::kLoad, kLine + 4},
                                {Do::kLoadFour, kLine + 20},
                                {Do::kCall, code_line(0)},
                                dma(true, code_line(0) + 8, 4),
                                {Do::kCall, code_line(0)},
                                {Do::kCleanAll},
                                {Do::kDrain}};
  const auto clocks = [&](bool checked) {
    HazardBench fresh;
    fresh.checked = checked;
    fresh.run(steps);
    return std::pair(fresh.m.core.clock_count(), fresh.m.core.instructions_executed());
  };
  EXPECT_EQ(clocks(true), clocks(false));
}

}  // namespace
}  // namespace fovea::cpu::test
