// PLL controller with the dividers of its SYSCLKs.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <systemc>

#include "model/common/bus_target.h"
#include "model/common/param.h"
#include "model/common/sc_ports.h"
#include "model/common/timer.h"
#include "model/periph/clocked_target.h"
#include "model/periph/core/pll_rules.h"

namespace fovea::periph {

struct PllParams : ParamGroup {
  IntParam lock_time{
      *this,
      "lock_time",
      IntParam::Unit::kTime,
      100 * kPsPerUs,
      kPsPerUs,
      10 * kPsPerMs,
      "from the last change of multiplier, pre-divider or reset to lock",
      Origin::kAssumed,
      "no DM365 figure; OMAP-L138's rule, 2000 N / sqrt(M) clocks, gives 20 to 70 us",
      {"20us", "200us", "the rule's least, and twice the default; only start-up"}};
  IntParam go_time{*this,
                   "go_time",
                   IntParam::Unit::kTime,
                   500 * kPsPerNs,
                   10 * kPsPerNs,
                   100 * kPsPerUs,
                   "from GOSET to the new SYSCLK ratios",
                   Origin::kAssumed,
                   "no DM365 figure; software polls GOSTAT or waits some microseconds",
                   {"100ns", "10us", "a few clocks of 24 MHz to what boot loaders wait"}};
  IntParam reset_type{*this,
                      "reset_type",
                      IntParam::Unit::kCount,
                      1,
                      0,
                      15,
                      "RSTYPE at the start of a run: 1 power-on, 2 warm, 4 watchdog",
                      Origin::kChoice,
                      "boot loaders reset the chip once when they see 1 or 2"};
  PllParams() : ParamGroup("pll") {}
};

/// Registers: TI boot loader for DM36x (device.h), Linux drivers/clk/davinci/pll.c. The reset
/// values are not public; assumed: bypass, PLL in reset, all dividers enabled with ratio 1.
struct PllRegs : RegBank {
  explicit PllRegs(const char* name, unsigned sysclks, std::uint32_t reset_type);
  Reg pid{*this, "PID", 0x000, Mode::kRo, "peripheral identification (value not public)"};
  Reg rstype;
  struct Pllctl : Reg {
    using Reg::Reg;
    Field pllen{*this, "PLLEN", 0, 1, Mode::kRw, "1: PLL, 0: bypass (needs PLLENSRC = 0)"};
    Field pllpwrdn{*this, "PLLPWRDN", 1, 1, Mode::kRw, "1: PLL is off"};
    Field pllrst{*this, "PLLRST", 3, 1, Mode::kRw, "1: PLL in reset"};
    Field plldis{*this, "PLLDIS", 4, 1, Mode::kRw, "kept, no effect"};
    Field pllensrc{*this, "PLLENSRC", 5, 1, Mode::kRw, "0: PLLEN decides"};
    Field clkmode{*this, "CLKMODE", 8, 1, Mode::kRw, "clock source; one source on this board"};
  } pllctl{*this, "PLLCTL", 0x100, "control", 0x68};
  Reg ocsel{*this, "OCSEL", 0x104, Mode::kRw, "observation clock; kept, no effect"};
  Reg secctl{*this, "SECCTL", 0x108, Mode::kRw, "initialisation sequence of the oscillator"};
  Reg pllm{*this, "PLLM", 0x110, Mode::kRw, "multiplier / 2, bits 9:0"};
  Reg prediv{*this, "PREDIV", 0x114, Mode::kRw, "pre-divider", 0x8000};
  Reg oscdiv1{*this, "OSCDIV1", 0x124, Mode::kRw, "observation divider; kept, no effect", 0x8000};
  Reg postdiv{*this, "POSTDIV", 0x128, Mode::kRw, "post-divider", 0x8000};
  Reg bpdiv{*this, "BPDIV", 0x12C, Mode::kRw, "bypass divider of SYSCLKBP; kept, no effect",
            0x8000};
  Reg pllcmd{*this, "PLLCMD", 0x138, Mode::kRw, "bit 0 GOSET: take the new ratios"};
  struct Pllstat : Reg {
    using Reg::Reg;
    Field gostat{*this, "GOSTAT", 0, 1, Mode::kRo, "1: taking new ratios"};
    Field lock{*this, "LOCK", 1, 1, Mode::kRo, "PLL has locked"};
    Field stable{*this, "STABLE", 2, 1, Mode::kRo, "oscillator is stable"};
  } pllstat{*this, "PLLSTAT", 0x13C, "status", 0x4};
  Reg alnctl{*this, "ALNCTL", 0x140, Mode::kRw, "alignment; all SYSCLKs change together", 0x1FF};
  Reg dchange{*this, "DCHANGE", 0x144, Mode::kRo, "ratios written but not yet taken"};
  Reg cken{*this, "CKEN", 0x148, Mode::kRw, "bit 0 AUXCLK, bit 1 OBSCLK; kept", 0x3};
  Reg ckstat{*this, "CKSTAT", 0x14C, Mode::kRo, "bit 0 AUXCLK, bit 1 OBSCLK are on", 0x3};
  Reg systat;
  std::deque<Reg> plldiv;
};

/// PLLC1 at 0x01C40800 (9 SYSCLKs) or PLLC2 at 0x01C40C00 (5 SYSCLKs).
///
/// SYSCLKn = f / (PLLDIVn + 1), where f is the oscillator in bypass, and otherwise oscillator x 2
/// PLLM / (PREDIV + 1) / (POSTDIV + 1). New ratios take effect go_time after GOSET. All SYSCLKs
/// change in the same instant.
///
/// The PLL locks lock_time after the last change of PLLM, PREDIV or SECCTL, or after the release of
/// PLLRST or PLLPWRDN. Writing the value that a register already has changes nothing: Linux' clock
/// framework writes PREDIV back while it runs from the PLL. A PLL that loses its lock while PLLEN =
/// 1 is not bypassed. It keeps its frequency until it locks again (assumed; the chip's drifts),
/// with a warning. If PLLEN is set before the first lock since a reset, the output stays in bypass
/// until the lock (assumed), also with a warning. A reset of the chip returns it to bypass and leaves
/// its kind in RSTYPE.
class PllController : public WithRegs<PllRegs>, public BusTarget {
 public:
  using Params = PllParams;
  SC_HAS_PROCESS(PllController);
  ClockIn osc{"osc"};
  sc_core::sc_vector<OptionalOut<Frequency>> sysclk;  ///< sysclk[0] is SYSCLK1
  OptionalOut<bool> locked{"locked"};                 ///< for PLLn_CONFIG of the system module

  /// @param sysclks number of SYSCLKs, 9 or 5
  PllController(sc_core::sc_module_name name, const char* bank, unsigned sysclks,
                const PllParams& params);

 private:
  void on_reset(ResetKind kind) override;
  void control_written();
  void relock();
  void update();
  Frequency source() const;

  Picoseconds lock_time_, go_time_;
  std::array<std::uint32_t, kMaxSysclks> ratio_;  // PLLDIVn that are in effect
  bool locked_ = false, pll_on_ = false;
  std::uint32_t pllm_ = 0, prediv_ = 0;  // values of the last lock; pllm_ 0: no lock since reset
  Picoseconds lock_at_ = kNever, go_at_ = kNever;
  /// A register whose change makes the PLL lock again.
  struct LockingRegister {
    Reg* reg;
    std::uint32_t last = 0;
  };
  std::array<LockingRegister, 3> locking_{{{&regs.pllm}, {&regs.prediv}, {&regs.secctl}}};
  Timer wake_;
};

}  // namespace fovea::periph
