#include "model/bus/scr.h"

namespace fovea::bus {

Scr::Scr(sc_core::sc_module_name name, const CrossbarParams& params, const mem::DdrParams& ddr, const AddressMap& map,
         bool strict)
    : sc_module(name), strict_(strict), memory_(params, ddr, map, *this, diagnostics()) {
  SC_HAS_PROCESS(Scr);
  for (const MasterInfo& m : kMasters.rows) {
    const std::size_t i = index(m.id);
    target[i] = std::make_unique<TargetSocket>(("target_" + std::string(m.name)).c_str());
    targets_[i].owner = this;
    targets_[i].master = m.id;
    target[i]->bind(targets_[i]);
  }
  for (std::size_t i = 0; i < kStatCount; ++i)
    latency[i] = std::make_unique<LatencyStats>(std::string(kStatNames[i]), latencies_of(i));
  for (auto& s : crossbar().stats) add_statistics(*s);
  for (auto& s : latency) add_statistics(*s);
  for (std::size_t i = 0; i < kSlaveCount; ++i) {
    slave_ports_[i].owner = this;
    slave_ports_[i].slave = static_cast<Slave>(i);
  }
  config_socket.bind(slave_ports_[static_cast<std::size_t>(Slave::kConfig)]);
  ram_socket.bind(slave_ports_[static_cast<std::size_t>(Slave::kInternalRam)]);
  path.bind(*this);
  SC_METHOD(inputs_changed);
  sensitive << clk;
  for (std::size_t i = 0; i < priority.size(); ++i) sensitive << priority[i];
  SC_METHOD(advance_by_kernel);
  sensitive << due_.event();
  dont_initialize();
}

/// Latencies of all ports that share this name in the statistics.
std::vector<PortLatencies*> Scr::latencies_of(std::size_t stat) {
  std::vector<PortLatencies*> out;
  for (const MasterInfo& m : kMasters.rows)
    if (stat_index(m.id) == stat) out.push_back(&crossbar().latencies[index(m.id)]);
  return out;
}

void Scr::settle() {
  const Picoseconds now = kernel_time();
  memory_.set_present(now);
  memory_.advance_through(now + 1);
}

void Scr::hold() {
  memory_.set_present(now_());
  if (strict_) return;
  held_ = true;
  due_.cancel();
}

void Scr::release() {
  if (strict_) return;
  held_ = false;
  arm();
}

void Scr::arm() { due_.at(memory_.next_event()); }

/// The kernel's turn: takes the events that are due, and in default mode also those before the next kernel event of
/// another process. Requests that come meanwhile set no timer: it would end the turn at the path's own event.
void Scr::advance_by_kernel() {
  if (held_) return;
  const Picoseconds now = now_();
  memory_.set_present(now);
  held_ = true;
  for (Horizon horizon;;) {
    const Picoseconds t = memory_.next_event();
    if (t == kNever) break;
    Picoseconds limit = now + 1;
    if (t > now) {
      if (strict_) break;
      limit = horizon();
      if (t >= limit) break;
    }
    memory_.advance(limit);
  }
  held_ = false;
  arm();
}

/// Clock and priorities change between events: those at or before now are taken with the old values.
void Scr::inputs_changed() {
  settle();
  Crossbar& crossbar = memory_.crossbar();
  crossbar.set_clock(clk.read(), kernel_time());
  for (std::size_t i = 0; i < kMasterCount; ++i)
    crossbar.set_priority(static_cast<Master>(i), priority[i].read());
  rescheduled();
}

void Scr::rescheduled() {
  if (!held_) arm();
}

void Scr::request(MemRequest& r) {
  memory_.submit(r);
  if (!held_) arm();
}

Taken Scr::deliver(MemRequest& r, Slave slave, Picoseconds arrival) {
  MemPhase phase = MemPhase::kRequest;
  const Picoseconds now = now_();
  sc_core::sc_time delay = ps_time(arrival > now ? arrival - now : 0);
  tlm::tlm_sync_enum status;
  if (slave == Slave::kInternalRam) {
    r.address -= memory_.map().ram_base;  // a slave sees offsets
    status = ram_socket->nb_transport_fw(r, phase, delay);
  } else {
    status = config_socket->nb_transport_fw(r, phase, delay);
  }
  return status == tlm::TLM_UPDATED    ? Taken::kYes
         : status == tlm::TLM_ACCEPTED ? Taken::kWaits
                                       : Taken::kRefused;
}

tlm::tlm_sync_enum Scr::response(Slave slave, MemRequest& r, MemPhase phase,
                                 sc_core::sc_time& delay) {
  const Picoseconds now = now_();
  if (phase == MemPhase::kAccepted) {
    memory_.slave_accepted(r, now + delay.value());
    if (!held_) arm();
    return tlm::TLM_ACCEPTED;
  }
  if (slave == Slave::kInternalRam) r.address += memory_.map().ram_base;
  memory_.slave_done(r, now + delay.value(), r.error);
  return tlm::TLM_COMPLETED;
}

void Scr::completed(MemRequest& r) {
  const Picoseconds now = now_();
  MemPhase phase = MemPhase::kResponse;
  sc_core::sc_time delay = ps_time(r.first > now ? r.first - now : 0);
  (*target[index(r.master)])->nb_transport_bw(r, phase, delay);
}

unsigned Scr::debug(MemRequest& r) {
  return r.address < memory_.map().ddr_base ? config_socket->transport_dbg(r)
                                            : memory_.debug_access(r);
}

}  // namespace fovea::bus
