// EDMA3 transfer controllers at 0x01C10000, 0x400 each.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <systemc>

#include "model/common/burst_master.h"
#include "model/common/bus_target.h"
#include "model/common/clock.h"
#include "model/common/timed_counter.h"
#include "model/dma/core/transfer_controller.h"
#include "model/dma/edma_cc.h"
#include "model/dma/edma_params.h"

namespace fovea::dma {

/// Offsets and fields: SPRUH82C, "EDMA3 Transfer Controller Registers"; the place of TCSTAT.DFSTRTPTR: SPRUH73, as
/// SPRUH82C has it at 12:11; INTSTAT to INTCMD: TI's register header of the transfer controller (cslr_tptc.h).
struct EdmaTcRegs : RegBank {
  struct Config : Reg {
    using Reg::Reg;
    Field fifo{*this, "FIFOSIZE", 0, 3, Mode::kRo, "data FIFO: 32 << n bytes"};
    Field width{*this, "BUSWIDTH", 4, 2, Mode::kRo, "buses: 4 << n bytes"};
    Field depth{*this, "DREGDEPTH", 8, 2, Mode::kRo, "destination registers: 1 << n"};
  };
  struct Status : Reg {
    using Reg::Reg;
    Field program{*this, "PROGBUSY", 0, 1, Mode::kRo, "the program register is taken"};
    Field source{*this, "SRCACTV", 1, 1, Mode::kRo, "reads are being issued"};
    Field writes{*this, "WSACTV", 2, 1, Mode::kRo, "an acknowledgement of a write is outstanding"};
    Field destinations{*this, "DSTACTV", 4, 3, Mode::kRo, "destination registers in use"};
    Field head{*this, "DFSTRTPTR", 12, 2, Mode::kRo, "destination register of the oldest request"};
  };
  struct Interrupts : Reg {
    using Reg::Reg;
    Field program{*this, "PROGEMPTY", 0, 1, Mode::kRo, "the program register has become empty"};
    Field done{*this, "TRDONE", 1, 1, Mode::kRo, "the last write of a request was acknowledged"};
  };
  struct InterruptEnables : Reg {
    using Reg::Reg;
    Field program{*this, "PROGEMPTY", 0, 1, Mode::kRw, "interrupt on PROGEMPTY, not connected"};
    Field done{*this, "TRDONE", 1, 1, Mode::kRw, "interrupt on TRDONE, not connected"};
  };
  struct InterruptClear : Reg {
    using Reg::Reg;
    Field program{*this, "PROGEMPTY", 0, 1, Mode::kWo, "clears PROGEMPTY"};
    Field done{*this, "TRDONE", 1, 1, Mode::kWo, "clears TRDONE"};
  };
  struct InterruptCommand : Reg {
    using Reg::Reg;
    Field eval{*this, "EVAL", 0, 1, Mode::kWo, "pulses the interrupt if an enabled one is pending"};
    Field set{*this, "SET", 1, 1, Mode::kWo, "pulses the interrupt"};
  };
  struct Errors : Reg {
    using Reg::Reg;
    Field bus{*this, "BUSERR", 0, 1, Mode::kRo, "a read or a write was not answered"};
    Field request{*this, "TRERR", 2, 1, Mode::kRo, "a request breaks the rules of constant addressing"};
    Field address{*this, "MMRAERR", 3, 1, Mode::kRo, "access to a register that does not exist"};
  };
  struct ErrorEnables : Reg {
    using Reg::Reg;
    Field bus{*this, "BUSERR", 0, 1, Mode::kRw, "interrupt on BUSERR"};
    Field request{*this, "TRERR", 2, 1, Mode::kRw, "interrupt on TRERR"};
    Field address{*this, "MMRAERR", 3, 1, Mode::kRw, "interrupt on MMRAERR"};
  };
  struct ErrorClear : Reg {
    using Reg::Reg;
    Field bus{*this, "BUSERR", 0, 1, Mode::kWo, "clears BUSERR and ERRDET"};
    Field request{*this, "TRERR", 2, 1, Mode::kWo, "clears TRERR"};
    Field address{*this, "MMRAERR", 3, 1, Mode::kWo, "clears MMRAERR"};
  };
  struct ErrorDetails : Reg {
    using Reg::Reg;
    Field status{*this, "STAT", 0, 4, Mode::kRo, "1: a read's address, 9: a write's"};
    Field tcc{*this, "TCC", 8, 6, Mode::kRo, "completion code of the request"};
    Field interrupt{*this, "TCINTEN", 16, 1, Mode::kRo, "the request reports by interrupt"};
    Field chain{*this, "TCCHEN", 17, 1, Mode::kRo, "the request reports by chaining"};
  };
  struct ErrorCommand : Reg {
    using Reg::Reg;
    Field eval{*this, "EVAL", 0, 1, Mode::kWo, "pulses the interrupt if an enabled error is pending"};
  };
  struct ReadRate : Reg {
    using Reg::Reg;
    Field rate{*this, "RDRATE", 0, 3, Mode::kRw, "clocks between reads: 0, 4, 8, 16 or 32"};
  };
  /// A register set: the request in it, and what is left of it.
  struct Set {
    Reg opt, src, cnt, dst, bidx, mpprxy;
    /// @param prefix "P", "SA" or "DF"; `suffix` the number of a destination register
    Set(RegBank& bank, const std::string& prefix, std::uint32_t offset, const std::string& of,
        const std::string& suffix = "");
  };
  static constexpr unsigned kDestinations = 4;

