// The crossbar slave through which other masters reach the core's internal RAM.
#pragma once
#include <cstdint>
#include <deque>
#include <systemc>

#include "model/bus/memory_path.h"
#include "model/common/block.h"
#include "model/common/mem_sockets.h"
#include "model/common/end_of_instant.h"
#include "model/common/sc_ports.h"
#include "model/common/stats.h"
#include "model/cpu/core/core.h"

namespace fovea::cpu {

struct TcmStats : StatGroup {
  Counter reads{*this, "dma_reads", "1", "bursts that others read from internal RAM"};
  Counter writes{*this, "dma_writes", "1", "bursts that others write to internal RAM"};
  Counter read_bytes{*this, "dma_read_bytes", "B", "bytes that others read from internal RAM"};
  Counter write_bytes{*this, "dma_write_bytes", "B", "bytes that others write to internal RAM"};
  Counter wait_fetch{*this, "dma_wait.arm_i", "cycles",
                     "core clocks in which a word of a DMA waited for a fetch of the core"};
  Counter wait_data{*this, "dma_wait.arm_d", "cycles",
                    "core clocks in which a word of a DMA waited for a load or store of the core"};
  TcmStats() : StatGroup("cpu.tcm") {}
};

/// Executes one burst at a time, in order of arrival. Each burst begins and ends after all other
/// activity of its instant, so the core's own accesses of that instant come first: ahead of the kernel as
/// an event of the memory path, at which no other process acts; at the kernel's present time by EndOfInstant.
/// While the core's clock is stopped, bursts wait.
class TcmDma : public sc_core::sc_module, public Block, public MemTargetIf, private memsys::PassiveSlave {
 public:
  MemTargetSocket<32> socket{"socket"};
  sc_core::sc_port<bus::MemoryPathIf> path{"path"};
  ClockIn clk{"clk"};
  TcmStats stats;

  TcmDma(sc_core::sc_module_name name, Core& core, EndOfInstant& end_of_instant);

  tlm::tlm_sync_enum nb_transport_fw(MemRequest&, MemPhase&, sc_core::sc_time&) override;

 private:
  struct Waiting {
    MemRequest* request;
    Picoseconds arrival;
  };
  void end_of_elaboration() override { path->memory().attach(*this); }
  void at(Picoseconds t);
  void act_ahead(Picoseconds t) override { act(t); }
  void act_at_present() override;
  void act(Picoseconds now);
  void finish(MemRequest& r, Picoseconds now);
  void clock_changed();

  Core& core_;
  EndOfInstant& end_of_instant_;
  std::deque<Waiting> queue_;
  bool begun_ = false;       // the first burst of the queue has begun
  std::uint64_t plan_ = 0;   // number of the newest plan to act; calls for older ones do nothing
  std::uint64_t waited_fetch_ = 0, waited_data_ = 0;
};

}  // namespace fovea::cpu
