#include "model/periph/uart16550.h"

#include <algorithm>

namespace fovea::periph {

namespace {
enum : std::uint32_t { kDr = 0x01, kOe = 0x02, kThre = 0x20, kTemt = 0x40 };
enum : std::uint8_t { kErbi = 1, kEtbei = 2, kElsi = 4 };
enum : std::uint32_t { kNone = 1, kTxEmpty = 2, kRxData = 4, kLineStatus = 6, kRxTimeout = 12 };

/// The part's registers have eight bits: a write of the other bytes of a word reaches none of them.
bool reaches(const Reg& reg) { return reg.written_lanes() & 0xFF; }
}  // namespace

Uart16550::Uart16550(sc_core::sc_module_name name, const char* selection)
    : ClockedTarget(name, regs), selection_(selection) {
  add_interrupt("irq", irq);
  // Several registers share the offsets 0, 4 and 8, so their values are kept outside the bank.
  regs.rbr.on_write([this](std::uint32_t word) {
    if (!reaches(regs.rbr)) return;
    if (regs.lcr.dlab)
      regs.dll.set(word & 0xFF);
    else
      data_written(static_cast<std::uint8_t>(word));
  });
  regs.rbr.on_read([this] {
    if (!regs.lcr.dlab) read_data();
    regs.rbr.set(regs.lcr.dlab ? regs.dll.get() : last_rx_);
  });
  regs.ier.on_write([this](std::uint32_t word) {
    if (!reaches(regs.ier)) return;
    if (regs.lcr.dlab) {
      regs.dlh.set(word & 0xFF);
    } else {
      // Enabling the transmit interrupt while the holding register is empty raises the interrupt
      // (16550).
      if ((word & ~ier_ & kEtbei) && tx_.empty()) thre_event_ = true;
      ier_ = static_cast<std::uint8_t>(word & 0x0F);
    }
    refresh();
  });
  regs.ier.on_read([this] { regs.ier.set(regs.lcr.dlab ? regs.dlh.get() : ier_); });
  regs.iir.on_write([this](std::uint32_t word) {
    if (reaches(regs.iir)) fcr_written(word);
  });
  regs.iir.on_read([this] {
    const std::uint32_t id = interrupt_id();
    regs.iir.set(id | (fifo_mode() ? 0xC0u : 0u));
    if (id == kTxEmpty) thre_event_ = false;
    refresh();
  });
  regs.lsr.on_read([this] {
    regs.lsr.set((rx_.empty() ? 0u : kDr) | (overrun_ ? kOe : 0u) | (tx_.empty() ? kThre : 0u) |
                 (tx_.empty() && !shifting_ ? kTemt : 0u));
    if (overrun_) refresh();  // polling without an overrun causes no kernel activity
    overrun_ = false;
  });
  auto kick = [this](std::uint32_t) { refresh(); };
  regs.pwremu.on_write([this](std::uint32_t) { power_written(); });
  regs.dll.on_write(kick);
  regs.dlh.on_write(kick);
  SC_METHOD(update);
  sensitive << wake_.event();
}

/// The byte that is being sent is lost.
void Uart16550::on_reset(ResetKind) {
  tx_.clear();
  rx_.clear();
  shift_ = ier_ = fcr_ = last_rx_ = 0;
  shifting_ = overrun_ = rx_timeout_ = transmitter_on_ = false;
  thre_event_ = true;
  done_tick_ = timeout_tick_ = kNever;
  refresh();
}

void Uart16550::refresh() {
  wake_.soon();
  if (on_ready) on_ready();
}

bool Uart16550::can_receive() const {
  return regs.pwremu.urrst && clocked() && running() && divisor() != 0 && !regs.mcr.loop &&
         rx_.size() < capacity();
}

Picoseconds Uart16550::character_time() const {
  return time_of(ticks() + character_ticks()) - kernel_time();
}

std::uint64_t Uart16550::character_ticks() const {
  const unsigned data = 5 + regs.lcr.wls.get();
  const unsigned stop_halves = !regs.lcr.stb ? 2 : data == 5 ? 3 : 4;
  const unsigned halves = 2 * (1 + data + regs.lcr.pen.get()) + stop_halves;
  const unsigned samples = regs.mdr.get() & 1 ? 13 : 16;
  return std::uint64_t{samples} * divisor() * halves / 2;
}

void Uart16550::data_written(std::uint8_t byte) {
  if (tx_.size() >= capacity()) {
    diagnostics().guest("UART transmit overrun: THR written while full");
    tx_.pop_back();  // the byte in the holding register is overwritten
  }
  tx_.push_back(byte);
  thre_event_ = false;
  refresh();
}

void Uart16550::read_data() {
  rx_timeout_ = false;
  if (!rx_.empty()) {
    last_rx_ = rx_.front();
    rx_.pop_front();
  }
  timeout_tick_ = rx_.empty() ? kNever : ticks() + 4 * character_ticks();
  refresh();
}

/// Without FIFOEN the other bits are not programmed (PC16550D, 8.4).
void Uart16550::fcr_written(std::uint32_t word) {
  const bool was = fifo_mode();
  if (!(word & 1)) word = 0;
  fcr_ = static_cast<std::uint8_t>(word & 0xC9);
  const bool toggled = was != fifo_mode();  // changing the mode empties both FIFOs
  if ((word & 2) || toggled) {
    rx_.clear();
    rx_timeout_ = false;
    timeout_tick_ = kNever;
  }
  if ((word & 4) || toggled) {
    if (!tx_.empty()) thre_event_ = true;
    tx_.clear();
  }
  refresh();
}

void Uart16550::power_written() {
  const bool released = regs.pwremu.utrst && !transmitter_on_;
  transmitter_on_ = regs.pwremu.utrst.get() != 0;
  if (released && tx_.empty() && sends_events() && on_transmit_event) on_transmit_event();
  refresh();
}

void Uart16550::receive(std::uint8_t byte) {
  if (!regs.pwremu.urrst || !clocked()) return;
  if (rx_.size() >= capacity()) {
    overrun_ = true;
    if (!fifo_mode()) rx_.front() = byte;  // 16450: the new byte replaces the unread one
  } else {
    rx_.push_back(byte);
    if (rx_.size() == trigger_level() && sends_events() && on_receive_event) on_receive_event();
  }
  rx_timeout_ = false;
  if (fifo_mode()) timeout_tick_ = ticks() + 4 * character_ticks();
  refresh();
}

unsigned Uart16550::trigger_level() const {
  static constexpr unsigned kTrigger[] = {1, 4, 8, 14};
  return fifo_mode() ? kTrigger[fcr_ >> 6] : 1;
}

std::uint32_t Uart16550::interrupt_id() const {
  if ((ier_ & kElsi) && overrun_) return kLineStatus;
  if ((ier_ & kErbi) && rx_.size() >= trigger_level()) return kRxData;
  if ((ier_ & kErbi) && rx_timeout_) return kRxTimeout;
  if ((ier_ & kEtbei) && thre_event_) return kTxEmpty;
  return kNone;
}

void Uart16550::start_next(std::uint64_t first_tick) {
  if (shifting_ || tx_.empty() || !regs.pwremu.utrst || divisor() == 0 || !running()) return;
  shift_ = tx_.front();
  tx_.pop_front();
  if (tx_.empty()) {
    thre_event_ = true;
    if (sends_events() && on_transmit_event) on_transmit_event();
  }
  shifting_ = true;
  if (!regs.mcr.loop) check_pins(pins, selection_);
  done_tick_ = first_tick + character_ticks();
}

void Uart16550::update() {
  const std::uint64_t t = ticks();
  std::uint64_t first_tick = t + 1;       // an idle transmitter starts at the next edge
  if (!regs.pwremu.utrst && shifting_) {  // a transmitter in reset drops its byte
    shifting_ = false;
    done_tick_ = kNever;
  }
  if (shifting_ && t >= done_tick_) {
    shifting_ = false;
    first_tick = done_tick_;
    done_tick_ = kNever;
    ++transmitted_;
    if (regs.mcr.loop)
      receive(shift_);
    else if (sink)
      sink(shift_, kernel_time());
  }
  start_next(first_tick);
  if (t >= timeout_tick_) {
    rx_timeout_ = !rx_.empty();
    timeout_tick_ = kNever;
    if (rx_timeout_ && sends_events() && on_receive_event) on_receive_event();
  }
  irq.write(interrupt_id() != kNone);
  wake_.move_to(time_of(std::min(done_tick_, timeout_tick_)));
}

}  // namespace fovea::periph
