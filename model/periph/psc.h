// PSC (power and sleep controller): the clock gates of the modules.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <systemc>

#include "model/common/bus_target.h"
#include "model/common/param.h"
#include "model/common/timer.h"
#include "model/periph/clocked_target.h"

namespace fovea::periph {

inline constexpr unsigned kLpscCount = 52;

/// Numbers of the local PSCs of the blocks in this chip model (TI boot loader, Linux psc-dm365.c).
enum Lpsc : unsigned {
  kLpscTpcc = 0,
  kLpscTptc0 = 1,
  kLpscTptc1 = 2,
  kLpscTptc2 = 3,
  kLpscTptc3 = 4,
  kLpscTimer3 = 5,
  kLpscDdr = 13,
  kLpscAemif = 14,
  kLpscTimer4 = 17,
  kLpscI2c = 18,
  kLpscUart0 = 19,
  kLpscUart1 = 20,
  kLpscGpio = 26,
  kLpscTimer0 = 27,
  kLpscTimer1 = 28,
  kLpscTimer2 = 29,
  kLpscSystem = 30,
  kLpscArm = 31,
  kLpscDacClk = 46,
  kLpscVpss = 47
};

struct PscParams : ParamGroup {
  IntParam transition_time{
      *this,
      "transition_time",
      IntParam::Unit::kTime,
      kPsPerUs,
      10 * kPsPerNs,
      100 * kPsPerUs,
      "from PTCMD to the new module states",
      Origin::kAssumed,
      "no figure published; software polls PTSTAT",
      {"100ns", "10us", "some clocks of the slowest clock, 24 MHz, to hundreds"}};
  PscParams() : ParamGroup("psc") {}
};

struct PscRegs : RegBank {
  Reg pid{*this, "PID", 0x000, Mode::kRo, "peripheral identification (value not public)"};
  Reg inteval{*this, "INTEVAL", 0x018, Mode::kRw, "interrupt evaluation; kept, no effect"};
  Reg merrpr0{*this, "MERRPR0", 0x040, Mode::kRo, "module errors; none occur"};
  Reg merrpr1{*this, "MERRPR1", 0x044, Mode::kRo, "module errors; none occur"};
  Reg merrcr0{*this, "MERRCR0", 0x050, Mode::kWo, "clears module errors"};
  Reg merrcr1{*this, "MERRCR1", 0x054, Mode::kWo, "clears module errors"};
  Reg perrpr{*this, "PERRPR", 0x060, Mode::kRo, "power domain errors; none occur"};
  Reg perrcr{*this, "PERRCR", 0x068, Mode::kWo, "clears power domain errors"};
  Reg epcpr{*this, "EPCPR", 0x070, Mode::kRo, "external power control pending; never"};
  Reg epccr{*this, "EPCCR", 0x078, Mode::kWo, "clears EPCPR"};
  Reg ptcmd{*this, "PTCMD", 0x120, Mode::kRw, "bit 0: start the transitions of domain 0; reads 0"};
  Reg ptstat{*this, "PTSTAT", 0x128, Mode::kRo, "bit 0: domain 0 is in transition"};
  Reg pdstat0{*this, "PDSTAT0", 0x200, Mode::kRo, "power domain 0 is on", 0x301};
  Reg pdstat1{*this, "PDSTAT1", 0x204, Mode::kRo, "power domain 1"};
  Reg pdctl0{*this, "PDCTL0", 0x300, Mode::kRw, "power domain 0 control; kept", 0x1};
  Reg pdctl1{*this, "PDCTL1", 0x304, Mode::kRw, "power domain 1 control; kept"};
  std::deque<Reg> mdstat, mdctl;
  PscRegs();
};

/// PSC at 0x01C41000. Software writes MDCTL.NEXT (bits 4:0) and then PTCMD; after transition_time,
/// PTSTAT is cleared and MDSTAT.STATE equals NEXT. States: 0 software reset, 1 synchronous reset, 2
/// disabled, 3 enabled. After reset, the ARM (31), the system module (30) and the modules that the
/// boot ROM needs (AEMIF, UART0, TIMER0 to TIMER2) are enabled, and all others are in state 0;
/// which modules the ROM leaves enabled is assumed. Not modelled: power domains other than 0,
/// errors, emulation.
class Psc : public WithRegs<PscRegs>, public BusTarget {
 public:
  using Params = PscParams;
  SC_HAS_PROCESS(Psc);
  /// enabled[n]: LPSC n is in state 3
  sc_core::sc_vector<OptionalOut<bool>> enabled{"enabled", kLpscCount};

  Psc(sc_core::sc_module_name name, const PscParams& params);

 private:
  void on_reset(ResetKind) override;
  void command(std::uint32_t domains);
  void update();

  Picoseconds transition_time_;
  std::array<std::uint8_t, kLpscCount> goal_{};
  bool again_ = false;
  Picoseconds done_at_ = kNever;
  Timer wake_;
};

}  // namespace fovea::periph
