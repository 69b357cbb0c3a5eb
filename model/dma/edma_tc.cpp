#include "model/dma/edma_tc.h"

#include <array>
#include <bit>
#include <cstdio>

namespace fovea::dma {
namespace {
constexpr std::uint32_t kTptc1Dbs = 1u << 7;
}  // namespace

/// TCCFG: the buses are 64 bits wide, as the crossbar.
EdmaTcRegs::EdmaTcRegs(unsigned number, unsigned fifo, unsigned depth)
    : RegBank("EDMATC" + std::to_string(number)),
      tccfg(*this, "TCCFG", 0x004, "configuration",
            (static_cast<unsigned>(std::bit_width(fifo / 32)) - 1) | 1u << 4 |
                (static_cast<unsigned>(std::bit_width(depth)) - 1) << 8) {
  for (unsigned n = 0; n < kDestinations; ++n)
    destination.emplace_back(*this, "DF", 0x300 + 0x40 * n, "destination " + std::to_string(n),
                             std::to_string(n));
}

EdmaTcRegs::Set::Set(RegBank& bank, const std::string& prefix, std::uint32_t offset,
                     const std::string& of, const std::string& suffix)
    : opt(bank, prefix + "OPT" + suffix, offset, Mode::kRo, of + ": options"),
      src(bank, prefix + "SRC" + suffix, offset + 0x4, Mode::kRo,
          of + (prefix == "DF" ? ": 0, not applicable" : ": source address")),
      cnt(bank, prefix + "CNT" + suffix, offset + 0x8, Mode::kRo, of + ": BCNT and ACNT that are left"),
      dst(bank, prefix + "DST" + suffix, offset + 0xC, Mode::kRo,
          of + (prefix == "SA" ? ": 0, not applicable" : ": destination address")),
      bidx(bank, prefix + "BIDX" + suffix, offset + 0x10, Mode::kRo, of + ": distances of arrays"),
      mpprxy(bank, prefix + "MPPRXY" + suffix, offset + 0x14, Mode::kRo,
             of + ": privilege, not modelled (0)") {}

namespace {
/// @throws UserError unless the size is a power of two, as TCCFG and the guides have them
unsigned power_of_two(const IntParam& p) {
  const auto n = static_cast<unsigned>(p());
  if (!std::has_single_bit(n))
    throw UserError("key '" + p.key() + "': " + p.text() + " is not allowed; allowed: powers of two");
  return n;
}
}  // namespace

EdmaTc::EdmaTc(sc_core::sc_module_name name, unsigned number, const EdmaTcParams& params)
    : WithRegs(number, power_of_two(params.fifo), power_of_two(params.depth)),
      BusTarget(name, regs),
      stats(number),
      number_(number),
      params_(params),
      reads_("reads", edma_read(number), static_cast<unsigned>(params.outstanding()),
             BurstMaster::Report::kWhenDecided),
      writes_("writes", edma_write(number), static_cast<unsigned>(params.outstanding()),
              BurstMaster::Report::kWhenDecided),
      core_(*this, {number == 1 ? 32 : power_of_two(params.burst), static_cast<unsigned>(params.fifo()),
                    static_cast<unsigned>(params.depth())}) {
  add_clock(clk);
  add_power_gate(lpsc);
  add_interrupt("tcerrint" + std::to_string(number), error.out);
  add_statistics(stats);
  stats.busy_until = [this](Picoseconds now) { return core_.busy(now); };
  stats.start_count = [this](Picoseconds now) { core_.start_count(now); };
  const auto outstanding = static_cast<unsigned>(params.outstanding());
  add_master(edma_read(number), reads_.socket, outstanding);
  add_master(edma_write(number), writes_.socket, outstanding);
  reads_.on_done = [this](const BurstMaster::Completion& c) {
    if (in_reset_) return;
    stats.reads.add(c.last, 1);
    core_.read_done(c.data, c.error, c.last);
  };
  writes_.on_done = [this](const BurstMaster::Completion& c) {
    if (in_reset_) return;
    stats.writes.add(c.last, 1);
    stats.bytes.add(c.last, c.data.size());
    core_.write_done(c.error, c.last);
  };
  show_status();
  show_interrupts();
  show_errors();
  show_sets();
  regs.rdrate.on_write([this](std::uint32_t) {
    static constexpr std::array<unsigned, 5> kClocks{1, 4, 8, 16, 32};
    const std::uint32_t rate = regs.rdrate.rate.get();
    if (rate >= kClocks.size()) {
      diagnostics().guest("EDMA: RDRATE " + std::to_string(rate) + " is reserved; allowed: 0 to 4");
      return;
    }
    core_.set_read_interval(kClocks[rate]);
  });
  SC_METHOD(clock_changed);
  sensitive << clk << lpsc;
  SC_METHOD(act);
  sensitive << due_timer_.event();
  dont_initialize();
}

void EdmaTc::report_in_kernel_time() {
  in_kernel_time_ = true;
  reads_.set_report(BurstMaster::Report::kAtLastBeat);
  writes_.set_report(BurstMaster::Report::kAtLastBeat);
}

void EdmaTc::show_status() {
  regs.tcstat.on_read([this] {
    const Picoseconds now = kernel_time();
    regs.tcstat.program.set(core_.program_taken(now));
    regs.tcstat.source.set(core_.source_active(now));
    regs.tcstat.writes.set(core_.writing(now));
    regs.tcstat.destinations.set(static_cast<std::uint32_t>(core_.destinations(now)));
    regs.tcstat.head.set(core_.destination_head(now));
  });
}

/// Counted, so that what is decided ahead of the present is not seen before its time.
void EdmaTc::show_interrupts() {
  regs.intstat.on_read([this] {
    regs.intstat.program.set(core_.loaded(kernel_time()) > loads_cleared_);
    regs.intstat.done.set(core_.ended(kernel_time()) > ends_cleared_);
  });
  regs.intclr.on_write([this](std::uint32_t word) {
    if (word & regs.intclr.program.mask()) loads_cleared_ = core_.loaded(kernel_time());
    if (word & regs.intclr.done.mask()) ends_cleared_ = core_.ended(kernel_time());
  });
  const auto warn = [this](std::uint32_t word) {
    if (word & 3u)
      diagnostics().guest("the interrupt of " + regs.name() + " (INTEN, INTCMD) is not connected on this chip");
  };
  regs.inten.on_write(warn);
  regs.intcmd.on_write(warn);
}

void EdmaTc::show_errors() {
  regs.errclr.on_write([this](std::uint32_t word) {
    regs.errstat.set(regs.errstat.get() & ~word);
    if (word & regs.errclr.bus.mask()) regs.errdet.set(0);
  });
  regs.errcmd.on_write([this](std::uint32_t word) {
    if ((word & 1) && (regs.errstat.get() & regs.erren.get())) error.raise();
  });
}

/// The identification register is there on the chip, with a value that is not known.
bool EdmaTc::hole_accessed(std::uint32_t offset) {
  if (offset < 4) return false;
  set_error(regs.errstat.address);
  char text[96];
  std::snprintf(text, sizeof text, "access to a reserved address of %s, offset 0x%x",
                regs.name().c_str(), offset);
  diagnostics().guest(text);
  return true;
}

/// What does not apply to a set reads as 0: the destination of the source active, the source of a
/// destination register.
void EdmaTc::show_sets() {
  const auto program = [this] { return core_.program_set(); };
  const auto source = [this] { return core_.source_set(kernel_time()); };
  show(regs.program, program);
  regs.program.src.on_read([this] { regs.program.src.set(core_.program_set().request.source.address); });
  regs.program.dst.on_read(
      [this] { regs.program.dst.set(core_.program_set().request.destination.address); });
  show(regs.source, source);
  regs.source.src.on_read([this] {
    const RegisterSet s = core_.source_set(kernel_time());
    regs.source.src.set(s.address(s.request.source));
  });
  regs.sacntrld.on_read([this] { regs.sacntrld.set(core_.source_set(kernel_time()).request.acnt); });
  regs.sasrcbref.on_read([this] {
    const RegisterSet s = core_.source_set(kernel_time());
    regs.sasrcbref.set(s.reference(s.request.source));
  });
  const auto written = [this] {
    return core_.destination_set(core_.destination_writing(kernel_time()), kernel_time());
  };
  regs.dfcntrld.on_read([this, written] { regs.dfcntrld.set(written().request.acnt); });
  regs.dfdstbref.on_read([this, written] {
    const RegisterSet s = written();
    regs.dfdstbref.set(s.reference(s.request.destination));
  });
  for (unsigned n = 0; n < static_cast<unsigned>(params_.depth()); ++n) {
    EdmaTcRegs::Set& d = regs.destination[n];
    show(d, [this, n] { return core_.destination_set(n, kernel_time()); });
    d.dst.on_read([this, &d, n] {
      const RegisterSet s = core_.destination_set(n, kernel_time());
      d.dst.set(s.address(s.request.destination));
    });
  }
}

/// What all sets have.
void EdmaTc::show(EdmaTcRegs::Set& r, std::function<RegisterSet()> set) {
  r.opt.on_read([this, &r, set] {
    const RegisterSet s = set();
    r.opt.set(s.request.acnt ? s.options(channels_->priority[number_].read()) : 0);
  });
  r.cnt.on_read([&r, set] { r.cnt.set(set().counts()); });
  r.bidx.on_read([&r, set] { r.bidx.set(set().indices()); });
}

/// Bursts under way are still answered, but the controller no longer waits for the answers.
void EdmaTc::on_reset(ResetKind) {
  in_reset_ = true;
  core_.reset();
  loads_cleared_ = ends_cleared_ = 0;
  due_.clear();
  for (TimedCounter* c : {&stats.requests, &stats.reads, &stats.writes, &stats.bytes}) c->drop_ahead();
  core_.set_read_interval(1);
  program_free_ = 0;
}

void EdmaTc::leave_reset() { in_reset_ = false; }

void EdmaTc::attach(EdmaCc& channels) {
  channels_ = &channels;
  channels.attach(number_, *this);
}

/// TC1 has 32 bytes out of reset and 64 by MISC.TPTC1_BST (TI's register header); the others a parameter.
unsigned EdmaTc::burst() const {
  if (number_ != 1) return power_of_two(params_.burst);
  return misc.read() & kTptc1Dbs ? 64 : 32;
}

void EdmaTc::clock_changed() {
  if (clk.read() != clock_.frequency()) clock_.restart(clk.read(), kernel_time());
  if (!running()) return;
  core_.resume(kernel_time());
  channels_->program_free(std::max(program_free_, kernel_time()) + 1);
}

Picoseconds EdmaTc::program_free() const {
  return !running() || core_.program_busy() ? kNever : program_free_;
}

void EdmaTc::submit(const TransferRequest& request) {
  core_.set_burst(burst());
  if (on_request) on_request(request, kernel_time());
  core_.submit(request, kernel_time());
}

Picoseconds EdmaTc::edge(Picoseconds t, unsigned clocks) const {
  return clock_.edge(clock_.edge_at_or_after(t) + clocks);
}

/// A gated or stopped clock keeps bursts from being issued; clock_changed() continues.
Picoseconds EdmaTc::read_free() const { return running() ? reads_.free_from() : kNever; }
Picoseconds EdmaTc::write_free() const { return running() ? writes_.free_from() : kNever; }

void EdmaTc::read(Command burst, Picoseconds at) {
  reads_.read(burst.address, burst.bytes, 0, at, false);
}

void EdmaTc::write(Command burst, std::span<const std::uint8_t> data, Picoseconds at) {
  writes_.write(burst.address, data, 0, at, false);
}

void EdmaTc::program_free(Picoseconds at) {
  program_free_ = at;
  channels_->program_free(at + 1);
}

void EdmaTc::completed(const TransferRequest& request, Picoseconds at) {
  stats.requests.add(at, 1);
  if (on_ended) at_its_time(at, [this, request, at] { on_ended(request, at); });
  channels_->completed(request, at);
}

/// Calls f in kernel time.
void EdmaTc::at_its_time(Picoseconds at, std::function<void()> f) {
  if (in_kernel_time_) return f();
  due_.emplace(at, std::move(f));
  due_timer_.at(at);
}

void EdmaTc::act() {
  while (!due_.empty() && due_.begin()->first <= kernel_time()) {
    const std::function<void()> f = std::move(due_.begin()->second);
    due_.erase(due_.begin());
    f();
  }
  if (!due_.empty()) due_timer_.at(due_.begin()->first);
}

void EdmaTc::failed(const TransferRequest& request, TransferController::Failure failure,
                    Picoseconds at) {
  using Failure = TransferController::Failure;
  if (failure != Failure::kRequest)
    return at_its_time(at, [this, request, failure] { report_bus_error(request, failure == Failure::kRead); });
  // As soon as it is submitted.
  if (on_ended) on_ended(request, at);
  channels_->dropped(request);
  ++stats.errors;
  set_error(regs.errstat.request);
  diagnostics().guest("EDMA: a request with constant addressing whose address or index is no multiple of 32");
}

/// The details are those of the first error.
void EdmaTc::report_bus_error(const TransferRequest& request, bool read) {
  if (!regs.errstat.bus.get()) {
    regs.errdet.status.set(read ? 1 : 9);
    regs.errdet.tcc.set(request.tcc);
    regs.errdet.interrupt.set(request.interrupt);
    regs.errdet.chain.set(request.chain);
  }
  ++stats.errors;
  set_error(regs.errstat.bus);
  diagnostics().guest(read ? "EDMA: a read that no slave answers (bus error)"
                           : "EDMA: a write that no slave answers (bus error)");
}

/// The interrupt is raised with the first enabled error.
void EdmaTc::set_error(Field& which) {
  const std::uint32_t before = regs.errstat.get() & regs.erren.get();
  which.set(1);
  if (!before && (regs.errstat.get() & regs.erren.get())) error.raise();
}

}  // namespace fovea::dma