  Config tccfg;
  Status tcstat{*this, "TCSTAT", 0x100, "status"};
  Interrupts intstat{*this, "INTSTAT", 0x104, "what has happened"};
  InterruptEnables inten{*this, "INTEN", 0x108, "enabled interrupts"};
  InterruptClear intclr{*this, "INTCLR", 0x10C, "clears INTSTAT"};
  InterruptCommand intcmd{*this, "INTCMD", 0x110, "interrupt"};
  Errors errstat{*this, "ERRSTAT", 0x120, "errors"};
  ErrorEnables erren{*this, "ERREN", 0x124, "enabled errors"};
  ErrorClear errclr{*this, "ERRCLR", 0x128, "clears errors"};
  ErrorDetails errdet{*this, "ERRDET", 0x12C, "details of BUSERR"};
  ErrorCommand errcmd{*this, "ERRCMD", 0x130, "error interrupt"};
  ReadRate rdrate{*this, "RDRATE", 0x140, "pace of reads"};
  Set program{*this, "P", 0x200, "program register"};
  Set source{*this, "SA", 0x240, "source active"};
  Reg sacntrld{*this, "SACNTRLD", 0x258, Mode::kRo, "source active: ACNT as programmed"};
  Reg sasrcbref{*this, "SASRCBREF", 0x25C, Mode::kRo, "source active: start of the array being read"};
  Reg sadstbref{*this, "SADSTBREF", 0x260, Mode::kRo, "0: not applicable"};
  Reg dfcntrld{*this, "DFCNTRLD", 0x280, Mode::kRo, "destination being written: ACNT as programmed"};
  Reg dfsrcbref{*this, "DFSRCBREF", 0x284, Mode::kRo, "0: not applicable"};
  Reg dfdstbref{*this, "DFDSTBREF", 0x288, Mode::kRo, "start of the array being written"};
  std::deque<Set> destination;  ///< DFOPT0 to DFMPPRXY3, at a pitch of 0x40
  EdmaTcRegs(unsigned number, unsigned fifo, unsigned depth);
};

struct EdmaTcStats : StatGroup {
  const std::string who;
  TimedCounter requests{*this, "requests", "1", "transfer requests that " + who + " completed"};
  TimedCounter reads{*this, "reads", "1", "bursts that " + who + " read"};
  TimedCounter writes{*this, "writes", "1", "bursts that " + who + " wrote"};
  TimedCounter bytes{*this, "bytes", "B", "bytes that " + who + " transferred"};
  Counter errors{*this, "errors", "1", "bus errors of " + who + ", and requests against the rules"};
  Formula busy{*this, "busy_time", "s", "time in which " + who + " had a request",
               [this] { return static_cast<double>(busy_until(kernel_time())) * 1e-12; }};
  /// Both of the transfer controller, at a time: how long it was busy, and to count anew.
  std::function<Picoseconds(Picoseconds)> busy_until = [](Picoseconds) { return Picoseconds{0}; };
  std::function<void(Picoseconds)> start_count = [](Picoseconds) {};
  explicit EdmaTcStats(unsigned number)
      : StatGroup("edma.tc" + std::to_string(number)), who("TC" + std::to_string(number)) {}

