// An example peripheral: rings every so many ticks of its clock.
#pragma once
#include "model/common/param.h"
#include "model/common/stats.h"
#include "model/periph/clocked_target.h"

namespace fovea::examples {

struct AlarmParams : ParamGroup {
  IntParam reset_period{*this, "reset_period", IntParam::Unit::kCount, 24'000, 1, 1'000'000,
                        "PERIOD out of reset, in ticks", Origin::kChoice, ""};
  AlarmParams() : ParamGroup("alarm") {}
};

struct AlarmStats : StatGroup {
  Counter rings{*this, "rings", "1", "alarms that rang"};
  AlarmStats() : StatGroup("alarm") {}
};

struct AlarmRegs : RegBank {
  struct Control : Reg {
    using Reg::Reg;
    Field run{*this, "RUN", 0, 1, Mode::kRw, "1: rings every PERIOD ticks from now"};
  } control{*this, "CONTROL", 0x00, "control"};
  Reg period;
  Reg count{*this, "COUNT", 0x08, Mode::kRo, "alarms since RUN was set"};
  explicit AlarmRegs(std::uint32_t reset_period)
      : RegBank("ALARM"),
        period(*this, "PERIOD", 0x04, Mode::kRw, "ticks from one alarm to the next", reset_period) {}
};

/// Each alarm raises the interrupt line for one tick.
class Alarm : public WithRegs<AlarmRegs>, public periph::ClockedTarget {
 public:
  using Params = AlarmParams;
  periph::OptionalOut<bool> irq{"irq"};
  AlarmStats stats;

  SC_HAS_PROCESS(Alarm);
  Alarm(sc_core::sc_module_name name, const AlarmParams& params);

 private:
  void clock_changed() override { wake_.soon(); }
  void on_reset(ResetKind) override { start_or_stop(); }
  void start_or_stop();
  void update();

  std::uint64_t due_ = kNever, off_ = kNever;  // ticks: the next alarm, the end of its pulse
  Timer wake_;
};

}  // namespace fovea::examples
