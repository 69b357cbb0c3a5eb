// The configuration bus: register accesses at their exact time.
#pragma once
#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/common/block.h"
#include "model/common/mem_sockets.h"
#include "model/common/param.h"
#include "model/common/end_of_instant.h"
#include "model/common/stats.h"

namespace fovea::bus {

struct ConfigBusParams : ParamGroup {
  using U = IntParam::Unit;
  static constexpr const char* kBelief =
      "known are posted writes of another chip's DSP only; Linux's timer tick takes 63 to 112 us on "
      "the DM365 EVM (BogoMIPS 146.84) and less than 43 us here, so accesses may well be slower";
  IntParam fast_latency{*this, "fast_latency", U::kTime, 40 * kPsPerNs, 1, kPsPerUs,
                        "crossbar to register, blocks on the bus clock (VPSS, EDMA, PSC, AINTC)",
                        Origin::kAssumed,
                        "OMAP-L138, TI wiki on SoC constraints: a DSP's write takes 33 to 50 ns",
                        {"30ns", "400ns", kBelief}};
  IntParam slow_latency{*this, "slow_latency", U::kTime, 120 * kPsPerNs, 1, 2 * kPsPerUs,
                        "crossbar to register, blocks on the 24 MHz AUXCLK (timers, UART0, I2C)",
                        Origin::kAssumed,
                        "OMAP-L138, TI wiki on SoC constraints: a DSP's write takes 117 to 133 ns",
                        {"100ns", "1us", kBelief}};
  ConfigBusParams() : ParamGroup("bus.config") {}
};

struct ConfigBusStats : StatGroup {
  Counter reads{*this, "reads", "1", "register reads; a burst is one"};
  Counter writes{*this, "writes", "1", "register writes; a burst is one"};
  Counter read_bytes{*this, "read_bytes", "B", "bytes of register reads"};
  Counter write_bytes{*this, "write_bytes", "B", "bytes of register writes"};
  Counter errors{*this, "errors", "1", "register accesses to addresses where nothing answers"};
  ConfigBusStats() : StatGroup("bus.config") {}
};

/// Decodes register addresses, waits the latency of the block's class, and makes the access in the
/// end-of-instant phase, so that the register is seen after everything else that happens at
/// that time. One access at a time per master port, in the order of the requests; several masters'
/// accesses of one instant go by master number. A burst is divided into accesses of at most a word, one
/// after the other with the latency of each, as by the bridge to a bus of 32 bits without bursts
/// (assumed: no public document of this chip shows it; TI's guides let the EDMA write its own
/// parameter sets, SPRUH82C).
class ConfigBus : public sc_core::sc_module, public Block, public MemTargetIf {
 public:
  enum class Speed { kFast, kSlow };
  MemTargetSocket<32> socket{"socket"};
  ConfigBusStats stats;

  struct BlockSpec {
    std::string name;
    std::uint32_t base, size;
    Speed speed;
  };
  ConfigBus(sc_core::sc_module_name name, const ConfigBusParams& params, EndOfInstant& end_of_instant,
            const std::vector<BlockSpec>& blocks);
  ~ConfigBus() override;

  /// The socket towards the block of that name.
  tlm::tlm_initiator_socket<32>& to(const std::string& name);

  tlm::tlm_sync_enum nb_transport_fw(MemRequest&, MemPhase&, sc_core::sc_time&) override;
  unsigned transport_dbg(MemRequest&) override;
  /// What the chip has at an address where nothing answers here, such as "MMCSD0 at 0x01d11000 is
  /// not modelled"; empty: nothing known. Unset on a bus that is not the chip's.
  std::function<std::string(std::uint32_t address)> describe;
  /// Accesses that are under way at a reset of the chip are answered without effect.
  void reset(ResetKind) override { in_reset_ = true; }
  void leave_reset() override { in_reset_ = false; }
  /// What an access of a word to a register takes from its arrival here.
  Picoseconds latency_at(std::uint32_t address) { return latency(find(address)); }
  /// Whose access is, or was last, at its register.
  Master accessing() const { return accessing_; }

 private:
  struct Block;
  /// A request between its arrival and its answer.
  struct UnderWay {
    MemRequest* request;
    Block* block;  // at its address; null: none
    bool divided;
    unsigned offset;  // of the next access
  };
  struct Port {
    Picoseconds free = 0;  // when its latest request ends
    std::deque<UnderWay> under_way;  // in order
  };
  Block* find(std::uint32_t address);
  Picoseconds latency(const Block* block) const;
  void access(Port& port);
  bool access_word(const UnderWay& next, unsigned bytes);
  void bus_error(std::uint32_t address);
  static void fill(tlm::tlm_generic_payload& gp, MemRequest& r, std::uint32_t base, unsigned offset,
                   unsigned bytes);

  const ConfigBusParams& params_;
  EndOfInstant& end_of_instant_;
  Master accessing_ = Master::kArmD;
  bool in_reset_ = false;
  std::array<Port, kMasterCount> ports_;  // by master
  std::vector<std::unique_ptr<Block>> blocks_;
};

}  // namespace fovea::bus
