// The crossbar grants a request in two places: one by one from its queues, and at once where nothing
// contends with it. Both must leave the same outcome, the same statistics and the same state behind,
// from any state that random traffic leads to.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "model/bus/core/crossbar.h"
#include "tb/dram/bench.h"

namespace fovea::dram {
namespace {

using bus::Crossbar;
using bus::Slave;

struct Params : bus::CrossbarParams {
  explicit Params(Rng& rng) {
    for (auto& p : ports) {
      p->request_latency.set(std::to_string(rng.below(4)) + " cycles");
      p->response_latency.set(std::to_string(rng.below(4)) + " cycles");
      constexpr const char* kWidths[] = {"16bit", "32bit", "64bit"};
      p->width.set(kWidths[rng.below(3)]);
    }
  }
};

/// What a random program asks for, without what becomes of it.
struct Ask {
  Master master;
  Slave slave;
  bool write, locked, attributed;
  unsigned bytes;
  Picoseconds at;
  // What the slave does with it.
  bool refused, waits;
  Picoseconds wait, service;
};

/// A crossbar before slaves whose behaviour the request itself decides. `direct`: requests that nothing
/// contends with are granted at once.
class Side {
 public:
  struct Record : MemRequest {
    Ask ask;
    RequestWaits waited;
    bool answered = false;
  };
  Side(const Params& params, bool direct) : xbar(params), direct_(direct) {}

  /// Takes everything strictly before `limit`: arbitrations, acceptances and the ends of reads.
  void run_before(Picoseconds limit) {
    for (;;) {
      const Picoseconds slave = acts_.empty() ? kNever : acts_.begin()->first;
      const Picoseconds own = xbar.next_decision();
      if (std::min(slave, own) >= limit) return;
      if (own <= slave) {
        xbar.step(*this);
        continue;
      }
      const auto [at, act] = *acts_.begin();
      acts_.erase(acts_.begin());
      if (act.accepts)
        accept(*act.record, at);
      else
        xbar.slave_done(*this, *act.record, {at, at + act.record->ask.service, 0, false});
    }
  }
  /// @return true if it was granted at once
  bool put(const Ask& ask) {
    auto& r = *records.emplace_back(std::make_unique<Record>());
    r.ask = ask;
    r.master = ask.master;
    r.write = ask.write;
    r.locked = ask.locked;
    r.bytes = static_cast<std::uint8_t>(ask.bytes);
    r.issued = ask.at;
    if (ask.attributed) r.parts = &r.waited;
    r.waited.clear();
    const Crossbar::UncontendedGrant g =
        ask.slave == Slave::kDdr ? xbar.uncontended_grant(r) : Crossbar::UncontendedGrant{};
    if (g.at == kNever) {
      xbar.submit(r, ask.slave);
      return false;
    }
    if (direct_) {
      const bool over =
          ask.write ? xbar.grant_uncontended<true>(*this, r, g) : xbar.grant_uncontended<false>(*this, r, g);
      if (over) respond(r);
    } else {
      xbar.submit(r, ask.slave);
      EXPECT_EQ(xbar.next_decision(), g.at);
      xbar.step(*this);
    }
    return true;
  }

  Taken forward(MemRequest& r, Picoseconds arrival) {
    auto& record = static_cast<Record&>(r);
    events.emplace_back(index(r.master), arrival, r.in_path.priority);
    if (record.ask.refused) return Taken::kRefused;
    if (record.ask.waits) {
      plan(arrival + record.ask.wait, {&record, true});
      return Taken::kWaits;
    }
    serve(record, arrival);
    return Taken::kYes;
  }
  void respond(MemRequest& r) {
    auto& record = static_cast<Record&>(r);
    EXPECT_FALSE(record.answered);
    record.answered = true;
    events.emplace_back(100 + index(r.master), r.first, r.last);
  }

  Crossbar xbar;
  std::vector<std::unique_ptr<Record>> records;
  std::vector<std::tuple<std::size_t, Picoseconds, Picoseconds>> events;

 private:
  struct Act {
    Record* record;
    bool accepts;
  };
  void plan(Picoseconds at, Act act) { acts_.emplace(at, act); }
  void accept(Record& r, Picoseconds at) {
    xbar.slave_accepted(*this, r, at, Master::kVpbe);
    serve(r, at);
  }
  void serve(Record& r, Picoseconds at) {
    if (!r.write || r.ask.slave != Slave::kDdr) plan(at + r.ask.service + 1, {&r, false});
  }

