// UART with 16-byte FIFOs and registers at a pitch of 4 bytes.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <systemc>

#include "model/periph/clocked_target.h"

namespace fovea::periph {

/// Registers of UART0 and UART1: a 16550 at a 4-byte pitch plus DaVinci's additions (TI boot
/// loader, Linux 8250). DLL and DLH are also accessible at 0x20 and 0x24, without DLAB.
struct UartRegs : RegBank {
  Reg rbr{*this, "RBR_THR", 0x00, Mode::kRw, "receive / transmit data; DLL while LCR.DLAB"};
  Reg ier{*this, "IER", 0x04, Mode::kRw, "1 RX data, 2 TX empty, 4 line status; DLH under DLAB"};
  Reg iir{*this, "IIR_FCR", 0x08, Mode::kRw, "interrupt identification / FIFO control", 0x01};
  struct Lcr : Reg {
    using Reg::Reg;
    Field wls{*this, "WLS", 0, 2, Mode::kRw, "data bits - 5"};
    Field stb{*this, "STB", 2, 1, Mode::kRw, "1: 2 stop bits (1.5 with 5 data bits)"};
    Field pen{*this, "PEN", 3, 1, Mode::kRw, "parity bit"};
    Field eps{*this, "EPS_SP_BC", 4, 3, Mode::kRw, "parity kind and break; kept, no effect"};
    Field dlab{*this, "DLAB", 7, 1, Mode::kRw, "divisor latch at offsets 0 and 4"};
  } lcr{*this, "LCR", 0x0C, "line control"};
  struct Mcr : Reg {
    using Reg::Reg;
    Field rts{*this, "DTR_RTS_OUT", 0, 4, Mode::kRw, "modem outputs; kept, no effect"};
    Field loop{*this, "LOOP", 4, 1, Mode::kRw, "transmitter feeds the receiver"};
    Field afe{*this, "AFE", 5, 1, Mode::kRw, "automatic flow control; kept, no effect"};
  } mcr{*this, "MCR", 0x10, "modem control"};
  Reg lsr{*this, "LSR", 0x14, Mode::kRo, "1 DR, 2 OE, 0x20 THRE, 0x40 TEMT", 0x60};
  Reg msr{*this, "MSR", 0x18, Mode::kRo, "modem status; inputs are not wired"};
  Reg scr{*this, "SCR", 0x1C, Mode::kRw, "scratch"};
  Reg dll{*this, "DLL", 0x20, Mode::kRw, "divisor, low byte"};
  Reg dlh{*this, "DLH", 0x24, Mode::kRw, "divisor, high byte"};
  Reg pid1{*this, "PID1", 0x28, Mode::kRo, "peripheral identification (value not public)"};
  Reg pid2{*this, "PID2", 0x2C, Mode::kRo, "peripheral identification (value not public)"};
  struct Pwremu : Reg {
    using Reg::Reg;
    Field free{*this, "FREE", 0, 1, Mode::kRw, "emulation; kept, no effect"};
    Field urrst{*this, "URRST", 13, 1, Mode::kRw, "1: receiver runs"};
    Field utrst{*this, "UTRST", 14, 1, Mode::kRw, "1: transmitter runs"};
  } pwremu{*this, "PWREMU_MGMT", 0x30, "both halves are in reset until set"};
  Reg mdr{*this, "MDR", 0x34, Mode::kRw, "bit 0: 13 samples a bit instead of 16"};

  UartRegs() : RegBank("UART") {}
};

/// A byte is sent in real time: start, data, parity and stop bits of 16 (13) x divisor clock
/// periods each, the first one from the first clock edge after the write; the next byte follows
/// without a gap. The baud generator starts with the byte (the phase of the chip's generator is not
/// public). The interrupt output is a level. Not modelled: parity and framing errors, break, modem
/// lines.
///
/// DMA events (SPRUH82C, "DMA Event Support") are sent in FIFO mode only, and only with FCR.DMAMODE1,
/// which the guide requires. Receive: the trigger level is reached, or a time-out occurs. Transmit: the
/// last byte in the FIFO moves to the shift register, or UTRST releases a transmitter whose FIFO is
/// empty.
class Uart16550 : public WithRegs<UartRegs>, public ClockedTarget {
 public:
  SC_HAS_PROCESS(Uart16550);
  OptionalOut<bool> irq{"irq"};
  OptionalIn<bool> pins{"pins"};  ///< true while PINMUX assigns the transmit pin to this UART; may
                                  ///< stay unbound
  /// Called for each transmitted byte with the time of the end of its last stop bit. Set by the
  /// board.
  std::function<void(std::uint8_t, Picoseconds)> sink;

  /// @param selection the PINMUX setting that assigns the pin, for the warning
  explicit Uart16550(sc_core::sc_module_name name, const char* selection = "");
  /// A byte was received completely, at kernel time. If there is no room it is lost and OE is set.
  void receive(std::uint8_t byte);
  /// True if the receiver is enabled with a baud rate and has room for one more byte.
  bool can_receive() const;
  /// Duration in ps of a byte that begins now. May be called only while can_receive().
  Picoseconds character_time() const;
  /// Called whenever can_receive() may have become true. Set by the board; may be empty.
  std::function<void()> on_ready;
  /// The DMA events URXEVT and UTXEVT. Set by the chip; may be empty.
  std::function<void()> on_receive_event, on_transmit_event;
  std::uint64_t transmitted() const { return transmitted_; }

 private:
  static constexpr unsigned kFifoBytes = 16;
  static constexpr std::uint8_t kDmaMode = 8;  // FCR.DMAMODE1
  bool fifo_mode() const { return fcr_ & 1; }
  bool sends_events() const { return fifo_mode() && (fcr_ & kDmaMode); }
  unsigned trigger_level() const;
  unsigned capacity() const { return fifo_mode() ? kFifoBytes : 1; }
  std::uint32_t divisor() const { return (regs.dlh.get() & 0xFF) << 8 | (regs.dll.get() & 0xFF); }
  std::uint64_t character_ticks() const;
  void data_written(std::uint8_t byte);
  void read_data();
  void fcr_written(std::uint32_t word);
  void power_written();
  void refresh();
  std::uint32_t interrupt_id() const;
  void start_next(std::uint64_t first_tick);
  void clock_changed() override { refresh(); }
  void on_reset(ResetKind) override;
  void update();

  const char* selection_;
  std::deque<std::uint8_t> tx_, rx_;
  std::uint8_t shift_ = 0, ier_ = 0, fcr_ = 0, last_rx_ = 0;
  bool shifting_ = false, overrun_ = false, thre_event_ = true, rx_timeout_ = false;
  bool transmitter_on_ = false;  // UTRST so far
  std::uint64_t done_tick_ = kNever, timeout_tick_ = kNever;
  std::uint64_t transmitted_ = 0;
  Timer wake_;
};

}  // namespace fovea::periph
