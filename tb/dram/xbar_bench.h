// The crossbar core with a slave that only notes what comes.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/bus/core/crossbar.h"

namespace fovea::dram {

using bus::Slave;
constexpr Picoseconds kEdge = 10'000;  // 100 MHz: edge k at k * kEdge

struct Event {
  Master master;
  Slave slave;
  std::uint64_t granted, arrival;  // edges
};
struct Answer {
  Master master;
  std::uint64_t first, last;  // edges
  bool error;
};

class XbarBench {
 public:
  explicit XbarBench(std::vector<std::pair<std::string, std::string>> params = {})
      : params_(params), xbar(params_) {
    xbar.set_clock(Frequency(100'000'000), 0);
  }
  /// On the port's wires at edge `edge`: the crossbar's next edge is the first to see it.
  void submit(Master m, std::uint64_t edge, bool write = false, unsigned bytes = 8,
              Slave slave = Slave::kDdr, bool locked = false) {
    requests_.push_back(std::make_unique<MemRequest>());
    MemRequest& r = *requests_.back();
    r.master = m;
    r.write = write;
    r.bytes = static_cast<std::uint8_t>(bytes);
    r.issued = edge * kEdge;
    r.locked = locked;
    xbar.submit(r, slave);
  }
  void run(std::uint64_t until = ~std::uint64_t{0} / kEdge) {
    while (xbar.next_decision() < until * kEdge) {
      granted_ = xbar.next_decision();
      xbar.step(*this);
    }
  }
  std::vector<Event> events;
  std::vector<Answer> answers;
  std::vector<MemRequest*> sent;
  bool ddr_accepts = true, refuses = false;

 private:
  struct Params : bus::CrossbarParams {
    explicit Params(const std::vector<std::pair<std::string, std::string>>& list) {
      ParamSet set;
      set.add(*this);
      for (const auto& [key, value] : list) set.set(key, value);
    }
  };

 public:
  /// The crossbar's slaves and masters.
  Taken forward(MemRequest& r, Picoseconds arrival) {
    EXPECT_EQ(arrival % kEdge, 0u);
    const auto slave = static_cast<Slave>(r.in_path.slave);
    events.push_back({r.master, slave, granted_ / kEdge, arrival / kEdge});
    sent.push_back(&r);
    if (refuses) return Taken::kRefused;
    return slave != Slave::kDdr || ddr_accepts ? Taken::kYes : Taken::kWaits;
  }
  void respond(MemRequest& r) {
    answers.push_back({r.master, r.first / kEdge, r.last / kEdge, r.error});
  }

 private:
  std::vector<std::unique_ptr<MemRequest>> requests_;
  Params params_;
  Picoseconds granted_ = 0;

 public:
  bus::Crossbar xbar;
};

}  // namespace fovea::dram
