#include "model/bus/scr.h"

#include "model/common/check.h"

namespace fovea::bus {

Scr::Scr(sc_core::sc_module_name name, const CrossbarParams& params, const AddressMap& map,
         bool strict)
    : sc_module(name), map_(map), strict_(strict), crossbar_(params, *this) {
  SC_HAS_PROCESS(Scr);
  for (const MasterInfo& m : kMasters.rows) {
    const std::size_t i = index(m.id);
    target[i] = std::make_unique<TargetSocket>(("target_" + std::string(m.name)).c_str());
    targets_[i].owner = this;
    targets_[i].master = m.id;
    target[i]->bind(targets_[i]);
  }
  for (std::size_t i = 0; i < kStatCount; ++i)
    latency[i] = std::make_unique<LatencyStats>(std::string(kStatNames[i]));
  for (auto& s : crossbar_.stats) add_statistics(*s);
  for (auto& s : latency) add_statistics(*s);
  for (std::size_t i = 0; i < kSlaveCount; ++i) {
    slave_ports_[i].owner = this;
    slave_ports_[i].slave = static_cast<Slave>(i);
  }
  ddr_socket.bind(slave_ports_[static_cast<std::size_t>(Slave::kDdr)]);
  config_socket.bind(slave_ports_[static_cast<std::size_t>(Slave::kConfig)]);
  ram_socket.bind(slave_ports_[static_cast<std::size_t>(Slave::kInternalRam)]);
  path.bind(*this);
  SC_METHOD(inputs_changed);
  sensitive << clk;
  for (auto& p : priority) sensitive << p;
  SC_METHOD(play);
  sensitive << due_.event();
  dont_initialize();
}

void Scr::end_of_elaboration() {
  ddr_ = ddr_lookahead.operator->();
  ddr_next_ = ddr_->next_decision_place();
  SC_HAS_PROCESS(Scr);
  SC_METHOD(replanned);
  sensitive << ddr_->replanned();
  dont_initialize();
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

[[gnu::noinline]] void Scr::step_before(Picoseconds limit) {
  const Horizon::Mark mark;
  const std::uint64_t responses = responses_;
  do {
    step();
  } while (next_decision() < limit && !mark.moved() && responses_ == responses);
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
  due_.at(next_decision());
}

/// Kernel side of the path: decides what is due, and in default mode what lies before the next
/// event of anybody else.
void Scr::play() {
  if (held_) return;
  const Picoseconds now = now_();
  for (Horizon horizon;;) {
    const Picoseconds t = next_decision();
    if (t == kNever) return;
    if (t > now) {
      if (strict_ || t >= horizon()) break;
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

void Scr::replanned() {
  if (!held_) arm();
}

inline Slave Scr::slave_of(const MemRequest& r) const {
  if (r.address >= map_.ddr_base) return Slave::kDdr;
  const bool core = r.master == Master::kArmI || r.master == Master::kArmD;
  return !core && r.address - map_.ram_base < map_.ram_size ? Slave::kInternalRam : Slave::kConfig;
}

void Scr::request(MemRequest& r) {
  FOVEA_CHECK(r.bytes > 0 && r.bytes <= kMaxBurstBytes, "bad memory request");
  const Slave slave = slave_of(r);
  if (slave == Slave::kInternalRam) r.passive = false;  // the core sees what it does
  undecided_ += !r.passive;
  crossbar_.submit(r, slave);
  if (!held_) arm();
}

inline Taken Scr::AloneHost::forward(MemRequest& r, Picoseconds arrival) {
  r.address -= scr.map_.ddr_base;
  const Taken taken = scr.ddr_->arrive(r, arrival);
  r.address += scr.map_.ddr_base;
  return taken;
}

/// Only the controller has decisions of its own meanwhile: those up to the grant come first, as they
/// may make room; one that answers somebody changes what the caller knows.
Scr::Alone Scr::play_alone(MemRequest& r, Picoseconds limit) {
  return r.write ? play_alone<true>(r, limit) : play_alone<false>(r, limit);
}

template <bool kWrite>
[[gnu::noinline]] Scr::Alone Scr::play_alone(MemRequest& r, Picoseconds limit) {
  const Crossbar::AloneGrant g = crossbar_.grant_if_alone(r);
  if (g.at >= limit) return Alone::kNo;
  const Horizon::Mark mark;
  const std::uint64_t responses = responses_;
  while (*ddr_next_ <= g.at) {
    deciding_ = *ddr_next_;
    ddr_->step();
    if (mark.moved() || responses_ != responses) return Alone::kNo;
  }
  FOVEA_CHECK(r.bytes > 0 && r.bytes <= kMaxBurstBytes, "bad memory request");
  undecided_ += !r.passive;
  deciding_ = g.at;
  AloneHost host{*this};
  if (crossbar_.grant_alone<kWrite>(host, r, g)) {
    undecided_ -= !r.passive;
    ++(g.at > now_() ? direct_ : queued_);
    return Alone::kDone;
  }
  while (responses_ == responses && !mark.moved() && *ddr_next_ < limit &&
         *ddr_next_ < crossbar_.next_decision()) {
    deciding_ = *ddr_next_;
    ddr_->step();
  }
  return Alone::kUnder;
}

Taken Scr::forward(MemRequest& r, Picoseconds arrival) {
  MemPhase phase = MemPhase::kRequest;
  const Picoseconds now = now_();
  sc_core::sc_time delay = ps_time(arrival > now ? arrival - now : 0);
  tlm::tlm_sync_enum status;
  if (r.slave == static_cast<std::uint8_t>(Slave::kDdr)) {
    r.address -= map_.ddr_base;  // a slave sees offsets
    status = ddr_socket->nb_transport_fw(r, phase, delay);
    r.address += map_.ddr_base;
  } else if (r.slave == static_cast<std::uint8_t>(Slave::kInternalRam)) {
    r.address -= map_.ram_base;
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
  if (phase == MemPhase::kAccepted) {
    crossbar_.slave_accepted(r, now_() + delay.value());
    if (!held_) arm();
    return tlm::TLM_ACCEPTED;
  }
  if (slave != Slave::kDdr) {
    if (slave == Slave::kInternalRam) r.address += map_.ram_base;
    const Picoseconds t = now_() + delay.value();
    deciding_ = t;
    crossbar_.slave_done(r, t, t, r.error);
  } else {
    crossbar_.slave_done(r, r.first, r.last, phase == MemPhase::kRefused);
  }
  return tlm::TLM_COMPLETED;
}

inline void Scr::count_outcome(const MemRequest& r, Picoseconds now) {
  undecided_ -= !r.passive;
  if (r.slave == static_cast<std::uint8_t>(Slave::kDdr)) {
    ++(deciding_ > now ? direct_ : queued_);
    if (!r.write) latency[stat_index(r.master)]->histogram.add(r.first - r.issued);
  }
}

void Scr::respond(MemRequest& r) {
  const Picoseconds now = now_();
  ++responses_;
  count_outcome(r, now);
  MemPhase phase = MemPhase::kResponse;
  sc_core::sc_time delay = ps_time(r.first > now ? r.first - now : 0);
  (*target[index(r.master)])->nb_transport_bw(r, phase, delay);
}

unsigned Scr::debug(MemRequest& r) {
  if (r.address < map_.ddr_base) return config_socket->transport_dbg(r);
  r.address -= map_.ddr_base;
  const unsigned n = ddr_socket->transport_dbg(r);
  r.address += map_.ddr_base;
  return n;
}

}  // namespace fovea::bus
