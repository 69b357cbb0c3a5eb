// Who waited for whom under load: the tables against a count clock by clock, from what can be seen
// from outside.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "model/bus/core/crossbar.h"
#include "model/bus/wait_stats.h"
#include "model/mem/core/ddr_controller.h"
#include "tb/dram/bench.h"
#include "tb/dram/path.h"

namespace fovea::dram {
namespace {

void expect_equal(const WaitTable& counted, const WaitTable& table, std::uint64_t seed) {
  for (std::size_t m = 0; m < kMasterCount; ++m)
    for (std::size_t c = 0; c < kCulprits; ++c) {
      EXPECT_EQ(table[m].read.ps[c], counted[m].read.ps[c])
          << "seed " << seed << ", reads of " << kMasterNames[m] << ", culprit " << c;
      EXPECT_EQ(table[m].write.ps[c], counted[m].write.ps[c])
          << "seed " << seed << ", writes of " << kMasterNames[m] << ", culprit " << c;
    }
}

/// A crossbar before a slave that is busy at times. Edges have 10 ns.
class BusyBus {
 public:
  static constexpr Picoseconds kEdge = 10'000;
  explicit BusyBus(std::uint64_t seed) : rng_(seed), xbar_(params_) {
    xbar_.set_clock(Frequency(100'000'000), 0);
  }
  /// Four masters in turn with up to four requests each: none waits for more grants than are kept.
  void run(unsigned requests) {
    for (Picoseconds now = kEdge; answered_ < requests; now += kEdge / 2) {
      while (std::min(xbar_.next_decision(), opens_) < now) {
        if (opens_ <= xbar_.next_decision())
          open();
        else
          step();
      }
      const auto m = static_cast<std::size_t>(rng_.below(4) * 2 + 2);  // 64-bit ports
      if (rng_.below(3) == 0 || outstanding_[m] == 4) continue;
      ++outstanding_[m];
      requests_.push_back(std::make_unique<MemRequest>());
      MemRequest& r = *requests_.back();
      r.master = static_cast<Master>(m);
      r.write = rng_.below(2);
      r.bytes = static_cast<std::uint8_t>(8 << rng_.below(4));
      r.issued = now;
      xbar_.submit(r, bus::Slave::kDdr);
    }
  }
  const WaitTable& table() const { return xbar_.waits; }
  WaitTable counted{};

 private:
  void step() {
    granted_ = xbar_.next_decision() / kEdge;
    xbar_.step(*this);
  }
  void count(const MemRequest& r) {
    Waits& w = r.write ? counted[index(r.master)].write : counted[index(r.master)].read;
    const std::uint64_t latency =
        static_cast<std::uint64_t>(params_.ports[index(r.master)]->request_latency());
    const std::uint64_t crossed = r.issued / kEdge + 1 + latency;
    w.add(Culprit::kBridge, crossed * kEdge - r.issued);
    for (std::uint64_t edge = crossed; edge < granted_; ++edge) {
      const auto had = had_bus_.find(edge);
      w.add(culprit(had == had_bus_.end() ? r.master : had->second), kEdge);
    }
  }

 public:
  /// The crossbar's slave.
  Taken forward(MemRequest& r, Picoseconds arrival) {
    count(r);
    at_input_ = &r;
    for (std::uint64_t edge = granted_; edge < arrival / kEdge; ++edge) had_bus_[edge] = r.master;
    Waits& w = r.write ? counted[index(r.master)].write : counted[index(r.master)].read;
    w.add(Culprit::kService, arrival - granted_ * kEdge);
    blocked_from_ = arrival / kEdge;
    if (rng_.below(3) == 0) {
      opens_ = arrival + (1 + rng_.below(12)) * kEdge - rng_.below(kEdge);
      return Taken::kWaits;
    }
    finish(r, arrival);
    return Taken::kYes;
  }
  void respond(MemRequest& r) {
    ++answered_;
    --outstanding_[index(r.master)];
  }

