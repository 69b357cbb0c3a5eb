#include "model/bus/scr.h"

#include "model/common/check.h"

namespace fovea::bus {

Scr::Scr(sc_core::sc_module_name name, const CrossbarParams& params, const AddressMap& map,
         bool strict)
    : sc_module(name), map_(map), strict_(strict), crossbar_(params, *this) {
  SC_HAS_PROCESS(Scr);
  for (std::size_t i = 0; i < kMasterCount; ++i) {
    const auto m = static_cast<Master>(i);
    target[i] = std::make_unique<TargetSocket>(
        ("target_" + std::string(kMasterNames[i])).c_str());
    targets_[i].owner = this;
    targets_[i].master = m;
    target[i]->bind(targets_[i]);
    latency[i] = std::make_unique<LatencyStats>(m);
  }
  for (std::size_t i = 0; i < kSlaveCount; ++i) {
    slave_ports_[i].owner = this;
    slave_ports_[i].slave = static_cast<Slave>(i);
  }
  ddr_socket.bind(slave_ports_[static_cast<std::size_t>(Slave::kDdr)]);
  config_socket.bind(slave_ports_[static_cast<std::size_t>(Slave::kConfig)]);
  path.bind(*this);
  SC_METHOD(inputs_changed);
  sensitive << clk;
  for (auto& p : priority) sensitive << p;
  SC_METHOD(play);
  sensitive << due_;
  dont_initialize();
}

void Scr::end_of_elaboration() {
  ddr_ = ddr_lookahead.operator->();
  ddr_next_ = ddr_->next_decision_place();
}

Picoseconds Scr::next_decision() const {
  return std::min(crossbar_.next_decision(), *ddr_next_);
}

void Scr::step() {
  const Picoseconds own = crossbar_.next_decision();
  const Picoseconds ddr = *ddr_next_;
  // At equal times the order does not matter: each sees the other's acts strictly later.
  deciding_ = std::min(own, ddr);
  if (own < ddr)
    crossbar_.step(*this);
  else
    ddr_->step();
}

void Scr::step_before(Picoseconds limit) {
  const std::uint64_t epoch = horizon_epoch, responses = responses_;
  do {
    step();
  } while (Scr::next_decision() < limit && horizon_epoch == epoch && responses_ == responses);
}

void Scr::settle() {
  while (next_decision() <= kernel_time()) step();
}

void Scr::hold() {
  if (strict_) return;
  held_ = true;
  due_.cancel();
}

void Scr::release() {
  if (strict_) return;
  held_ = false;
  arm();
}

void Scr::arm() {
  const Picoseconds t = next_decision();
  if (t == kNever) return;
  const Picoseconds now = kernel_time();
  due_.notify(ps_time(t > now ? t - now : 0));
}

/// Kernel side of the path: decides what is due, and in default mode what lies before the next
/// event of anybody else.
void Scr::play() {
  if (held_) return;
  const Picoseconds now = now_();
  Picoseconds horizon = now;
  for (std::uint64_t epoch = ~std::uint64_t{0};;) {
    const Picoseconds t = next_decision();
    if (t == kNever) return;
    if (t > now) {
      if (strict_) break;
      if (epoch != horizon_epoch) {
        epoch = horizon_epoch;
        horizon = kernel_horizon();
      }
      if (t >= horizon) break;
    }
    step();
  }
  arm();
}

/// Clock and priorities change between decisions: those at or before now are taken with the old
/// values.
void Scr::inputs_changed() {
  settle();
  crossbar_.set_clock(clk.read(), kernel_time());
  for (std::size_t i = 0; i < kMasterCount; ++i)
    crossbar_.set_priority(static_cast<Master>(i), priority[i].read());
  if (!held_) arm();
}

XbarRequest Scr::describe(MemExtension& ext, Slave slave) {
  const tlm::tlm_generic_payload& gp = *ext.payload;
  XbarRequest r;
  r.cookie = &ext;
  r.master = ext.master;
  r.slave = slave;
  r.write = gp.is_write();
  r.bytes = static_cast<std::uint8_t>(gp.get_data_length());
  r.issued = ext.issued;
  return r;
}

tlm::tlm_sync_enum Scr::request(Master m, tlm::tlm_generic_payload& gp, tlm::tlm_phase& phase,
                                sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_REQ) return tlm::TLM_ACCEPTED;
  MemExtension* ext = nullptr;
  gp.get_extension(ext);
  FOVEA_CHECK(ext != nullptr && gp.get_data_length() <= kMaxBurstBytes, "bad memory request");
  ext->master = m;
  ext->payload = &gp;
  const std::uint64_t a = gp.get_address();
  const Slave s = a >= map_.ddr_base ? Slave::kDdr : Slave::kConfig;
  const Picoseconds at = now_() + delay.value();
  ext->issued = at;
  ++undecided_;
  crossbar_.submit(describe(*ext, s), at);
  if (!held_) arm();
  phase = tlm::END_REQ;
  return tlm::TLM_UPDATED;
}