 private:
  void on_reset() override { start_count(kernel_time()); }
};

/// A transfer controller: two masters, one that only reads and one that only writes. While its clock is
/// gated it computes nothing new; bursts whose time was known already still go out.
///
/// Outcomes of bursts are reported to it as soon as they are decided, and it issues what follows from them
/// ahead. The kernel has an event only for what others see: a completion code, the freeing of a program
/// register that is waited for, a bus error.
class EdmaTc : public WithRegs<EdmaTcRegs>,
               public BusTarget,
               public TransferPort, private TransferController::Host {
 public:
  using Params = EdmaTcParams;
  SC_HAS_PROCESS(EdmaTc);
  EdmaTcStats stats;
  /// For observers: a request enters the program register; it ended (last write acknowledged, or refused).
  std::function<void(const TransferRequest&, Picoseconds at)> on_request, on_ended;
  ClockIn clk{"clk"};
  sc_core::sc_in<bool> lpsc{"lpsc"};
  Pulse error{"error", kInterruptPulse};  ///< TCERRINT
  /// MISC of the system module: TPTC1_BST; used by number 1 only.
  sc_core::sc_in<std::uint32_t> misc{"misc"};

  EdmaTc(sc_core::sc_module_name name, unsigned number, const EdmaTcParams& params);
  void attach(EdmaCc& channels);

  Picoseconds program_free() const override;
  bool has_clock() const override { return clock_.running() && lpsc.read(); }
  unsigned burst() const override;
  void submit(const TransferRequest& request) override;
  bool idle() const override { return reads_.idle() && writes_.idle(); }
  /// It has no request.
  bool at_rest() const { return idle() && core_.idle(); }
  /// From now on each outcome is reported at its time, and a burst issued when what it follows from has
  /// happened: for a load on one of the ports, whose bursts queue behind those that are issued already,
  /// and for a bus trace, which notes what has ended before. Before the first burst.
  void report_in_kernel_time();
  void leave_reset() override;

 protected:
  bool clocked() const override { return lpsc.read(); }
  void on_reset(ResetKind kind) override;
  bool hole_accessed(std::uint32_t offset) override;

 private:
  Picoseconds edge(Picoseconds t, unsigned clocks) const override;
  Picoseconds read_free() const override;
  Picoseconds write_free() const override;
  void read(Command burst, Picoseconds at) override;
  void write(Command burst, std::span<const std::uint8_t> data, Picoseconds at) override;
  void program_free(Picoseconds at) override;
  void completed(const TransferRequest& request, Picoseconds at) override;
  void failed(const TransferRequest& request, TransferController::Failure failure,
              Picoseconds at) override;
  void set_error(Field& which);
  void report_bus_error(const TransferRequest& request, bool read);
  void at_its_time(Picoseconds at, std::function<void()> f);
  void act();
  void clock_changed();
  void show_status();
  void show_interrupts();
  void show_errors();
  void show_sets();
  void show(EdmaTcRegs::Set& regs, std::function<RegisterSet()> set);
  bool running() const { return has_clock() && !in_reset_; }

  const unsigned number_;
  const EdmaTcParams& params_;
  Clock clock_;
  BurstMaster reads_, writes_;
  TransferController core_;
  EdmaCc* channels_ = nullptr;
  Picoseconds program_free_ = 0;
  bool in_kernel_time_ = false;                           // outcomes are reported at their times
  std::multimap<Picoseconds, std::function<void()>> due_;  // of few requests: errors, observers
  Timer due_timer_;
  bool in_reset_ = false;
  // Requests that had left the program register, and that had ended, when INTSTAT was cleared.
  std::uint64_t loads_cleared_ = 0, ends_cleared_ = 0;
};

}  // namespace fovea::dma