 private:
  void open() {
    const Picoseconds at = std::exchange(opens_, kNever);
    MemRequest& r = *at_input_;
    const auto unblocked_by = static_cast<Master>(rng_.below(kMasterCount));
    const std::uint64_t taken = at / kEdge + 1;
    for (std::uint64_t edge = blocked_from_; edge < taken; ++edge) had_bus_[edge] = r.master;
    Waits& w = r.write ? counted[index(r.master)].write : counted[index(r.master)].read;
    w.add(culprit(unblocked_by), (taken - blocked_from_) * kEdge);
    xbar_.slave_accepted(*this, r, at, unblocked_by);
    finish(r, taken * kEdge);
  }
  /// A read's data come at once; a write is acknowledged by the crossbar.
  void finish(MemRequest& r, Picoseconds at) {
    const auto latency =
        static_cast<std::uint64_t>(params_.ports[index(r.master)]->response_latency());
    Waits& w = r.write ? counted[index(r.master)].write : counted[index(r.master)].read;
    w.add(Culprit::kBridge, latency * kEdge);
    if (!r.write) xbar_.slave_done(*this, r, {at, at, 0, false});
  }

  Rng rng_;
  bus::CrossbarParams params_;
  bus::Crossbar xbar_;
  std::vector<std::unique_ptr<MemRequest>> requests_;
  std::map<std::uint64_t, Master> had_bus_;  // by edge
  std::array<unsigned, kMasterCount> outstanding_{};
  std::uint64_t granted_ = 0, blocked_from_ = 0;
  MemRequest* at_input_ = nullptr;
  Picoseconds opens_ = kNever;
  unsigned answered_ = 0;
};

TEST(LoadedWaitsTest, CrossbarTagsEachEdgeWithWhoHadTheDataBus) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    BusyBus bus(seed);
    bus.run(400);
    expect_equal(bus.counted, bus.table(), seed);
    EXPECT_GT(bus.counted[4].read.ps[index(culprit(Master::kEdmaTc0Read))], 0u);
  }
}

/// Eight masters, each with one request at a time in a bank of its own: a command's bank says whose
/// it is. DDR clocks have 4 ns, the crossbar's 8 ns.
class Banks {
 public:
  static constexpr Picoseconds kClock = 4'000;
  /// `looks`: the statistics are read in between, as by a debugger or at the kernel's turn.
  explicit Banks(std::uint64_t seed, bool looks = false)
      : rng_(seed), look_(seed + 1), looks_(looks), store_(params_.size_bytes()), ddr_(params_, store_, {}) {
    ddr_.set_clocks(Frequency(250'000'000), Frequency(125'000'000), 0);
    mem::DdrConfig config;
    config.refresh_interval = 400;
    ddr_.configure(config, 0);
    write_clocks_ = config.timing.WL() + mem::DdrTiming::kBurstClocks;
    listening_ = ddr_.observe_commands(
        [](void* self, mem::Cmd c, unsigned bank, std::uint32_t, std::uint64_t clock) {
          static_cast<Banks*>(self)->command(c, bank, clock);
        },
        this);
  }
  void run(unsigned requests) {
    for (Picoseconds now = kClock; done_ < requests; now += kClock * 3 / 2) {
      while (ddr_.next_decision() < now) {
        if (looks_ && look_.below(3)) look_before(ddr_.next_decision());
        step();
      }
      if (looks_) look_before(now);
      const auto m = static_cast<unsigned>(rng_.below(8));
      Request& r = requests_[m];
      if (r.busy || input_ != nullptr || rng_.below(4) == 0) continue;
      r.busy = true;
      MemRequest& q = r.path;
      q.master = static_cast<Master>(m);
      q.in_path.priority = static_cast<std::uint8_t>(rng_.below(3));
      q.write = rng_.below(3) == 0;
      r.left = 1 + static_cast<unsigned>(rng_.below(4));
      q.bytes = static_cast<std::uint8_t>(16 * r.left);
      const std::uint32_t offset = m << 11 | static_cast<std::uint32_t>(rng_.below(3)) << 14;
      q.data = r.data.data();
      r.arrived = now / kClock + 1;
      if (!ddr_.submit(q, offset, now)) input_ = &r;
    }
  }
  const WaitTable& table() const { return ddr_.waits(); }
  WaitTable counted{};
  std::uint64_t longest = 0;  // commands that one read waited for