bool Scr::forward(const XbarRequest& request, Picoseconds arrival) {
  auto* ext = static_cast<MemExtension*>(request.cookie);
  tlm::tlm_generic_payload& gp = *ext->payload;
  ext->priority = request.priority;
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  const Picoseconds now = now_();
  sc_core::sc_time delay = ps_time(arrival > now ? arrival - now : 0);
  tlm::tlm_sync_enum status;
  const bool ddr = request.slave == Slave::kDdr;
  if (ddr) {
    gp.set_address(gp.get_address() - map_.ddr_base);
    status = ddr_socket->nb_transport_fw(gp, phase, delay);
    gp.set_address(gp.get_address() + map_.ddr_base);
  } else {
    status = config_socket->nb_transport_fw(gp, phase, delay);
  }
  if (status == tlm::TLM_COMPLETED) {  // refused: the error goes back to the master
    crossbar_.slave_done(request, arrival, arrival, true);
    return true;
  }
  return phase == tlm::END_REQ;
}

tlm::tlm_sync_enum Scr::response(Slave slave, tlm::tlm_generic_payload& gp, tlm::tlm_phase& phase,
                                 sc_core::sc_time& delay) {
  MemExtension* ext = nullptr;
  gp.get_extension(ext);
  const XbarRequest r = describe(*ext, slave);
  if (phase == tlm::END_REQ) {
    crossbar_.slave_accepted(r, now_() + delay.value());
    if (!held_) arm();
    return tlm::TLM_ACCEPTED;
  }
  if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;
  if (slave == Slave::kConfig) {
    const Picoseconds t = now_() + delay.value();
    deciding_ = t;
    crossbar_.slave_done(r, t, t, gp.is_response_error());
  } else {
    crossbar_.slave_done(r, ext->first, ext->last, false);
  }
  return tlm::TLM_COMPLETED;
}

void Scr::respond(const XbarRequest& request, Picoseconds first, Picoseconds last, bool error) {
  auto* ext = static_cast<MemExtension*>(request.cookie);
  tlm::tlm_generic_payload& gp = *ext->payload;
  ext->first = first;
  ext->last = last;
  gp.set_response_status(error ? tlm::TLM_ADDRESS_ERROR_RESPONSE : tlm::TLM_OK_RESPONSE);
  const Picoseconds now = now_();
  --undecided_;
  ++responses_;
  if (request.slave == Slave::kDdr) {
    ++(deciding_ > now ? direct_ : queued_);
    if (!request.write) latency[index(request.master)]->histogram.add(first - ext->issued);
  }
  tlm::tlm_phase phase = tlm::BEGIN_RESP;
  sc_core::sc_time delay = ps_time(first > now ? first - now : 0);
  (*target[index(request.master)])->nb_transport_bw(gp, phase, delay);
}

unsigned Scr::debug(tlm::tlm_generic_payload& gp) {
  const std::uint64_t a = gp.get_address();
  if (a < map_.ddr_base) return config_socket->transport_dbg(gp);
  gp.set_address(a - map_.ddr_base);
  const unsigned n = ddr_socket->transport_dbg(gp);
  gp.set_address(a);
  return n;
}

}  // namespace fovea::bus
