#include "model/bus/config_bus.h"

#include "model/common/check.h"

namespace fovea::bus {

struct ConfigBus::Block : tlm::tlm_bw_transport_if<> {
  std::string name;
  std::uint32_t base, size;
  Speed speed;
  tlm::tlm_initiator_socket<32> initiator;
  explicit Block(const BlockSpec& s)
      : name(s.name), base(s.base), size(s.size), speed(s.speed),
        initiator(("to_" + s.name).c_str()) {
    initiator.bind(*this);
  }
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload&, tlm::tlm_phase&,
                                     sc_core::sc_time&) override {
    return tlm::TLM_ACCEPTED;
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64, sc_dt::uint64) override {}
};

ConfigBus::ConfigBus(sc_core::sc_module_name name, const ConfigBusParams& params,
                     QuietPhase& quiet, const std::vector<BlockSpec>& blocks)
    : sc_module(name), params_(params), quiet_(quiet) {
  socket.bind(*this);
  for (const BlockSpec& s : blocks) {
    for (const auto& b : blocks_)
      FOVEA_CHECK(s.base + s.size <= b->base || b->base + b->size <= s.base,
                  "register blocks overlap: " + s.name);
    blocks_.push_back(std::make_unique<Block>(s));
  }
}

ConfigBus::~ConfigBus() = default;

tlm::tlm_initiator_socket<32>& ConfigBus::to(const std::string& name) {
  for (auto& b : blocks_)
    if (b->name == name) return b->initiator;
  FOVEA_CHECK(false, "no register block named " + name);
}

const ConfigBus::Block* ConfigBus::find(std::uint64_t address) const {
  for (const auto& b : blocks_)
    if (address >= b->base && address - b->base < b->size) return b.get();
  return nullptr;
}

tlm::tlm_sync_enum ConfigBus::nb_transport_fw(tlm::tlm_generic_payload& gp, tlm::tlm_phase& phase,
                                              sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_REQ) return tlm::TLM_ACCEPTED;
  // Counted at the request, as the crossbar does, so that both sums agree at any instant.
  ++(gp.is_write() ? stats.writes : stats.reads);
  (gp.is_write() ? stats.write_bytes : stats.read_bytes) += gp.get_data_length();
  const Block* b = find(gp.get_address());
  const Picoseconds latency = b && b->speed == Speed::kSlow ? params_.slow_latency()
                                                            : params_.fast_latency();
  MemExtension* ext = nullptr;
  gp.get_extension(ext);
  quiet_.at(kernel_time() + delay.value() + latency, static_cast<unsigned>(index(ext->master)),
            [this, &gp] { access(gp); });
  phase = tlm::END_REQ;
  return tlm::TLM_UPDATED;
}

void ConfigBus::access(tlm::tlm_generic_payload& gp) {
  const std::uint64_t address = gp.get_address();
  const Block* b = find(address);
  // Bursts to registers do not exist on this bus.
  if (!b || gp.get_data_length() > 4) {
    ++stats.errors;
    char text[64];
    std::snprintf(text, sizeof text, "bus error at 0x%08x",
                  static_cast<unsigned>(address));
    Diagnostics::instance().guest(text);
    gp.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  } else {
    gp.set_address(address - b->base);
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    const_cast<Block*>(b)->initiator->b_transport(gp, delay);
    gp.set_address(address);
  }
  tlm::tlm_phase phase = tlm::BEGIN_RESP;
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  socket->nb_transport_bw(gp, phase, delay);
}

void ConfigBus::b_transport(tlm::tlm_generic_payload& gp, sc_core::sc_time&) {
  gp.set_response_status(tlm::TLM_COMMAND_ERROR_RESPONSE);
}

unsigned ConfigBus::transport_dbg(tlm::tlm_generic_payload& gp) {
  const std::uint64_t address = gp.get_address();
  const Block* b = find(address);
  if (!b) return 0;
  gp.set_address(address - b->base);
  const unsigned n = const_cast<Block*>(b)->initiator->transport_dbg(gp);
  gp.set_address(address);
  return n;
}

}  // namespace fovea::bus
