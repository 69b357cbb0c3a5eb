// Random request streams: no illegal command, nothing lost, nothing served twice, reads return what
// their master wrote last, decisions in time order, same outcome each time.
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <memory>

#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

struct Outcome {
  std::vector<Logged> log;
  std::vector<Picoseconds> times;
  unsigned waited_at_input = 0;
};

mem::DdrConfig random_config(Rng& rng) {
  mem::DdrConfig c;
  auto& t = c.timing;
  t.CL = 2 + static_cast<unsigned>(rng.below(5));
  t.banks = rng.below(3) ? 8 : 4;
  c.bank_on_top = rng.below(3) == 0;
  c.page_log2 = 11;
  c.read_latency = static_cast<unsigned>(rng.below(8));
  c.refresh_interval = 300 + static_cast<unsigned>(rng.below(2000));
  constexpr unsigned kOldCounts[] = {0xFF, 0xFE, 0x20, 4, 0};
  c.old_count = kOldCounts[rng.below(5)];
  unsigned* fields[] = {&t.nRFC, &t.nRP,  &t.nRCD, &t.nWR, &t.nRAS,
                        &t.nRC,  &t.nRRD, &t.nWTR, &t.nRTP};
  for (unsigned* f : fields)
    *f = std::max<unsigned>(1, *f + static_cast<unsigned>(rng.below(4)) - 1);
  // Half of the runs enlarge a single number so that it binds.
  if (rng.below(2)) *fields[rng.below(9)] += 5 + static_cast<unsigned>(rng.below(40));
  return c;
}

/// One run; everything about it comes from the seed.
Outcome run(std::uint64_t seed, unsigned requests, const char* scheduler = "ti") {
  Rng rng(seed);
  BenchOptions o;
  o.params.emplace_back("scheduler", scheduler);
  o.config = random_config(rng);
  o.tFAW = 4 * o.config.timing.nRRD;  // what tRRD spacing alone guarantees
  if (o.config.timing.banks == 4) o.params.emplace_back("part", "mt47h32m16");
  o.params.emplace_back("request_latency", std::to_string(rng.below(12)) + " cycles");
  o.params.emplace_back("return_latency", std::to_string(rng.below(17)) + " cycles");
  o.params.emplace_back("command_fifo", std::to_string(1 + rng.below(10)));
  constexpr std::uint64_t kScr[] = {125'000'000, 250'000'000, 60'000'000, 121'500'000};
  o.scr = Frequency(kScr[rng.below(4)]);
  DdrBench b(o);

  const unsigned masters = 1 + static_cast<unsigned>(rng.below(6));
  const unsigned density = static_cast<unsigned>(rng.below(4));
  std::vector<std::unique_ptr<Request>> all;
  std::vector<std::vector<std::uint8_t>> expected;
  std::map<std::pair<unsigned, std::uint32_t>, std::uint8_t> shadow;  // per master: program order
  Picoseconds now = kTck;
  unsigned waited = 0;
  std::uint64_t bytes_read = 0, bytes_written = 0;
  for (unsigned i = 0; i < requests; ++i) {
    auto r = std::make_unique<Request>();
    const auto m = static_cast<unsigned>(rng.below(masters));
    r->master = static_cast<Master>(m);
    r->priority = rng.below(4) ? m % 3 : static_cast<unsigned>(rng.below(8));
    r->write = rng.below(5) < 2;
    r->bytes = 4u << rng.below(5);
    if (rng.below(8) == 0) r->bytes = 1u << rng.below(2);
    // A few rows of a few banks. All masters meet in the same rows; each owns every masters-th
    // 64-byte line of them.
    const std::uint32_t row = static_cast<std::uint32_t>(rng.below(3));
    const auto bank = static_cast<std::uint32_t>(rng.below(4));
    const auto line = static_cast<std::uint32_t>(rng.below(4)) * masters + m;
    const std::uint32_t size = static_cast<std::uint32_t>(b.store().size());
    const std::uint32_t block = o.config.bank_on_top
                                    ? bank * (size / o.config.timing.banks) + row * 2048u
                                    : at(row, bank, 0, o.config.timing.banks);
    r->address =
        block + line % 32 * 64u + static_cast<std::uint32_t>(rng.below(64 / r->bytes)) * r->bytes;
    if (!r->write && r->bytes >= 32)
      r->critical = static_cast<std::uint32_t>(rng.below(r->bytes / 16)) * 16u;
    std::vector<std::uint8_t> want(r->bytes);
    for (unsigned k = 0; k < r->bytes; ++k) {
      auto& cell = shadow[{m, r->address + k}];
      if (r->write) {
        cell = static_cast<std::uint8_t>(rng.next());
        r->data[k] = cell;
      }
      want[k] = cell;
    }
    (r->write ? bytes_written : bytes_read) += r->bytes;
    // Gaps: crowded, sparse, and sometimes long enough for refreshes in between.
    if (density == 0 || rng.below(3) == 0) now += rng.below(density == 3 ? 400'000 : 40'000);
    if (rng.below(100) == 0) now += rng.below(3 * o.config.refresh_interval) * kTck;
    while (b.input_taken()) {  // the next one may come when it was accepted
      const Picoseconds t = b.ddr.next_decision();
      if (t == kNever) {
        ADD_FAILURE() << "seed " << seed << ": a request in the input register is never accepted";
        return {};
      }
      b.step();
      now = std::max(now, t);
    }
    waited += !b.submit_at(*r, now);
    all.push_back(std::move(r));
    expected.push_back(std::move(want));
  }
  b.drain();
  b.checker.finish(b.now() / kTck);

  Outcome out;
  std::vector<Picoseconds> last_first(kMasterCount, 0);
  for (Request* r : b.read_order) {
    EXPECT_GE(r->first, last_first[index(r->master)]) << "reads of one master return in order";
    last_first[index(r->master)] = r->first;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Request& r = *all[i];
    EXPECT_TRUE(r.accepted) << "seed " << seed << " request " << i;
    EXPECT_EQ(r.done, r.write ? 0u : 1u) << "seed " << seed << " request " << i;
    if (!r.write) {
      EXPECT_EQ(std::memcmp(r.data.data(), expected[i].data(), r.bytes), 0)
          << "seed " << seed << " request " << i << ": read does not return the last write";
    }
    out.times.insert(out.times.end(), {r.accepted_at, r.first, r.last});
  }
  for (const auto& [where, value] : shadow)
    EXPECT_EQ(*b.store().at(where.second), value) << "seed " << seed << " final memory";
  EXPECT_EQ(b.accept_order.size(), all.size());
  for (std::size_t i = 0; i < b.accept_order.size(); ++i) {
    EXPECT_EQ(b.accept_order[i], all[i].get()) << "the input register keeps the order";
  }
  EXPECT_EQ(b.ddr.stats.read_bytes.count(), bytes_read);
  EXPECT_EQ(b.ddr.stats.write_bytes.count(), bytes_written);
  EXPECT_EQ(b.ddr.stats.bursts.count(), b.count(mem::Cmd::kRd) + b.count(mem::Cmd::kWr));
  EXPECT_EQ(b.ddr.stats.activates.count(), b.count(mem::Cmd::kAct));
  EXPECT_EQ(b.ddr.stats.refreshes.count(), b.count(mem::Cmd::kRef));
  EXPECT_EQ(b.ddr.stats.row_hits.count() + b.ddr.stats.row_misses.count() +
                b.ddr.stats.row_conflicts.count(),
            all.size());
  EXPECT_FALSE(b.went_back) << "seed " << seed;
  EXPECT_EQ(b.checker.total(), 0u) << "seed " << seed << "\n" << b.checker.text();
  out.log = b.log;
  out.waited_at_input = waited;
  return out;
}

