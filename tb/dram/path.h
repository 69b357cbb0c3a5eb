// Crossbar and DDR controller cores wired as the SoC wires them, without SystemC.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "model/bus/core/crossbar.h"
#include "model/mem/core/ddr_controller.h"

namespace fovea::dram {

struct PathRequest {
  bus::XbarRequest bus;
  std::uint32_t address = 0;
  std::uint8_t* data = nullptr;
  unsigned responses = 0;
  Picoseconds first = 0, last = 0;
};

class Path : private bus::XbarHost, private mem::DdrClient {
 public:
  explicit Path(Frequency ddr_clock = Frequency(250'000'000),
                Frequency scr_clock = Frequency(125'000'000))
      : store(ddr_params_.size_bytes()), xbar(xbar_params_, *this), ddr(ddr_params_, store, *this) {
    xbar.set_clock(scr_clock, 0);
    ddr.set_clocks(ddr_clock, scr_clock, 0);
  }
  void submit(PathRequest& r, Picoseconds at) {
    r.bus.cookie = &r;
    xbar.submit(r.bus, at);
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
  bool forward(const bus::XbarRequest& r, Picoseconds arrival) override {
    auto& p = *static_cast<PathRequest*>(r.cookie);
    mem::DdrRequest q;
    q.cookie = &p;
    q.master = r.master;
    q.priority = r.priority;
    q.write = r.write;
    q.bytes = r.bytes;
    q.address = p.address;
    q.data = p.data;
    return ddr.submit(q, arrival);
  }
  void respond(const bus::XbarRequest& r, Picoseconds first, Picoseconds last, bool) override {
    auto& p = *static_cast<PathRequest*>(r.cookie);
    ++p.responses;
    p.first = first;
    p.last = last;
  }
  void ddr_accepted(void* cookie, Picoseconds at) override {
    xbar.slave_accepted(static_cast<PathRequest*>(cookie)->bus, at);
  }
  void ddr_read_done(void* cookie, Picoseconds first, Picoseconds last) override {
    xbar.slave_done(static_cast<PathRequest*>(cookie)->bus, first, last, false);
  }
  bus::CrossbarParams xbar_params_;
  mem::DdrParams ddr_params_;

 public:
  mem::BackingStore store;
  bus::Crossbar xbar;
  mem::DdrController ddr;
};

}  // namespace fovea::dram
