// A stand-in for the board: shows grey frames, obeys the stop flag, fails on request.
#pragma once
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "sw/fovea/simulation.h"

namespace fovea::test {

class FakeBoard : public app::Simulation {
 public:
  void declare(ParamSet& params) override { params.add(params_); }

  app::RunResult run(const app::RunRequest& request) override {
    if (params_.mode.is("guest_failure")) throw GuestFailure("PC 0x0 in nowhere");
    if (params_.mode.is("defect")) throw std::logic_error("broken");
    if (params_.mode.is("broken_check")) FOVEA_CHECK(false, "planted");
    if (params_.mode.is("user_error")) throw UserError("footage 'x' is missing");
    if (params_.mode.is("not_modelled")) Diagnostics::instance().not_modelled("field X of Y");
    app::RunResult result;
    std::vector<std::uint8_t> uyvy(32 * 16 * 2, 128);
    for (std::uint64_t i = 0; i < params_.frames(); ++i) {
      if (request.stop) {
        result.complete = false;
        break;
      }
      if (request.frame) request.frame({i, 32, 16, uyvy});
      app::FrameRow row;
      row.index = i;
      row.display_start = i * 40 * kPsPerMs;
      result.frames.push_back(row);
      request.progress.update({(i + 1) * 40 * kPsPerMs, i + 1, params_.frames(), 1000 * i});
      if (params_.mode.is("slow")) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (params_.mode.is("late_failure")) result.guest_failure = "watchdog\nlast access: 0x0";
    result.stats.push_back({"frame.displayed", std::uint64_t{result.frames.size()}, "count", "n"});
    result.stats.push_back(
        {"sync.strict", std::uint64_t{request.strict_sync ? 1u : 0u}, "count", "asked for"});
    result.timeline_masters = {"arm_d"};
    result.timeline = {{0, kPsPerMs, {64}, {0}}};
    result.stalls = {{"dcache", "lut", "vpbe", 7}};
    result.uart = "hello from the guest\n";
    return result;
  }

 private:
  struct Params : ParamGroup {
    Params() : ParamGroup("run") {}
    IntParam frames{*this,   "frames",         IntParam::Unit::kCount, 3, 1,
                    100'000, "frames to show", Origin::kChoice,        ""};
    ListParam list{*this, "list", {0, 0}, {2}, "two numbers", Origin::kChoice, ""};
    EnumParam mode{
        *this,
        "mode",
        "good",
        {"good", "slow", "guest_failure", "late_failure", "defect", "broken_check", "user_error",
         "not_modelled"},
        "how it ends | or not",
        Origin::kAssumed,
        "",
        {"good", "slow", "a fake"}};
  } params_;
};

}  // namespace fovea::test
