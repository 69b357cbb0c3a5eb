#include "model/bus/config_bus.h"

#include <algorithm>

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
                     EndOfInstant& end_of_instant, const std::vector<BlockSpec>& blocks)
    : sc_module(name), params_(params), end_of_instant_(end_of_instant) {
  socket.bind(*this);
  add_statistics(stats);
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

Picoseconds ConfigBus::latency(std::uint32_t address) const {
  const Block* b = find(address);
  return b && b->speed == Speed::kSlow ? params_.slow_latency() : params_.fast_latency();
}

/// A burst to nowhere is one bus error.
bool ConfigBus::divided(const MemRequest& r) const { return r.bytes > 4 && find(r.address); }

namespace {
/// Bytes of the access at `address`, of which `left` are wanted: a word, or what is aligned.
unsigned access_bytes(std::uint32_t address, unsigned left) {
  unsigned bytes = 4;
  while (bytes > left || address % bytes) bytes /= 2;
  return bytes;
}

unsigned accesses(const MemRequest& r, bool divided) {
  if (!divided) return 1;
  unsigned n = 0;
  for (unsigned done = 0; done < r.bytes; ++n) done += access_bytes(r.address + done, r.bytes - done);
  return n;
}
}  // namespace

tlm::tlm_sync_enum ConfigBus::nb_transport_fw(MemRequest& r, MemPhase& phase,
                                              sc_core::sc_time& delay) {
  if (phase != MemPhase::kRequest) return tlm::TLM_ACCEPTED;
  // Counted at the request, as the crossbar does, so that both sums agree at any instant.
  ++(r.write ? stats.writes : stats.reads);
  (r.write ? stats.write_bytes : stats.read_bytes) += r.bytes;
  Picoseconds& free = free_[index(r.master)];
  const Picoseconds start = std::max(Picoseconds{kernel_time() + delay.value()}, free);
  const Picoseconds one = latency(r.address);
  free = start + one * accesses(r, divided(r));
  r.error = false;
  end_of_instant_.at(start + one, instant_rank(r.master), [this, &r] { access(r, 0); });
  return tlm::TLM_UPDATED;
}

/// The register blocks speak the base protocol.
void ConfigBus::fill(tlm::tlm_generic_payload& gp, MemRequest& r, std::uint32_t base, unsigned offset,
                     unsigned bytes) {
  gp.set_command(r.write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
  gp.set_address(r.address + offset - base);
  gp.set_data_ptr(r.data + offset);
  gp.set_data_length(bytes);
  gp.set_streaming_width(bytes);
}

/// The access at byte `offset` of the request, at its time. An access of a single request may be
/// unaligned or of 3 bytes: the block says what it thinks of that.
void ConfigBus::access(MemRequest& r, unsigned offset) {
  const unsigned bytes =
      divided(r) ? access_bytes(r.address + offset, r.bytes - offset) : r.bytes;
  accessing_ = r.master;
  if (!in_reset_ && !access_word(r, offset, bytes)) r.error = true;
  if (offset + bytes < r.bytes) {
    end_of_instant_.at(kernel_time() + latency(r.address), instant_rank(r.master),
                       [this, &r, next = offset + bytes] { access(r, next); });
    return;
  }
  MemPhase phase = MemPhase::kResponse;
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  socket->nb_transport_bw(r, phase, delay);
}

/// False: a bus error.
bool ConfigBus::access_word(MemRequest& r, unsigned offset, unsigned bytes) {
  const std::uint32_t address = r.address + offset;
  const Block* b = find(address);
  if (!b) {
    bus_error(address);
    return false;
  }
  tlm::tlm_generic_payload gp;
  fill(gp, r, b->base, offset, bytes);
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  const_cast<Block*>(b)->initiator->b_transport(gp, delay);
  if (gp.get_response_status() == tlm::TLM_ADDRESS_ERROR_RESPONSE) bus_error(address);
  return !gp.is_response_error();
}

/// Documented blocks are named once each, whichever of their addresses is touched.
[[gnu::noinline]] void ConfigBus::bus_error(std::uint32_t address) {
  ++stats.errors;
  if (const std::string what = describe ? describe(address) : ""; !what.empty()) {
    Diagnostics::instance().not_modelled("bus error: " + what);
    return;
  }
  char text[64];
  std::snprintf(text, sizeof text, "bus error at 0x%08x", address);
  Diagnostics::instance().guest(text);
}

unsigned ConfigBus::transport_dbg(MemRequest& r) {
  const Block* b = find(r.address);
  if (!b) return 0;
  tlm::tlm_generic_payload gp;
  fill(gp, r, b->base, 0, r.bytes);
  return const_cast<Block*>(b)->initiator->transport_dbg(gp);
}

}  // namespace fovea::bus