constexpr unsigned kPerCase = 25;

class RandomStreamTest : public testing::TestWithParam<unsigned> {};

TEST_P(RandomStreamTest, IsServedLegallyOnceAndInOrder) {
  for (unsigned i = 0; i < kPerCase; ++i) {
    run(GetParam() * kPerCase + i + 1, 1200);
    if (HasFailure()) FAIL() << "first failing seed " << GetParam() * kPerCase + i + 1;
  }
}

// Where a master's requests pass each other: its reads still return its last writes, in order.
TEST(RandomStreamsTest, FrfcfsKeepsEachMastersDataAndOrder) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    run(seed, 1200, "frfcfs");
    if (HasFailure()) FAIL() << "first failing seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomStreamTest, testing::Range(0u, 8u));

TEST(RandomStreamsTest, SameSeedGivesTheSameCommandsAndTimes) {
  for (std::uint64_t seed : {3u, 17u, 101u}) {
    const Outcome a = run(seed, 600), b = run(seed, 600);
    ASSERT_GT(a.log.size(), 600u);
    EXPECT_TRUE(a.log == b.log);
    EXPECT_TRUE(a.times == b.times);
  }
}

// What the streams must contain for the test above to mean something.
TEST(RandomStreamsTest, StreamsReachEveryCommandAndTheInputRegister) {
  std::array<unsigned, mem::kCmdCount> commands{};
  unsigned waited = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Outcome o = run(seed, 600);
    for (const Logged& l : o.log) ++commands[static_cast<std::size_t>(l.cmd)];
    waited += o.waited_at_input;
  }
  for (const unsigned n : commands) EXPECT_GT(n, 100u);
  EXPECT_GT(waited, 1000u);
}

TEST(RandomStreamsTest, OtherSeedGivesOtherTimes) {
  EXPECT_FALSE(run(3, 600).times == run(4, 600).times) << "the comparison cannot fail";
}

// The checker is fed the model's own commands against a part that is one clock slower in a single
// number: it must complain, or the streams above prove nothing about that number.
TEST(RandomStreamsTest, CheckerComplainsWhenThePartIsOneClockSlower) {
  unsigned DataSheet::*const numbers[] = {
      &DataSheet::CL,   &DataSheet::tRCD, &DataSheet::tRP,  &DataSheet::tRAS, &DataSheet::tRC,
      &DataSheet::tRRD, &DataSheet::tWR,  &DataSheet::tWTR, &DataSheet::tRTP, &DataSheet::tRFC};
  for (const auto number : numbers) {
    BenchOptions o;
    o.config.timing.nRC = 17;  // binds: above tRAS + tRP = 16
    o.config.timing.nRTP = 3;
    o.config.refresh_interval = 200;
    DdrBench b(o);
    DataSheet slow = sheet_of(o.config);
    slow.tREFI = 0;
    slow.*number += 1;
    b.checker = CommandChecker(slow);
    Rng rng(5);
    std::vector<std::unique_ptr<Request>> all;
    Picoseconds now = kTck;
    for (unsigned i = 0; i < 3000; ++i) {
      auto r = std::make_unique<Request>();
      r->master = static_cast<Master>(rng.below(4));
      r->write = rng.below(2) != 0;
      r->address =
          at(static_cast<std::uint32_t>(rng.below(3)), static_cast<unsigned>(rng.below(4)));
      if (rng.below(8) == 0) now += rng.below(300) * kTck;
      while (b.input_taken()) {
        now = std::max(now, b.ddr.next_decision());
        b.step();
      }
      b.submit_at(*r, now);
      all.push_back(std::move(r));
    }
    b.drain();
    EXPECT_GT(b.checker.total(), 0u) << "number " << (&number - numbers);
  }
}

}  // namespace
}  // namespace fovea::dram