 private:
  struct Request {
    MemRequest path;
    bool busy = false;
    std::uint64_t arrived = 0;  // clock
    unsigned left = 0;  // columns to come
    bool begun = false;
    std::array<std::uint8_t, 64> data{};
  };
  struct Given {
    mem::Cmd cmd;
    unsigned bank;
  };
  void look_before(Picoseconds end) {
    looked_ = std::max(looked_, end - look_.below(12 * kClock));
    if (looked_ < end) ddr_.catch_up(looked_);
  }
  void command(mem::Cmd c, unsigned bank, std::uint64_t clock) {
    if (c == mem::Cmd::kRd && !requests_[bank].begun) count(bank, clock);
    given_[clock] = {c, bank};
    if (c != mem::Cmd::kRd && c != mem::Cmd::kWr) return;
    Request& r = requests_[bank];
    r.begun = --r.left > 0;
    if (r.begun) return;
    r.busy = false;
    ++done_;
  }
  void count(unsigned m, std::uint64_t clock) {
    Waits& w = counted[m].read;
    const std::uint64_t ready =
        requests_[m].arrived + static_cast<std::uint64_t>(params_.request_latency());
    bool closed = false;  // a row was, for this read
    std::uint64_t commands = 0;
    for (auto g = given_.lower_bound(ready); g != given_.end(); ++g, ++commands)
      closed |= g->second.cmd == mem::Cmd::kPre && g->second.bank == m;
    longest = std::max(longest, commands);
    for (std::uint64_t k = ready; k < clock; ++k) {
      auto g = given_.upper_bound(k);
      if (g == given_.begin()) {
        w.add(static_cast<Culprit>(m), kClock);
        continue;
      }
      --g;
      const auto [cmd, bank] = g->second;
      Culprit culprit = static_cast<Culprit>(bank);
      if (cmd == mem::Cmd::kRef || cmd == mem::Cmd::kPreAll)
        culprit = Culprit::kRefresh;
      else if (cmd == mem::Cmd::kWr && k >= g->first + write_clocks_)
        culprit = Culprit::kTurnaround;
      else if (bank == m && g->first >= ready)
        culprit = closed ? Culprit::kRowConflict : Culprit::kRowMiss;
      w.add(culprit, kClock);
    }
  }
  void step() {
    ddr_.step();
    if (const auto& accepted = ddr_.news().accepted) {
      EXPECT_EQ(accepted->request, &input_->path);
      input_->arrived = std::max(input_->arrived, accepted->at / kClock + 1);
      input_ = nullptr;
    }
    ddr_.news().clear();
  }

  Rng rng_, look_;
  bool looks_;
  Picoseconds looked_ = 0;
  mem::DdrParams params_;
  mem::BackingStore store_;
  mem::DdrController ddr_;
  Subscription listening_;
  std::map<std::uint64_t, Given> given_;  // by clock
  std::array<Request, 8> requests_;
  Request* input_ = nullptr;
  std::uint64_t write_clocks_ = 0;
  unsigned done_ = 0;
};

TEST(LoadedWaitsTest, ControllerTagsEachClockWithTheCommandBefore) {
  Picoseconds turned = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Banks banks(seed);
    banks.run(400);
    expect_equal(banks.counted, banks.table(), seed);
    EXPECT_GT(banks.counted[0].read.ps[index(Culprit::kRowConflict)], 0u);
    EXPECT_GT(banks.longest, 8u);
    for (const MasterWaits& w : banks.counted) turned += w.read.ps[index(Culprit::kTurnaround)];
  }
  EXPECT_GT(turned, 0u);
}

