// The switched central resource on its sockets: one target socket per master, one initiator socket
// per slave. Head of the memory path.
#pragma once
#include <array>
#include <memory>
#include <systemc>
#include <tlm>

#include "model/bus/core/crossbar.h"
#include "model/bus/core/latency_stats.h"
#include "model/common/block.h"
#include "model/common/lookahead.h"
#include "model/common/mem_sockets.h"
#include "model/common/sc_ports.h"
#include "model/common/stats.h"

namespace fovea::bus {

/// Where the crossbar sends an address.
struct AddressMap {
  std::uint32_t ddr_base = 0x8000'0000;
  std::uint64_t ddr_size = 128ull << 20;
  /// Internal RAM for all but the core's own ports, which have another way there.
  std::uint32_t ram_base = 0x1'0000, ram_size = 0;
};

class Scr final : public sc_core::sc_module,
                  public Block,
                  public MemoryPathIf,
                  private XbarHost {
 public:
  using TargetSocket = MemTargetSocket<32>;
  template <class T>
  using PerMaster = std::array<std::unique_ptr<T>, kMasterCount>;
  PerMaster<TargetSocket> target;            ///< indexed by Master
  MemInitiatorSocket<64> ddr_socket{"ddr_socket"};
  MemInitiatorSocket<32> config_socket{"config_socket"};
  /// Unbound where AddressMap has no internal RAM.
  tlm::tlm_initiator_socket<32, MemProtocol, 1, sc_core::SC_ZERO_OR_MORE_BOUND> ram_socket{
      "ram_socket"};
  sc_core::sc_port<PassiveIf> ddr_lookahead{"ddr_lookahead"};
  sc_core::sc_export<MemoryPathIf> path{"path"};
  ClockIn clk{"clk"};
  /// Priority of each master, 0 highest; the SoC drives them from MSTPRI, QUEPRI and BCR.
  sc_core::sc_vector<sc_core::sc_in<std::uint32_t>> priority{"priority", kMasterCount};

  Scr(sc_core::sc_module_name name, const CrossbarParams& params, const AddressMap& map,
      bool strict);

  Crossbar& crossbar() { return crossbar_; }
  std::array<std::unique_ptr<LatencyStats>, kStatCount> latency;  ///< by stat_index()
  /// SDRAM accesses whose outcome was decided ahead of the kernel / by a kernel event.
  std::uint64_t direct_accesses() const { return direct_; }
  std::uint64_t queued_accesses() const { return queued_; }
  /// Takes all decisions at or before now, so that statistics and memory are those of `now`.
  void settle();

  Picoseconds next_decision() const { return std::min(crossbar_.next_decision(), *ddr_next_); }
  std::array<const Picoseconds*, 2> decision_places() const override {
    return {crossbar_.next_decision_place(), ddr_next_};
  }
  void hold() override;
  void release() override;
  void step_before(Picoseconds limit) override;
  Alone play_alone(MemRequest& r, Picoseconds limit) override;
  std::uint64_t memory_base() const override {
    return crossbar_.observed() ? kNever : map_.ddr_base;  // who looks on sees requests when they come
  }
  Picoseconds least_latency(Master m) const override { return crossbar_.least_latency(m); }
  bool strict() const override { return strict_; }
  unsigned undecided() const override { return undecided_; }

 private:
  friend class Crossbar;
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

  /// Host of a grant of a request to the SDRAM.
  struct AloneHost {
    Scr& scr;
    Taken forward(MemRequest& r, Picoseconds arrival);
  };
  template <bool kWrite>
  Alone play_alone(MemRequest& request, Picoseconds limit);
  void request(MemRequest& r);
  Slave slave_of(const MemRequest& r) const;
  void count_outcome(const MemRequest& r, Picoseconds now);
  tlm::tlm_sync_enum response(Slave s, MemRequest& r, MemPhase phase, sc_core::sc_time& delay);
  unsigned debug(MemRequest& r);
  Taken forward(MemRequest& request, Picoseconds arrival) override;
  void respond(MemRequest& request) override;
  void play();
  void arm();
  void end_of_elaboration() override;
  void step();
  void inputs_changed();
  void replanned();

  AddressMap map_;
  bool strict_;
  Crossbar crossbar_;
  std::array<Target, kMasterCount> targets_;
  std::array<SlavePort, kSlaveCount> slave_ports_;
  Timer due_;
  KernelNow now_;
  PassiveIf* ddr_ = nullptr;  // behind `ddr_lookahead`
  const Picoseconds* ddr_next_ = nullptr;
  bool held_ = false;
  unsigned undecided_ = 0;
  Picoseconds deciding_ = 0;  // time of the decision being taken
  std::uint64_t responses_ = 0;
  std::uint64_t direct_ = 0, queued_ = 0;
};

}  // namespace fovea::bus
