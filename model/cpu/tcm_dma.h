// The crossbar slave through which other masters reach the core's internal RAM.
#pragma once
#include <cstdint>
#include <deque>
#include <systemc>

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
/// activity of its instant (EndOfInstant), so the core's own accesses of that instant come first.
/// While the core's clock is stopped, bursts wait.
class TcmDma : public sc_core::sc_module, public Block, public MemTargetIf {
 public:
  MemTargetSocket<32> socket{"socket"};
  ClockIn clk{"clk"};
  TcmStats stats;

  TcmDma(sc_core::sc_module_name name, Core& core, EndOfInstant& end_of_instant);

  tlm::tlm_sync_enum nb_transport_fw(MemRequest&, MemPhase&, sc_core::sc_time&) override;

 private:
  struct Waiting {
    MemRequest* request;
    Picoseconds arrival;
  };
  void at(Picoseconds t);
  void act();
  void finish(MemRequest& r);
  void clock_changed();

  Core& core_;
  EndOfInstant& end_of_instant_;
  std::deque<Waiting> queue_;
  bool begun_ = false;       // the first burst of the queue has begun
  std::uint64_t plan_ = 0;   // number of the newest scheduled call of act(); older ones do nothing
  std::uint64_t waited_fetch_ = 0, waited_data_ = 0;
};

}  // namespace fovea::cpu
