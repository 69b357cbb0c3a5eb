// The memory system with the parameters' default values, except for the scheduler.
#pragma once
#include <string>

#include "model/memsys/memory_system.h"

namespace fovea::dram {

struct PathRequest : MemRequest {
  unsigned responses = 0;
};

/// Requests are PathRequests; addresses count from the beginning of the SDRAM.
class Path : private memsys::MemoryHost {
 public:
  explicit Path(Frequency ddr_clock = Frequency(250'000'000), Frequency scr_clock = Frequency(125'000'000),
                const std::string& scheduler = "ti")
      : ddr_params_(scheduler), memory(xbar_params_, ddr_params_, {.ddr_base = 0}, *this, diagnostics) {
    xbar.set_clock(scr_clock, 0);
    ddr.set_clocks(ddr_clock, scr_clock, 0);
  }
  void submit(PathRequest& r, Picoseconds at) {
    r.issued = at;
    memory.submit(r);
  }
  Picoseconds next_decision() const { return memory.next_event(); }
  /// Takes the events of the next instant that has any.
  void step() { run_before(next_decision() + 1); }
  void run_before(Picoseconds at) { memory.advance_through(at); }
  void drain() { run_before(kNever); }
  Diagnostics diagnostics;  ///< of the memory system

 private:
  void completed(MemRequest& r) override { ++static_cast<PathRequest&>(r).responses; }
  Taken deliver(MemRequest&, bus::Slave, Picoseconds) override { return Taken::kRefused; }
  bus::CrossbarParams xbar_params_;
  struct Params : mem::DdrParams {
    explicit Params(const std::string& order) {
      ParamSet set;
      set.add(*this);
      set.set("ddr.scheduler", order);
    }
  } ddr_params_;

 public:
  memsys::MemorySystem memory;
  mem::BackingStore& store = memory.store();
  bus::Crossbar& xbar = memory.crossbar();
  mem::DdrController& ddr = memory.controller();
};

}  // namespace fovea::dram
