// Crossbar and DDR controller together: bytes and requests are conserved, and each clock that a read waits in
// the controller has the culprit that was computed by hand.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "tb/dram/bench.h"
#include "tb/dram/path.h"

namespace fovea::dram {
namespace {

constexpr Master kCamera = Master::kVpfe, kDisplay = Master::kVpbe;

// A lone 32-byte read through both cores. DDR 250 MHz, crossbar 125 MHz (8 ns): submitted at 0,
// seen at edge 1, arbitrated at 3, at the controller at edge 4 = 32 ns = DDR edge 8; seen at 9, ACT
// at 17, RD at 22; first 8 bytes at 22 + 5 + 2 + 2 = 31 = 124 ns, so crossbar edge 16; last beat at
// 22 + 4 + 7 + 4 = 37 = 148 ns: edge 19; two edges back to the port.
TEST(PathTest, UnloadedReadLatency) {
  Path path;
  std::array<std::uint8_t, 32> data;
  PathRequest r;
  r.master = kCamera;
  r.bytes = 32;
  r.data = data.data();
  path.submit(r, 0);
  path.drain();
  EXPECT_EQ(r.first, (16 + 2) * 8'000u);
  EXPECT_EQ(r.last, (19 + 2) * 8'000u);
}

TEST(PathTest, RequestsAndBytesAreConserved) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    Path path;
    CommandChecker checker(sheet_of(mem::DdrConfig{}));
    const Subscription checking = path.ddr.observe_commands(
        [](void* self, mem::Cmd c, unsigned bank, std::uint32_t row, std::uint64_t clock) {
          static_cast<CommandChecker*>(self)->command(translate(c), bank, row, clock);
        },
        &checker);
    Rng rng(seed);
    for (std::size_t m = 0; m < kMasterCount; ++m)
      path.xbar.set_priority(static_cast<Master>(m), static_cast<unsigned>(rng.below(8)));
    struct Item {
      PathRequest r;
      std::array<std::uint8_t, 64> data{};
      Picoseconds at = 0;
    };
    std::vector<std::unique_ptr<Item>> all;
    std::array<std::vector<Item*>, kMasterCount> open;
    Picoseconds now = 0;
    for (unsigned i = 0; i < 8000; ++i) {
      auto item = std::make_unique<Item>();
      const auto m = static_cast<std::size_t>(rng.below(kMasterCount));
      item->r.master = static_cast<Master>(m);
      item->r.write = rng.below(2) != 0;
      item->r.bytes = static_cast<std::uint8_t>(4u << rng.below(5));
      item->r.address =
          at(static_cast<std::uint32_t>(rng.below(64)), static_cast<unsigned>(rng.below(8)),
             static_cast<std::uint32_t>(rng.below(32)) * 64u);
      item->r.data = item->data.data();
      if (rng.below(4) == 0) now += rng.below(60) * 1'000;
      path.run_before(now);
      // At most four outstanding of one master.
      for (;;) {
        std::erase_if(open[m], [](Item* x) { return x->r.responses != 0; });
        if (open[m].size() < 4) break;
        now = std::max(now, path.next_decision());
        path.step();
      }
      item->at = now;
      path.submit(item->r, now);
      open[m].push_back(item.get());
      all.push_back(std::move(item));
    }
    path.drain();
    std::uint64_t read = 0, written = 0;
    for (const auto& item : all) {
      EXPECT_EQ(item->r.responses, 1u);
      EXPECT_GT(item->r.first, item->at);
      EXPECT_GE(item->r.last, item->r.first);
      (item->r.write ? written : read) += item->r.bytes;
    }
    std::uint64_t bus_read = 0, bus_written = 0, transactions = 0;
    for (const auto& s : path.xbar.stats) {
      bus_read += s->ddr_read_bytes;
      bus_written += s->ddr_write_bytes;
      transactions += s->transactions.count();
    }
    std::uint64_t timeline_read = 0, timeline_written = 0;
    for (const auto& row : path.xbar.timeline.rows()) {
      for (const std::uint64_t bytes : row.read) timeline_read += bytes;
      for (const std::uint64_t bytes : row.write) timeline_written += bytes;
    }
    EXPECT_EQ(checker.total(), 0u) << checker.text();
    EXPECT_GT(checker.commands(), all.size());
    EXPECT_EQ(bus_read, read);
    EXPECT_EQ(bus_written, written);
    EXPECT_EQ(path.ddr.stats.read_bytes.count(), read);
    EXPECT_EQ(path.ddr.stats.write_bytes.count(), written);
    EXPECT_EQ(timeline_read, read);
    EXPECT_EQ(timeline_written, written);
    EXPECT_EQ(transactions, all.size());
    // Every picosecond from issue to outcome has one culprit.
    for (std::size_t m = 0; m < kMasterCount; ++m) {
      std::uint64_t reads = 0, writes = 0, tagged_reads = 0, tagged_writes = 0;
      for (const auto& item : all)
        if (index(item->r.master) == m)
          (item->r.write ? writes : reads) += item->r.first - item->at;
      for (std::size_t c = 0; c < kCulprits; ++c) {
        tagged_reads += path.xbar.waits[m].read.ps[c] + path.ddr.waits()[m].read.ps[c];
        tagged_writes += path.xbar.waits[m].write.ps[c] + path.ddr.waits()[m].write.ps[c];
      }
      EXPECT_EQ(tagged_reads, reads) << m;
      EXPECT_EQ(tagged_writes, writes) << m;
      EXPECT_LT(path.xbar.waits[m].read.ps[index(Culprit::kService)], reads);
    }
  }
}

/// DDR clocks of 4 ns that the reads of a master waited for a culprit in the controller.
std::uint64_t clocks(const Path& p, Master m, Culprit c) {
  return p.ddr.waits()[index(m)].read.ps[index(c)] / 4'000;
}

class WaitsTest : public testing::Test {
 protected:
  PathRequest& go(Master m, bool write, std::uint32_t address, unsigned bytes, Picoseconds when) {
    requests_.push_back(std::make_unique<PathRequest>());
    PathRequest& r = *requests_.back();
    r.master = m;
    r.write = write;
    r.address = address;
    r.bytes = static_cast<std::uint8_t>(bytes);
    r.data = data_.data();
    path.submit(r, when);
    return r;
  }
  WaitsTest() {
    path.xbar.set_priority(kCamera, 0);
    path.xbar.set_priority(kDisplay, 1);
  }
  static constexpr Picoseconds kLater = 1'000'000;
  const mem::DdrTiming t;  // the controller's default
  Path path;