  bool direct_;
  std::multimap<Picoseconds, Act> acts_;
};

void expect_same_state(Side& a, Side& b, Picoseconds now) {
  ASSERT_EQ(a.xbar.next_decision(), b.xbar.next_decision());
  const Crossbar::View va = a.xbar.view(now), vb = b.xbar.view(now);
  EXPECT_EQ(va.next, vb.next);
  EXPECT_EQ(va.items.size(), vb.items.size());
  for (std::size_t s = 0; s < bus::kSlaveCount; ++s) {
    EXPECT_EQ(va.slaves[s].blocked, vb.slaves[s].blocked);
    EXPECT_EQ(va.slaves[s].free, vb.slaves[s].free);
    EXPECT_EQ(va.slaves[s].granted, vb.slaves[s].granted);
    EXPECT_EQ(va.slaves[s].locked_by, vb.slaves[s].locked_by);
  }
  ASSERT_EQ(a.events, b.events);
}

void expect_same_figures(const Side& a, const Side& b) {
  for (std::size_t m = 0; m < kMasterCount; ++m) {
    EXPECT_EQ(a.xbar.waits[m].read.ps, b.xbar.waits[m].read.ps) << kMasterNames[m];
    EXPECT_EQ(a.xbar.waits[m].write.ps, b.xbar.waits[m].write.ps) << kMasterNames[m];
    for (const auto direction : {&bus::PortLatencies::read, &bus::PortLatencies::write})
      for (const auto beat : {&bus::BeatLatencies::first, &bus::BeatLatencies::last}) {
        const bus::LatencyHistogram& of_a = a.xbar.latencies[m].*direction.*beat;
        const bus::LatencyHistogram& of_b = b.xbar.latencies[m].*direction.*beat;
        EXPECT_EQ(of_a.count(), of_b.count()) << kMasterNames[m];
        EXPECT_EQ(of_a.mean(), of_b.mean()) << kMasterNames[m];
        EXPECT_EQ(of_a.max(), of_b.max()) << kMasterNames[m];
      }
  }
  for (std::size_t s = 0; s < kStatCount; ++s) {
    EXPECT_EQ(a.xbar.stats[s]->transactions.count(), b.xbar.stats[s]->transactions.count());
    EXPECT_EQ(a.xbar.stats[s]->read_bytes.count(), b.xbar.stats[s]->read_bytes.count());
    EXPECT_EQ(a.xbar.stats[s]->write_bytes.count(), b.xbar.stats[s]->write_bytes.count());
  }
  ASSERT_EQ(a.records.size(), b.records.size());
  for (std::size_t i = 0; i < a.records.size(); ++i) {
    const Side::Record &ra = *a.records[i], &rb = *b.records[i];
    ASSERT_EQ(ra.answered, rb.answered) << i;
    if (!ra.answered) continue;
    EXPECT_EQ(ra.first, rb.first) << i;
    EXPECT_EQ(ra.last, rb.last) << i;
    EXPECT_EQ(ra.error, rb.error) << i;
    EXPECT_EQ(ra.in_path.priority, rb.in_path.priority) << i;
    EXPECT_EQ(ra.in_path.slave, rb.in_path.slave) << i;
    EXPECT_EQ(ra.in_path.accepted_at, rb.in_path.accepted_at) << i;
    for (std::size_t c = 0; c < kCulprits; ++c)
      EXPECT_EQ(ra.waited.ps(static_cast<Culprit>(c)), rb.waited.ps(static_cast<Culprit>(c)))
          << i << ' ' << culprit_name(static_cast<Culprit>(c));
  }
}

Ask random_ask(Rng& rng, Picoseconds at) {
  Ask a{};
  a.master = static_cast<Master>(rng.below(kMasterCount));
  a.slave = rng.below(8) == 0 ? Slave::kConfig : Slave::kDdr;
  a.write = rng.below(2);
  a.attributed = rng.below(2);
  a.bytes = 1u << rng.below(7);
  a.at = at;
  a.refused = a.slave == Slave::kDdr && rng.below(20) == 0;
  a.waits = !a.refused && rng.below(6) == 0;
  a.wait = 1 + rng.below(200'000);
  a.service = rng.below(150'000);
  return a;
}

TEST(GrantTest, AtOnceAndFromTheQueuesAreTheSameOnRandomStates) {
  unsigned direct[2] = {}, waiting = 0, others = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Rng rng(seed);
    const Params params(rng);
    Side a(params, true), b(params, false);
    const Frequency scr(90'000'000 + rng.below(80'000'000));
    for (Side* s : {&a, &b}) s->xbar.set_clock(scr, 0);
    Picoseconds now = 1'000;
    const Picoseconds gap = 1'000 << rng.below(8);
    for (unsigned n = 0; n < 200; ++n) {
      now += rng.below(gap);
      a.run_before(now);
      b.run_before(now);
      ASSERT_NO_FATAL_FAILURE(expect_same_state(a, b, now)) << seed << ' ' << n;
      if (rng.below(16) == 0) {
        const auto m = static_cast<Master>(rng.below(kMasterCount));
        const auto level = static_cast<unsigned>(rng.below(8));
        for (Side* s : {&a, &b}) s->xbar.set_priority(m, level);
      }
      const Ask ask = random_ask(rng, now);
      others += a.xbar.next_decision() != kNever;
      const bool at_once = a.put(ask);
      ASSERT_EQ(at_once, b.put(ask));
      direct[ask.write] += at_once;
      waiting += at_once && ask.waits;
      ASSERT_NO_FATAL_FAILURE(expect_same_state(a, b, now)) << seed << ' ' << n;
    }
    a.run_before(kNever);
    b.run_before(kNever);
    ASSERT_NO_FATAL_FAILURE(expect_same_figures(a, b)) << seed;
  }
  // The comparison is not empty: both directions, a full slave, and others planned behind.
  EXPECT_GT(direct[0], 2'000u);
  EXPECT_GT(direct[1], 2'000u);
  EXPECT_GT(waiting, 500u);
  EXPECT_GT(others, 3'000u);
}

}  // namespace
}  // namespace fovea::dram
