#include "model/periph/i2c_controller.h"

#include <utility>

namespace fovea::periph {

namespace {
enum : std::uint32_t {
  kAl = 1u << 0,
  kNack = 1u << 1,
  kArdy = 1u << 2,
  kRrdy = 1u << 3,
  kXrdy = 1u << 4,
  kScd = 1u << 5,
  kXsmt = 1u << 10,
  kRsfull = 1u << 11,
  kBusBusy = 1u << 12,
  kNackSnt = 1u << 13,
};
constexpr std::uint32_t kIdleStatus = kXsmt | kXrdy;
}  // namespace

I2cController::I2cController(sc_core::sc_module_name name)
    : ClockedTarget(name, regs), status_(kIdleStatus) {
  add_interrupt("irq", irq);
  regs.icstr.on_read([this] { regs.icstr.set(status_); });
  regs.icstr.on_write([this](std::uint32_t word) {
    clear_flag(word & (kAl | kNack | kArdy | kRrdy | kScd | kNackSnt));
    refresh();
  });
  regs.icimr.on_write([this](std::uint32_t) { refresh(); });
  regs.icdxr.on_write([this](std::uint32_t) {
    if (!(regs.icdxr.written_lanes() & 0xFF)) return;  // the data are the lowest byte
    clear_flag(kXrdy);
    if (state_ == State::kWaitData) next_byte();
    refresh();
  });
  regs.icdrr.on_read([this] {
    regs.icdrr.set(received_);
    clear_flag(kRrdy);
    if (state_ == State::kWaitRead) {  // the byte that waited in the shift register moves to ICDRR
      clear_flag(kRsfull);
      byte_finished();
    }
    refresh();
  });
  regs.icivr.on_read([this] {
    const std::uint32_t v = pending_vector();
    regs.icivr.set(v);
    if (v) clear_flag((1u << (v - 1)) & ~(kRrdy | kXrdy));
    refresh();
  });
  regs.icmdr.on_write([this](std::uint32_t) { mode_written(); });
  regs.icpsc.on_write([this](std::uint32_t) {
    if (running_ && (regs.icpsc.get() & 0xFF) != prescaler_)
      diagnostics().guest(
          "I2C.ICPSC is written while ICMDR.IRS is 1: the prescaler is taken when IRS goes "
          "from 0 to 1");
  });
  SC_METHOD(update);
  sensitive << wake_.event();
}

std::uint64_t I2cController::bit_ticks() const {
  const std::uint64_t psc = prescaler_;
  const std::uint64_t d = psc == 0 ? 7 : psc == 1 ? 6 : 5;
  return (psc + 1) * ((regs.icclkl.get() & 0xFFFF) + (regs.icclkh.get() & 0xFFFF) + 2 * d);
}

bool I2cController::sending() const {
  return regs.icmdr.trx &&
         (state_ == State::kAddress || state_ == State::kSend || state_ == State::kWaitData);
}

std::uint32_t I2cController::pending_vector() const {
  std::uint32_t active = status_ & regs.icimr.get() & 0x3F;
  if (!sending()) active &= ~kXrdy;
  for (unsigned n = 0; n < 6; ++n)
    if (active >> n & 1) return n + 1;
  return 0;
}

void I2cController::abandon_transfer() {
  if (target_) target_->i2c_stop();
  target_ = nullptr;
  state_ = State::kIdle;
  status_ = kIdleStatus;
  done_tick_ = kNever;
}

void I2cController::on_reset(ResetKind) {
  abandon_transfer();
  running_ = false;
  prescaler_ = 0;
  remaining_ = 0;
  shift_ = received_ = 0;
  refresh();
}

void I2cController::mode_written() {
  auto& m = regs.icmdr;
  if (!m.irs) {
    running_ = false;
    abandon_transfer();
    refresh();
    return;
  }
  if (!std::exchange(running_, true)) prescaler_ = regs.icpsc.get() & 0xFF;
  if (m.xa || m.fdf || m.stb || m.dlb || m.bc) diagnostics().not_modelled("I2C mode bits XA, FDF, STB, DLB or BC");
  const bool free = state_ == State::kIdle || state_ == State::kHeld;
  if (m.mst && m.stt && free)
    start();
  else if (m.stp && state_ == State::kHeld)
    begin(State::kStop, 1);
  else if (m.stp && m.rm && state_ == State::kWaitData)
    begin(State::kStop, 1);  // a transfer in repeat mode ends only by STP
  refresh();
}

void I2cController::begin(State state, unsigned bits) {
  // Consecutive bits start at the end of the previous one; after a stretched clock or on an idle
  // bus, the first bit starts at the next edge.
  const std::uint64_t from = done_tick_ == ticks() ? done_tick_ : ticks() + 1;
  state_ = state;
  done_tick_ = from + bits * bit_ticks();
}

void I2cController::start() {
  check_pins(pins, "PINMUX3 bits 22:21 and 24:23 = 2");
  regs.icmdr.stt.set(0);
  remaining_ = regs.iccnt.get() & 0xFFFF;
  if (remaining_ == 0) remaining_ = 65536;
  clear_flag(kNack | kArdy | kScd | kNackSnt);
  set_flag(kBusBusy);
  done_tick_ = kNever;
  begin(State::kAddress, 1 + 9);
}

void I2cController::step() {
  switch (state_) {
    case State::kAddress:
      address_done();
      break;
    case State::kSend:
      if (!target_->i2c_write(shift_)) {
        nack();
        break;
      }
      if (!regs.icmdr.rm) --remaining_;
      stop_or_hold();
      break;
    case State::kReceive:
      shift_ = target_->i2c_read();
      if (flags() & kRrdy) {
        state_ = State::kWaitRead;
        set_flag(kRsfull);
      } else {
        byte_finished();
      }
      break;
    case State::kStop:
      if (target_) target_->i2c_stop();
      target_ = nullptr;
      state_ = State::kIdle;
      regs.icmdr.stp.set(0);
      regs.icmdr.mst.set(0);
      clear_flag(kBusBusy);
      set_flag(kScd);
      break;
    case State::kIdle:
    case State::kWaitData:
    case State::kWaitRead:
    case State::kHeld:
      break;
  }
}

void I2cController::address_done() {
  const auto address = static_cast<std::uint8_t>(regs.icsar.get() & 0x7F);
  target_ = nullptr;
  for (int n = 0; n < targets.size(); ++n)
    if (targets[n]->i2c_start(address, !regs.icmdr.trx) && !target_) target_ = targets[n];
  if (!target_)
    nack();
  else
    next_byte();
}

void I2cController::next_byte() {
  if (!regs.icmdr.trx) {
    begin(State::kReceive, 9);
  } else if (flags() & kXrdy) {  // nothing to send so far
    if (regs.icmdr.rm && regs.icmdr.stp) {
      begin(State::kStop, 1);
      return;
    }
    if (regs.icmdr.rm) set_flag(kArdy);
    state_ = State::kWaitData;
    clear_flag(kXsmt);
  } else {
    shift_ = static_cast<std::uint8_t>(regs.icdxr.get());
    set_flag(kXrdy | kXsmt);
    if (on_transmit_event) on_transmit_event();
    begin(State::kSend, 9);
  }
}

void I2cController::byte_finished() {
  received_ = shift_;
  set_flag(kRrdy);
  if (on_receive_event) on_receive_event();
  if (!regs.icmdr.rm) --remaining_;
  if (regs.icmdr.nackmod) {
    set_flag(kNackSnt);
    regs.icmdr.nackmod.set(0);
    remaining_ = 0;
  }
  stop_or_hold();
}

void I2cController::stop_or_hold() {
  const bool more = regs.icmdr.rm ? !regs.icmdr.stp || regs.icmdr.trx : remaining_ != 0;
  if (more) {
    next_byte();
  } else if (regs.icmdr.stp) {
    begin(State::kStop, 1);
  } else {
    state_ = State::kHeld;
    set_flag(kArdy);
  }
}

void I2cController::nack() {
  set_flag(kNack);
  state_ = State::kHeld;
}

void I2cController::update() {
  if (ticks() >= done_tick_) {
    const std::uint64_t ended = done_tick_;
    step();
    if (done_tick_ == ended) done_tick_ = kNever;
  }
  irq.write(pending_vector() != 0);
  wake_.move_to(time_of(done_tick_));
}

}  // namespace fovea::periph