 private:
  std::array<std::uint8_t, 64> data_{};
  std::vector<std::unique_ptr<PathRequest>> requests_;
};

TEST_F(WaitsTest, QueuedClocksAndBanksOfLoneReads) {
  const mem::DdrParams p;
  const std::uint64_t hit = p.request_latency() + 1;  // from its arrival to behind its column
  go(kCamera, false, at(1, 0, 0), 16, 0);
  path.drain();
  EXPECT_EQ(path.ddr.stats.queued_clocks.count(), hit + t.nRCD);
  go(kCamera, false, at(1, 0, 16), 16, kLater);
  path.drain();
  EXPECT_EQ(path.ddr.stats.queued_clocks.count(), 2 * hit + t.nRCD);
  go(kCamera, false, at(2, 3, 16), 16, 2 * kLater);
  go(kCamera, false, at(2, 0, 16), 16, 3 * kLater);
  path.drain();
  const auto& bank = path.ddr.stats.bank;
  EXPECT_EQ(bank[0].row_misses, 1u);
  EXPECT_EQ(bank[0].row_hits, 1u);
  EXPECT_EQ(bank[0].row_conflicts, 1u);
  EXPECT_EQ(bank[3].row_misses, 1u);
}

TEST_F(WaitsTest, SleepIsCountedUpToTheTimeOfTheReading) {
  mem::DdrConfig c;
  c.refresh_interval = 0;
  c.low_power = mem::LowPower::kPowerDown;
  path.ddr.configure(c, 0);
  path.ddr.catch_up(kLater);
  const std::uint64_t first = path.ddr.stats.power_down_clocks.count();
  EXPECT_GT(first, kLater / 4'000 - 10);
  path.ddr.catch_up(2 * kLater);
  EXPECT_EQ(path.ddr.stats.power_down_clocks.count() - first, kLater / 4'000);
  EXPECT_EQ(path.ddr.stats.self_refresh_clocks.count(), 0u);
}

TEST_F(WaitsTest, ClosedBankCostsTheActivation) {
  go(kCamera, false, at(1, 0, 0), 32, 0);
  path.drain();
  EXPECT_EQ(clocks(path, kCamera, Culprit::kRowMiss), t.nRCD);
  go(kCamera, false, at(1, 0, 64), 32, kLater);
  path.drain();
  EXPECT_EQ(clocks(path, kCamera, Culprit::kRowMiss), t.nRCD) << "the row is open now";
  EXPECT_EQ(path.ddr.waits()[index(kCamera)].read.ps[index(Culprit::kRowConflict)], 0u);
}

TEST_F(WaitsTest, OtherRowCostsPrechargeAndActivation) {
  go(kCamera, false, at(1, 0, 0), 32, 0);
  go(kDisplay, false, at(2, 0, 0), 32, kLater);
  path.drain();
  EXPECT_EQ(clocks(path, kDisplay, Culprit::kRowConflict), t.nRP + t.nRCD);
  EXPECT_EQ(clocks(path, kDisplay, Culprit::kRowMiss), 0u);
}

TEST_F(WaitsTest, ReadBehindAnothersBurstWaitsForThatMaster) {
  go(kCamera, false, at(1, 0, 0), 4, 0);
  path.drain();
  // Both cross in a clock of 8 ns each; the columns of the first are at c, c + 4, c + 8, c + 12; the second is
  // ready at c + 2.
  go(kCamera, false, at(1, 0, 0), 64, kLater);
  go(kDisplay, false, at(1, 0, 64), 16, kLater);
  path.drain();
  EXPECT_EQ(clocks(path, kDisplay, culprit(kCamera)), 4u * 4 - 2);
  EXPECT_EQ(clocks(path, kCamera, culprit(kDisplay)), 0u);
}

TEST_F(WaitsTest, ReadAfterAnothersWriteWaitsForBurstAndTurnaround) {
  go(kCamera, false, at(1, 0, 0), 4, 0);
  path.drain();
  go(kCamera, true, at(1, 0, 0), 4, kLater);
  go(kDisplay, false, at(1, 0, 64), 16, kLater);
  path.drain();
  // WR at w; its data end at w + WL + 4; RD at w + WL + 4 + tWTR. the display's request is ready at w + 2.
  EXPECT_EQ(clocks(path, kDisplay, culprit(kCamera)), t.WL() + 4u - 2);
  EXPECT_EQ(clocks(path, kDisplay, Culprit::kTurnaround), t.nWTR);
}

TEST_F(WaitsTest, ReadOfASleepingMemoryWaitsForItsWaking) {
  mem::DdrConfig c;
  c.low_power = mem::LowPower::kSelfRefresh;
  path.ddr.configure(c, 0);
  go(kCamera, false, at(1, 0, 0), 16, kLater);
  path.drain();
  // CKE rises at the arrival; the pipeline's clocks run meanwhile.
  const mem::DdrParams p;
  EXPECT_EQ(clocks(path, kCamera, Culprit::kPowerDown) + clocks(path, kCamera, Culprit::kRowMiss),
            std::max(c.timing.nXSNR + c.timing.nRCD, c.timing.nXSRD) - p.request_latency());
  EXPECT_GE(clocks(path, kCamera, Culprit::kPowerDown), c.timing.nXSNR - p.request_latency());
}

TEST_F(WaitsTest, ReadDuringARefreshWaitsForIt) {
  mem::DdrConfig c;
  c.refresh_interval = 500;
  path.ddr.configure(c, 0);
  // The interval ends at clock 500, when nothing is queued: PREA is not needed, REF at once. The read
  // is ready some clocks later.
  const Picoseconds when = 500 * 4'000 - 3 * 8'000;
  PathRequest& r = go(kCamera, false, at(1, 0, 0), 16, when);
  path.drain();
  const std::uint64_t refresh = clocks(path, kCamera, Culprit::kRefresh);
  EXPECT_GT(refresh, 0u);
  EXPECT_LT(refresh, c.timing.nRFC);
  Path calm;
  PathRequest same;
  same.master = kCamera;
  same.address = at(1, 0, 0);
  same.bytes = 16;
  std::array<std::uint8_t, 16> data{};
  same.data = data.data();
  calm.submit(same, when);
  calm.drain();
  // Reads come at edges of 8 ns: 2 clocks.
  EXPECT_NEAR(static_cast<double>(r.first - same.first), static_cast<double>(refresh) * 4'000, 8'000);
}

}  // namespace
}  // namespace fovea::dram
