// The memory system on its sockets: one target socket per master, one initiator socket per slave that
// is not part of it. Named after its crossbar, the switched central resource (TI).
#pragma once
#include <array>
#include <memory>
#include <systemc>
#include <tlm>

#include "model/bus/core/latency_stats.h"
#include "model/bus/memory_path.h"
#include "model/common/block.h"
#include "model/common/timer.h"
#include "model/common/mem_sockets.h"
#include "model/common/sc_ports.h"
#include "model/common/stats.h"
#include "model/memsys/memory_system.h"

namespace fovea::bus {

using memsys::AddressMap;

class Scr final : public sc_core::sc_module,
                  public Block,
                  public MemoryPathIf,
                  private memsys::MemoryHost {
 public:
  using TargetSocket = MemTargetSocket<32>;
  template <class T>
  using PerMaster = std::array<std::unique_ptr<T>, kMasterCount>;
  PerMaster<TargetSocket> target;            ///< indexed by Master
  MemInitiatorSocket<32> config_socket{"config_socket"};
  /// Unbound where AddressMap has no internal RAM.
  tlm::tlm_initiator_socket<32, MemProtocol, 1, sc_core::SC_ZERO_OR_MORE_BOUND> ram_socket{
      "ram_socket"};
  sc_core::sc_export<MemoryPathIf> path{"path"};
  ClockIn clk{"clk"};
  /// Priority of each master, 0 highest; the SoC drives them from MSTPRI, QUEPRI and BCR.
  sc_core::sc_vector<sc_core::sc_in<std::uint32_t>> priority{"priority", kMasterCount};

  Scr(sc_core::sc_module_name name, const CrossbarParams& params, const mem::DdrParams& ddr,
      const AddressMap& map, bool strict);

  memsys::MemorySystem& memory() override { return memory_; }
  Crossbar& crossbar() { return memory_.crossbar(); }
  std::array<std::unique_ptr<LatencyStats>, kStatCount> latency;  ///< by stat_index()
  /// Takes all decisions at or before now, so that statistics and memory are those of `now`.
  void settle();

  void hold() override;
  void release() override;
  bool strict() const override { return strict_; }

 private:
  struct Target : MemTargetIf {
    Scr* owner = nullptr;
    Master master = Master::kArmI;
    tlm::tlm_sync_enum nb_transport_fw(MemRequest& r, MemPhase& phase,
                                       sc_core::sc_time&) override {
      if (phase != MemPhase::kRequest) return tlm::TLM_ACCEPTED;
      r.master = master;
      owner->request(r);
      return tlm::TLM_ACCEPTED;
    }
    unsigned transport_dbg(MemRequest& r) override { return owner->debug(r); }
  };
  struct SlavePort : MemInitiatorIf {
    Scr* owner = nullptr;
    Slave slave = Slave::kDdr;
    tlm::tlm_sync_enum nb_transport_bw(MemRequest& r, MemPhase& phase,
                                       sc_core::sc_time& delay) override {
      return owner->response(slave, r, phase, delay);
    }
  };

  std::vector<PortLatencies*> latencies_of(std::size_t stat);
  void request(MemRequest& r);
  tlm::tlm_sync_enum response(Slave s, MemRequest& r, MemPhase phase, sc_core::sc_time& delay);
  unsigned debug(MemRequest& r);
  void completed(MemRequest& request) override;
  Taken deliver(MemRequest& request, Slave slave, Picoseconds arrival) override;
  void rescheduled() override;
  void advance_by_kernel();
  void arm();
  void inputs_changed();

  bool strict_;
  memsys::MemorySystem memory_;
  std::array<Target, kMasterCount> targets_;
  std::array<SlavePort, kSlaveCount> slave_ports_;
  Timer due_;
  KernelNow now_;
  bool held_ = false;
};

}  // namespace fovea::bus
