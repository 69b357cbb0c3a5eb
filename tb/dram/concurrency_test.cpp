// Writers and readers of the same bytes at once: no read is torn between two writes of a block, a
// reader never sees a block go back, and what a writer has read back every master sees.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

constexpr unsigned kBlocks = 6;
constexpr Master kWriter = Master::kArmD;

/// Blocks in three rows of two banks; two of them share a 2 KiB block.
std::uint32_t block_address(unsigned block) {
  return at(block % 3, block / 3) + (block == 5 ? 64u : block % 2 * 1024u);
}

struct Sent {
  Request request;
  unsigned block;
  std::uint32_t stamp;        // write: its number
  std::uint32_t known;        // read: the number that its master must see at least
  bool read_back;             // of the writer
};

struct Totals {
  std::uint64_t reads = 0, changes = 0, behind = 0, known = 0, stale = 0;
};

/// `all_known`: readers wrongly rely on all that was written before, not only on what the writer has
/// read back by then; what they miss is counted.
Totals run(std::uint64_t seed, const char* scheduler, bool all_known = false) {
  Rng rng(seed);
  const auto below = [&](unsigned n) { return static_cast<unsigned>(rng.below(n)); };
  BenchOptions o;
  o.config.refresh_interval = 500 + below(1500);
  o.config.old_count = below(2) ? 0xFF : 4;
  o.config.row_intervals = 1 + below(16);
  o.params = {{"scheduler", scheduler}, {"request_latency", std::to_string(below(12)) + " cycles"}};
  DdrBench b(o);
  b.keep_log = false;
  const unsigned readers = 1 + below(4);
  std::vector<std::unique_ptr<Sent>> all;
  std::array<std::uint32_t, kBlocks> written{}, confirmed{};
  std::size_t answered = 0;
  Totals totals;
  std::array<std::array<std::uint32_t, kBlocks>, kMasterCount> seen{};
  const auto collect = [&] {
    for (; answered < b.read_order.size(); ++answered) {
      const Request& r = *b.read_order[answered];
      const auto sent = std::find_if(all.rbegin(), all.rend(),
                                     [&](const auto& s) { return &s->request == &r; });
      const Sent& s = **sent;
      std::uint32_t words[16];
      std::memcpy(words, r.data.data(), r.bytes);
      for (unsigned k = 1; k < r.bytes / 4; ++k)
        ASSERT_EQ(words[k], words[0]) << "torn, seed " << seed;
      auto& last = seen[index(r.master)][s.block];
      ++totals.reads;
      totals.changes += words[0] != last;
      totals.behind += words[0] < written[s.block];
      totals.known += s.known > 0 && s.known == words[0];
      ASSERT_GE(words[0], last) << "went back, seed " << seed;
      totals.stale += words[0] < s.known;
      last = words[0];
      if (s.read_back) confirmed[s.block] = std::max(confirmed[s.block], words[0]);
    }
  };
  Picoseconds now = kTck;
  for (unsigned i = 0; i < 1500; ++i) {
    all.push_back(std::make_unique<Sent>());
    Sent& s = *all.back();
    Request& r = s.request;
    s.block = below(kBlocks);
    r.address = block_address(s.block);
    r.bytes = 64;
    const unsigned who = below(readers + 2);
    if (who < 2) {  // the writer: writes, and reads its block back
      r.master = kWriter;
      r.write = below(3) != 0;
      s.read_back = !r.write;
      r.priority = 3;
    } else {
      r.master = static_cast<Master>(who + 2);
      r.bytes = 16u << below(3);
      r.address += below(64 / r.bytes) * r.bytes;
      r.priority = below(8);
    }
    now += below(4) ? below(30) * Picoseconds{1'000} : below(400) * Picoseconds{1'000};
    while (b.input_taken()) {
      now = std::max(now, b.ddr.next_decision());
      b.step();
    }
    b.run_before(now);
    collect();
    if (testing::Test::HasFatalFailure()) return totals;
    // The writer's own reads see its own writes; others what the writer knows to be there.
    s.known = s.read_back || all_known ? written[s.block] : confirmed[s.block];
    if (r.write) {
      s.stamp = ++written[s.block];
      for (unsigned k = 0; k < 16; ++k) std::memcpy(r.data.data() + 4 * k, &s.stamp, 4);
    }
    b.submit_at(r, now);
  }
  b.drain();
  collect();
  EXPECT_EQ(b.checker.total(), 0u) << b.checker.text();
  for (unsigned k = 0; k < kBlocks; ++k) {
    std::uint32_t word;
    std::memcpy(&word, b.store().at(block_address(k)), 4);
    EXPECT_EQ(word, written[k]);
  }
  return totals;
}

TEST(ConcurrencyTest, ReadsAreNeitherTornNorStale) {
  for (const char* scheduler : {"ti", "fcfs", "frfcfs", "closed_page"}) {
    Totals sum;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const Totals t = run(seed, scheduler);
      if (HasFatalFailure()) FAIL() << scheduler << " seed " << seed;
      sum.reads += t.reads;
      sum.changes += t.changes;
      sum.behind += t.behind;
      sum.known += t.known;
      ASSERT_EQ(t.stale, 0u) << scheduler << " seed " << seed;
    }
    // The streams must meet for this to mean anything.
    EXPECT_GT(sum.changes, 10'000u) << scheduler;
    EXPECT_GT(sum.behind, 1'000u) << scheduler << ": reads while writes are on their way";
    EXPECT_GT(sum.known, 1'000u) << scheduler << ": reads that were bound to see just this write";
  }
}

// Between masters the controller keeps no order: a read may pass another master's older write. Who
// counts on it gets stale data, and the comparison above finds that.
TEST(ConcurrencyTest, OrderBetweenMastersIsNotPromised) {
  const Totals t = run(1, "ti", true);
  EXPECT_GT(t.stale, 0u);
  EXPECT_EQ(run(1, "fcfs", true).stale, 0u) << "strictly by age it is kept";
}

}  // namespace
}  // namespace fovea::dram
