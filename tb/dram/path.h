// Crossbar and DDR controller cores wired as the SoC wires them, without SystemC.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>

#include "model/bus/core/crossbar.h"
#include "model/mem/core/ddr_controller.h"

namespace fovea::dram {

struct PathRequest : MemRequest {
  unsigned responses = 0;
};

class Path : private bus::XbarHost, private mem::DdrClient {
 public:
  explicit Path(Frequency ddr_clock = Frequency(250'000'000),
                Frequency scr_clock = Frequency(125'000'000), const std::string& scheduler = "ti")
      : ddr_params_(scheduler),
        store(ddr_params_.size_bytes()),
        xbar(xbar_params_, *this),
        ddr(ddr_params_, store, *this) {
    xbar.set_clock(scr_clock, 0);
    ddr.set_clocks(ddr_clock, scr_clock, 0);
  }
  void submit(PathRequest& r, Picoseconds at) {
    r.issued = at;
    xbar.submit(r, bus::Slave::kDdr);
  }
  Picoseconds next_decision() const { return std::min(xbar.next_decision(), ddr.next_decision()); }
  void step() {
    if (xbar.next_decision() < ddr.next_decision())
      xbar.step();
    else
      ddr.step();
  }
  void run_before(Picoseconds at) {
    while (next_decision() < at) step();
  }
  void drain() { run_before(kNever); }

 private:
  Taken forward(MemRequest& r, Picoseconds arrival) override {
    mem::DdrRequest q;
    q.cookie = &r;
    q.master = r.master;
    q.priority = r.priority;
    q.write = r.write;
    q.bytes = r.bytes;
    q.address = r.address;
    q.data = r.data;
    q.parts = r.parts;
    return ddr.submit(q, arrival) ? Taken::kYes : Taken::kWaits;
  }
  void respond(MemRequest& r) override { ++static_cast<PathRequest&>(r).responses; }
  void ddr_accepted(void* cookie, Picoseconds at) override {
    static_cast<MemRequest*>(cookie)->door_opener = ddr.door_opener();
    xbar.slave_accepted(*static_cast<MemRequest*>(cookie), at);
  }
  void ddr_read_done(void* cookie, Picoseconds first, Picoseconds last) override {
    static_cast<MemRequest*>(cookie)->slave_waited = ddr.read_waited();
    xbar.slave_done(*static_cast<MemRequest*>(cookie), first, last, false);
  }
  bus::CrossbarParams xbar_params_;
  struct Params : mem::DdrParams {
    explicit Params(const std::string& order) {
      ParamSet set;
      set.add(*this);
      set.set("ddr.scheduler", order);
    }
  } ddr_params_;

 public:
  mem::BackingStore store;
  bus::Crossbar xbar;
  mem::DdrController ddr;
};

}  // namespace fovea::dram
