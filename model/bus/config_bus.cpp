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
  bool has(std::uint32_t address) const { return address >= base && address - base < size; }
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

ConfigBus::Block* ConfigBus::find(std::uint32_t address) {
  for (const auto& b : blocks_)
    if (b->has(address)) return b.get();
  return nullptr;
}

Picoseconds ConfigBus::latency(const Block* b) const {
  return b && b->speed == Speed::kSlow ? params_.slow_latency() : params_.fast_latency();
}

namespace {
/// Bytes of the access at `address`, of which `left` are wanted: a word, or what is aligned.
unsigned access_bytes(std::uint32_t address, unsigned left) {
  unsigned bytes = 4;
  while (bytes > left || address % bytes) bytes /= 2;
  return bytes;
}

unsigned accesses(const MemRequest& r) {
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
  Port& port = ports_[index(r.master)];
  const Picoseconds start = std::max(Picoseconds{kernel_time() + delay.value()}, port.free);
  Block* const block = find(r.address);
  const bool divided = r.bytes > 4 && block;  // a burst to nowhere is one bus error
  const Picoseconds one = latency(block);
  port.free = start + one * (divided ? accesses(r) : 1u);
  r.error = false;
  port.under_way.push_back({&r, block, divided, 0});
  end_of_instant_.at(start + one, instant_rank(r.master), [this, &port] { access(port); });
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

/// The next access of the port's oldest request, at its time. An access of a single request may be
/// unaligned or of 3 bytes: the block accepts or refuses it.
void ConfigBus::access(Port& port) {
  UnderWay& next = port.under_way.front();
  MemRequest& r = *next.request;
  const unsigned bytes =
      next.divided ? access_bytes(r.address + next.offset, r.bytes - next.offset) : r.bytes;
  accessing_ = r.master;
  if (!in_reset_ && !access_word(next, bytes)) r.error = true;
  next.offset += bytes;
  if (next.offset < r.bytes)
    return end_of_instant_.at(kernel_time() + latency(next.block), instant_rank(r.master),
                              [this, &port] { access(port); });
  port.under_way.pop_front();
  MemPhase phase = MemPhase::kResponse;
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  socket->nb_transport_bw(r, phase, delay);
}

/// False: a bus error. The block was found at the request; a burst may go beyond its end.
bool ConfigBus::access_word(const UnderWay& next, unsigned bytes) {
  const std::uint32_t address = next.request->address + next.offset;
  Block* const b = next.block && next.block->has(address) ? next.block : find(address);
  if (!b) {
    bus_error(address);
    return false;
  }
  tlm::tlm_generic_payload gp;
  fill(gp, *next.request, b->base, next.offset, bytes);
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  b->initiator->b_transport(gp, delay);
  if (gp.get_response_status() == tlm::TLM_ADDRESS_ERROR_RESPONSE) bus_error(address);
  return !gp.is_response_error();
}

/// Documented blocks are named once each, whichever of their addresses is touched.
[[gnu::noinline]] void ConfigBus::bus_error(std::uint32_t address) {
  ++stats.errors;
  if (const std::string what = describe ? describe(address) : ""; !what.empty()) {
    diagnostics().not_modelled("bus error: " + what);
    return;
  }
  char text[64];
  std::snprintf(text, sizeof text, "bus error at 0x%08x", address);
  diagnostics().guest(text);
}

unsigned ConfigBus::transport_dbg(MemRequest& r) {
  Block* const b = find(r.address);
  if (!b) return 0;
  tlm::tlm_generic_payload gp;
  fill(gp, r, b->base, 0, r.bytes);
  return b->initiator->transport_dbg(gp);
}

}  // namespace fovea::bus