// A read without other requests beside it: from the commands that are seen, whenever it comes.
TEST(LoneWaitsTest, ARefreshUnderWayIsWhatItWaitsFor) {
  constexpr Master kReader = Master::kVpbe;
  BenchOptions o;
  o.config.refresh_interval = 400;
  o.params = {{"request_latency", "0 cycles"}};
  unsigned behind_refresh = 0;
  for (unsigned k = 0; k < 400; ++k) {
    DdrBench b(o);
    Request r;
    r.master = kReader;
    r.address = at(1, 1);
    b.submit(r, 2000 + k);
    b.drain();
    const std::uint64_t ready = 2000 + k + 1;
    std::uint64_t refresh = 0, act = 0, column = 0;
    for (const Logged& l : b.log) {
      if (l.cmd == mem::Cmd::kRef && act == 0) refresh = l.clock;
      if (l.cmd == mem::Cmd::kAct) act = l.clock;
      if (l.cmd == mem::Cmd::kRd && column == 0) column = l.clock;
    }
    if (refresh > ready || act == ready) continue;  // it does not wait for one that was under way
    ++behind_refresh;
    const Waits& w = b.ddr.waits()[index(kReader)].read;
    EXPECT_EQ(w.ps[index(Culprit::kRefresh)], (act - ready) * kTck) << k;
    EXPECT_EQ(w.ps[index(Culprit::kRowMiss)], (column - act) * kTck) << k;
    EXPECT_EQ(w.ps[index(Culprit::kTurnaround)], 0u) << k;
  }
  EXPECT_GT(behind_refresh, 20u);
}

/// Four masters with up to six requests each on crossbar and controller.
struct Crowd {
  Path path;
  WaitTable counted{};  // from the requests' own parts
  Picoseconds waited = 0;
  unsigned reads = 0;
  explicit Crowd(const std::string& scheduler)
      : path(Frequency(243'000'000), Frequency(121'500'000), scheduler) {}
  void run(std::uint64_t seed) {
    Rng rng(seed);
    struct Slot {
      PathRequest request;
      RequestWaits parts;
      std::array<std::uint8_t, 64> data{};
      bool busy = false;
    };
    std::array<std::array<Slot, 6>, 4> slots;
    std::array<Picoseconds, 4> newest{};
    std::array<std::vector<Slot*>, 4> order;  // reads, as issued
    for (Picoseconds now = 10'000; reads < 1500; now += rng.below(40'000)) {
      path.run_before(now);
      for (auto& of_master : slots)
        for (Slot& s : of_master)
          if (s.request.write && s.request.responses) s.busy = false;
      for (unsigned m = 0; m < 4; ++m)
        for (; !order[m].empty() && order[m].front()->request.responses;
             order[m].erase(order[m].begin())) {
          Slot& s = *order[m].front();
          const PathRequest& r = s.request;
          ASSERT_EQ(s.parts.total(), r.first - r.issued) << "seed " << seed;
          ASSERT_GT(r.first, newest[m]) << "in the order of issue, seed " << seed;
          newest[m] = r.last;
          waited += r.first - r.issued;
          s.parts.each([&](Culprit c, Picoseconds t) { counted[index(r.master)].read.add(c, t); });
          s.busy = false;
          ++reads;
        }
      const auto m = static_cast<unsigned>(rng.below(4));
      for (Slot& s : slots[m]) {
        if (s.busy) continue;
        PathRequest& r = s.request = {};
        r.master = static_cast<Master>(2 * m + 2);  // 64-bit ports
        r.write = rng.below(4) == 0;
        r.bytes = static_cast<std::uint8_t>(16u << rng.below(3));
        r.address =
            at(static_cast<std::uint32_t>(rng.below(3)), static_cast<unsigned>(rng.below(2)),
               static_cast<std::uint32_t>(rng.below(4)) * 64);
        r.data = s.data.data();
        r.parts = &s.parts;
        s.parts.clear();
        s.busy = true;
        path.submit(r, now);
        if (!r.write) order[m].push_back(&s);
        break;
      }
    }
    for (const auto& list : order)
      for (const Slot* s : list) {
        while (s->request.responses == 0) path.step();
        s->parts.each(
            [&](Culprit c, Picoseconds t) { counted[index(s->request.master)].read.add(c, t); });
      }
    path.drain();
  }
};

