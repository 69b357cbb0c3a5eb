// I2C controller in master mode.
#pragma once
#include <cstdint>
#include <systemc>

#include "model/common/sc_ports.h"
#include "model/periph/clocked_target.h"

namespace fovea::periph {

/// Registers of the DaVinci I2C at 0x01C21000 (Linux i2c-davinci.c, TI boot loader device.h).
struct I2cRegs : RegBank {
  Reg icoar{*this, "ICOAR", 0x00, Mode::kRw, "own address; target mode is not modelled"};
  Reg icimr{*this, "ICIMR", 0x04, Mode::kRw, "interrupt enables, bits as ICSTR 6:0"};
  Reg icstr{*this, "ICSTR", 0x08, Mode::kRw, "status; 1 clears AL, NACK, ARDY, ICRRDY, SCD",
            0x410};
  Reg icclkl{*this, "ICCLKL", 0x0C, Mode::kRw, "low time of SCL, prescaled clocks - d"};
  Reg icclkh{*this, "ICCLKH", 0x10, Mode::kRw, "high time of SCL, prescaled clocks - d"};
  Reg iccnt{*this, "ICCNT", 0x14, Mode::kRw, "bytes to move; 0 means 65536"};
  Reg icdrr{*this, "ICDRR", 0x18, Mode::kRo, "received byte"};
  Reg icsar{*this, "ICSAR", 0x1C, Mode::kRw, "target address", 0x3FF};
  Reg icdxr{*this, "ICDXR", 0x20, Mode::kRw, "byte to send"};
  struct Icmdr : Reg {
    using Reg::Reg;
    Field bc{*this, "BC", 0, 3, Mode::kRw, "bits a byte; only 0 (8 bits) is modelled"};
    Field fdf{*this, "FDF", 3, 1, Mode::kRw, "free data format; not modelled"};
    Field stb{*this, "STB", 4, 1, Mode::kRw, "start byte; not modelled"};
    Field irs{*this, "IRS", 5, 1, Mode::kRw, "0: controller in reset"};
    Field dlb{*this, "DLB", 6, 1, Mode::kRw, "digital loop back; not modelled"};
    Field rm{*this, "RM", 7, 1, Mode::kRw, "repeat: no byte count, until STP"};
    Field xa{*this, "XA", 8, 1, Mode::kRw, "10-bit address; not modelled"};
    Field trx{*this, "TRX", 9, 1, Mode::kRw, "1 transmitter, 0 receiver"};
    Field mst{*this, "MST", 10, 1, Mode::kRw, "1 master; cleared with the STOP"};
    Field stp{*this, "STP", 11, 1, Mode::kRw, "STOP when the count is done; cleared with it"};
    Field stt{*this, "STT", 13, 1, Mode::kRw, "START; cleared with it"};
    Field free{*this, "FREE", 14, 1, Mode::kRw, "emulation; kept"};
    Field nackmod{*this, "NACKMOD", 15, 1, Mode::kRw, "receiver answers the next byte with NACK"};
  } icmdr{*this, "ICMDR", 0x24, "mode"};
  Reg icivr{*this, "ICIVR", 0x28, Mode::kRo, "most urgent interrupt: 1 AL ... 6 SCD; 0 none"};
  Reg icemdr{*this, "ICEMDR", 0x2C, Mode::kRw, "extended mode; kept", 0x1};
  Reg icpsc{*this, "ICPSC", 0x30, Mode::kRw, "prescaler - 1"};
  Reg icpid1{*this, "ICPID1", 0x34, Mode::kRo, "peripheral identification (value not public)"};
  Reg icpid2{*this, "ICPID2", 0x38, Mode::kRo, "peripheral identification (value not public)"};

  I2cRegs() : RegBank("I2C") {}
};

/// I2C in master mode, with bit timing: a bit takes (ICPSC + 1) x (ICCLKL + ICCLKH + 2d) clock
/// periods with d = 7, 6 or 5 for ICPSC = 0, 1 or more. START and STOP take one bit each (assumed),
/// a byte with its acknowledge nine. Targets are called when a byte is complete. The controller
/// stretches the clock while ICDXR is empty or ICDRR was not read.
///
/// When the byte count is done, STP causes a STOP (SCD); without STP the bus is held and ARDY is
/// set, and STT then causes a repeated START. A NACK holds the bus until STP or STT is written.
/// Reading ICIVR clears the flag that it reports, except ICRRDY and ICXRDY, which follow the data.
///
/// ICSTR always shows whether ICDXR is empty. But ICXRDY requests an interrupt only during a
/// transmission, from its START to its last byte: Linux i2c-davinci.c enables the interrupt, then
/// loads the first byte, and then writes STT. Not modelled: target mode, arbitration, 10-bit
/// addresses, use of the pins as general-purpose pins.
class I2cController : public WithRegs<I2cRegs>, public ClockedTarget {
 public:
  SC_HAS_PROCESS(I2cController);
  sc_core::sc_port<I2cTargetIf, 0, sc_core::SC_ZERO_OR_MORE_BOUND> targets{"targets"};
  OptionalOut<bool> irq{"irq"};  ///< level; high while an enabled flag of ICSTR is set

  OptionalIn<bool> pins{"pins"};  ///< true while PINMUX assigns SCL and SDA to the controller; may
                                  ///< stay unbound

  explicit I2cController(sc_core::sc_module_name name);

 private:
  enum class State { kIdle, kAddress, kSend, kReceive, kWaitData, kWaitRead, kHeld, kStop };

  std::uint64_t bit_ticks() const;
  void mode_written();
  void start();
  void begin(State state, unsigned bits);
  void step();  // called when the last bit of the current state has ended
  void address_done();
  void next_byte();
  void byte_finished();  // called after a byte in either direction
  void stop_or_hold();
  void nack();
  void abandon_transfer();
  void on_reset(ResetKind) override;
  std::uint32_t flags() const { return status_; }
  void set_flag(std::uint32_t bit) { status_ |= bit; }
  void clear_flag(std::uint32_t bit) { status_ &= ~bit; }
  bool sending() const;  ///< a transmission has begun and its last byte was not sent yet
  std::uint32_t pending_vector() const;
  void clock_changed() override { wake_.soon(); }
  void refresh() { wake_.soon(); }
  void update();

  State state_ = State::kIdle;
  std::uint32_t status_;
  std::uint32_t remaining_ = 0;
  std::uint8_t shift_ = 0, received_ = 0;
  I2cTargetIf* target_ = nullptr;
  std::uint64_t done_tick_ = kNever;
  Timer wake_;
};

}  // namespace fovea::periph
