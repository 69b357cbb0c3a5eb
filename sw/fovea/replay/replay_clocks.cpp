#include "sw/fovea/replay/replay_clocks.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "model/board/clock_presets.h"

namespace fovea::app {
namespace {

bool from_command_line(const Experiment& experiment, const ParamBase& param) {
  return experiment.origin(param.key()).kind == ValueOrigin::Kind::kCommandLine;
}

std::string megahertz(double hertz) { return fmt::format("{:.6g} MHz", hertz * 1e-6); }

}  // namespace

void apply_clock_preset(const ReplayParams& params, Experiment& experiment) {
  const EnumParam& chosen = params.chip_clocks.preset;
  if (chosen.is("as_recorded") || from_command_line(experiment, params.registers.clock))
    return;
  const board::ClockPreset& preset = board::clock_preset(chosen());
  experiment.preset(params.registers.clock.key(),
                    fmt::format("{}Hz", std::llround(preset.ddr().hertz())),
                    fmt::format("clocks.preset: {}", preset.name));
}

std::vector<std::string> follow_clocks(const ReplayParams& params, const trace::TraceInfo& recorded,
                                       Experiment& experiment) {
  std::vector<std::string> lines;
  const IntParam& ddr = params.registers.clock;
  const IntParam& bus = params.clocks.clock;
  // Both keys are in whole hertz.
  const auto differ = [](double a, double b) { return std::abs(a - b) > 1.0; };
  // A text trace has no clocks of its own, but the defaults.
  const double before = recorded.ddr.frequency.stopped()
                            ? static_cast<double>(DdrRegisterParams().clock())
                            : recorded.ddr.frequency.hertz();
  const double half = static_cast<double>(ddr()) / 2;
  if (differ(static_cast<double>(ddr()), before) && !from_command_line(experiment, bus)) {
    const auto was = static_cast<double>(bus());
    experiment.preset(bus.key(), fmt::format("{}Hz", std::llround(half)), "half of ddr.clock");
    if (differ(was, half))
      lines.push_back(fmt::format("bus.clock follows ddr.clock as on the chip: {}, it was {}; set it "
                                  "to keep it",
                                  megahertz(half), megahertz(was)));
  } else if (differ(static_cast<double>(bus()), half)) {
    lines.push_back(fmt::format("warning: bus.clock is {}; the chip's crossbar runs at half of "
                                "ddr.clock, {}",
                                megahertz(static_cast<double>(bus())), megahertz(half)));
  }
  if (params.chip_clocks.preset.is("as_recorded") || recorded.streams.empty()) return lines;
  // The core is the first stream of a recorded trace; others count picoseconds.
  const double core = recorded.streams.front().clock.hertz();
  const double wanted = board::clock_preset(params.chip_clocks.preset()).core().hertz();
  if (!recorded.scr.frequency.stopped() && differ(core, wanted))
    lines.push_back(fmt::format("warning: clocks.preset: the core stays at {} as recorded, {} is not "
                                "played",
                                megahertz(core), megahertz(wanted)));
  return lines;
}

}  // namespace fovea::app