// Each read's parts are its latency to its first data, and the tables are the parts of all: with
// `frfcfs` the time behind older reads of the master too.
TEST(LoadedWaitsTest, PartsOfEachReadAddUpWithAnyScheduler) {
  std::map<std::string, Picoseconds> own;
  for (const char* scheduler : {"ti", "fcfs", "frfcfs", "closed_page"})
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      Crowd crowd(scheduler);
      crowd.run(seed);
      if (HasFatalFailure()) FAIL() << scheduler;
      for (std::size_t m = 0; m < kMasterCount; ++m) {
        own[scheduler] += crowd.path.ddr.waits()[m].read.ps[m];
        for (std::size_t c = 0; c < kCulprits; ++c)
          ASSERT_EQ(crowd.counted[m].read.ps[c],
                    crowd.path.ddr.waits()[m].read.ps[c] + crowd.path.xbar.waits[m].read.ps[c])
              << scheduler << ", seed " << seed << ", master " << m << ", culprit " << c;
      }
    }
  EXPECT_GT(own["frfcfs"], 0u);
}

// The data of a write burst are one piece: no turnaround lies between its columns, whether or not
// the statistics were read between them.
TEST(LoadedWaitsTest, LookingInBetweenMovesNoWait) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Banks alone(seed), watched(seed, true);
    alone.run(400);
    watched.run(400);
    expect_equal(watched.counted, watched.table(), seed);
    expect_equal(alone.table(), watched.table(), seed);
  }
}

// Both sides of a transfer controller are one master; another one's waits are not its own. Nothing is
// exactly 0, and a picosecond is one.
TEST(WaitStatsTest, EachStatisticIsTheSumOfItsOwnTables) {
  WaitTable crossbar{}, memory{};
  bus::WaitStats stats(Master::kEdmaTc0Read, {&crossbar, &memory});
  const auto value = [&](const std::string& name) {
    for (const StatBase* s : stats.stats())
      if (s->name() == "ddr.edma_tc0.wait." + name) return std::get<double>(s->value());
    ADD_FAILURE() << "no " << name;
    return -1.0;
  };
  for (const StatBase* s : stats.stats()) EXPECT_EQ(std::get<double>(s->value()), 0.0) << s->name();
  EXPECT_EQ(stats.stats()[0]->sentence(),
            "total time that edma_tc0's reads spent between port and crossbar, both ways");
  crossbar[index(Master::kEdmaTc0Read)].read.add(Culprit::kBridge, 3);
  memory[index(Master::kEdmaTc0Write)].read.add(Culprit::kBridge, 4);
  memory[index(Master::kEdmaTc0Write)].write.add(Culprit::kRefresh, 1);
  memory[index(Master::kEdmaTc0Read)].read.add(culprit(Master::kEdmaTc0Write), 20);
  memory[index(Master::kEdmaTc0Read)].read.add(culprit(Master::kVpfe), 300);
  memory[index(Master::kVpfe)].read.add(Culprit::kBridge, 5'000);
  EXPECT_DOUBLE_EQ(value("read.bridge"), 7e-12);
  EXPECT_DOUBLE_EQ(value("write.bridge"), 0.0);
  EXPECT_DOUBLE_EQ(value("write.refresh"), 1e-12);
  EXPECT_DOUBLE_EQ(value("read.own"), 20e-12);
  EXPECT_DOUBLE_EQ(value("read.vpfe"), 300e-12);
  stats.reset();
  EXPECT_DOUBLE_EQ(value("read.bridge"), 0.0);
  EXPECT_EQ(memory[index(Master::kVpfe)].read.ps[index(Culprit::kBridge)], 5'000u) << "another's";
}

}  // namespace
}  // namespace fovea::dram
