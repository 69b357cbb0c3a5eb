#include "model/cpu/arm926.h"

#include <algorithm>

namespace fovea::cpu {

Arm926::Arm926(sc_core::sc_module_name name, const CpuParams& params, std::span<std::uint8_t> tcm, std::uint32_t entry)
    : LookaheadInitiator(name, 2), core_(params, *this, tcm, diagnostics()), entry_(entry) {
  add_master(Master::kArmI, *sockets[kInstructionPort], 1);
  add_master(Master::kArmD, *sockets[kDataPort], 1);
  add_own_window(core_.window_stats());
  SC_HAS_PROCESS(Arm926);
  SC_METHOD(clock_changed);
  sensitive << clk;
  SC_METHOD(interrupt_changed);
  sensitive << irq << fiq;
  SC_THREAD(run);
  set_stack_size(1 << 20);
}

void Arm926::run() {
  while (clk.read().stopped()) sc_core::wait(clock_runs_.event());
  enter();
  try {
    core_.reset(entry_, kernel_time());
    for (;;) {
      core_.run();
      const bool reset = core_.held();
      catch_up();  // how far the kernel has advanced must not depend on observers
      if (!reset) break;
      stay_in_reset();
    }
  } catch (const GuestFailure& e) {
    failure_ = e.what();
  } catch (const NotModelled& e) {
    failure_ = e.what();
  }
  leave();
  sc_core::sc_stop();
}

void Arm926::stay_in_reset() {
  take_clock();
  core_.restart(entry_, kernel_time());  // what is in its buffers is not sent any more
  held_ = true;
  while (in_reset_) wait_for(released_);
  held_ = false;
  core_.restart(entry_, kernel_time());
}

void Arm926::reset(ResetKind) {
  in_reset_ = true;
  asserted_ = kernel_time();
  core_.set_reset(true, asserted_);
  interrupt_.soon();
}

bool Arm926::idle() const {
  const Picoseconds now = kernel_time();
  return held_ && std::all_of(records_.begin(), records_.end(), [&](const Record& r) {
    return r.done && r.last <= now;
  });
}

void Arm926::leave_reset() {
  in_reset_ = false;
  core_.set_reset(false, kernel_time());
  released_.soon();
}

/// The reset changes the clock too. The core finishes its instruction with the old one: how many clocks
/// of a stall it has counted already depends on the synchronisation.
void Arm926::clock_changed() {
  const bool finishing = in_reset_ && !held_ && core_.clock().running();
  if (!finishing) take_clock();
}

void Arm926::take_clock() {
  core_.set_clock(clk.read(), kernel_time());
  ++clock_changes_;
  background_moved();
  if (!clk.read().stopped()) clock_runs_.soon();
}

/// Waits event by event, because each event may change the clock.
void Arm926::sleep_until(Picoseconds until) {
  const unsigned before = clock_changes_;
  for (;;) {
    const Picoseconds event = next_event();
    LookaheadInitiator::sleep_until(event < until ? event + 1 : until);
    if (event >= until || clock_changes_ != before) return;
  }
}

/// The core samples the lines at instruction boundaries strictly after the present time.
void Arm926::interrupt_changed() {
  const Picoseconds now = kernel_time();
  if (irq.read() != irq_) core_.set_irq(irq_ = irq.read(), now);
  if (fiq.read() != fiq_) core_.set_fiq(fiq_ = fiq.read(), now);
  if (irq_ || fiq_) {
    asserted_ = now;
    interrupt_.soon();
  }
}

Picoseconds Arm926::wait_for_interrupt(Picoseconds) {
  asleep_ = true;
  while (!irq_ && !fiq_ && !in_reset_) wait_for(interrupt_);
  asleep_ = false;
  return asserted_;
}

void Arm926::catch_up() {
  const Picoseconds boundary = core_.boundary_time();
  if (boundary <= kernel_time()) return;
  leave();
  sc_core::wait(ps_time(boundary - kernel_time()));
  enter();
}

[[gnu::noinline]] void Arm926::take_in(BusAccess& a) {
  FOVEA_CHECK(record_count_ < records_.size(), "the core has more accesses than it said");
  Record& r = records_[record_count_++];
  r.port = a.port == BusAccess::Port::kInstruction ? kInstructionPort : kDataPort;
  r.data = a.data;
  r.parts = &a.parts;
  r.access = &a;
  a.record = &r;
}

void Arm926::submit(BusAccess& a, Picoseconds at) {
  if (!a.record) [[unlikely]]
    take_in(a);
  Transaction& tx = record_of(a);
  a.done = a.error = false;
  a.least = least_latency(tx.port);
  tx.write = a.write;
  tx.locked = a.locked;
  tx.critical = a.kind == BusAccess::Kind::kWrap8 ? a.address & 31u : 0;
  tx.address = a.address - tx.critical;
  tx.bytes = a.bytes;
  a.outside = !in_memory(tx);
  LookaheadInitiator::submit(tx, at);
}

void Arm926::completed(Transaction& tx) {
  BusAccess& a = *static_cast<Record&>(tx).access;
  a.error = tx.error;
  a.first = tx.first;
  a.last = tx.last;
  a.done = true;
}

bool Arm926::poll(BusAccess& a, Picoseconds until) {
  return LookaheadInitiator::poll(record_of(a), until) && a.done && a.last <= until;
}

void Arm926::finish(BusAccess& a) { LookaheadInitiator::finish(record_of(a)); }

}  // namespace fovea::cpu
