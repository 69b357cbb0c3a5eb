// A fake board: displays grey frames, obeys the stop flag, fails on request.
#pragma once
#include <chrono>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "model/cpu/core/stats.h"
#include "sw/fovea/files/ffmpeg.h"
#include "sw/fovea/machine/machine.h"
#include "tb/unit/fake_tools.h"

namespace fovea::test {

class FakeBoard : public app::Machine {
 public:
  void declare(ParamSet& params) override { params.add(params_); }

  app::Result run(const app::Request& request) override {
    if (params_.mode.is("guest_failure")) throw GuestFailure("PC 0x0 in nowhere");
    if (params_.mode.is("defect")) throw std::logic_error("broken");
    if (params_.mode.is("broken_check")) FOVEA_CHECK(false, "planted");
    app::Tools tools;
    tools.make(request.tools, {.params = request.params});
    // derived from bad_alloc
    if (params_.mode.is("out_of_memory")) throw std::bad_array_new_length();
    if (params_.mode.is("no_thread"))
      throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
    if (params_.mode.is("out_of_memory_in_kernel"))
      throw std::runtime_error("Error: (E549) uncaught exception: std::bad_alloc\nIn process: p");
    if (params_.mode.is("not_modelled_in_kernel"))
      throw std::runtime_error(
          "Error: (E549) uncaught exception: not modelled: field X of Y\nIn file: f\nIn process: "
          "p");
    if (params_.mode.is("stopped_decoding")) throw app::Stopped();
    if (params_.mode.is("user_error")) throw UserError("footage 'x' is missing");
    if (params_.mode.is("not_modelled")) DiagnosticsRef::current().not_modelled("field X of Y");
    app::Result result;
    tools.finish(cpu::Counts{}, result, result.lost);
    std::uint64_t shown = 0;
    video::Frame frame;
    frame.picture = video::Picture(32, 16, 128);
    for (std::uint64_t i = 0; i < params_.frames(); ++i) {
      if (request.stop) {
        result.complete = false;
        break;
      }
      frame.times.index = i;
      frame.times.display_start = i * 40 * kPsPerMs;
      for (app::FrameSink* sink : request.frames) sink->displayed(frame, {});
      for (app::FrameSink* sink : request.frames)
        if (sink->wants_sent() && i > 0) sink->sent(i, frame.picture, {});
      ++shown;
      request.progress.update({(i + 1) * 40 * kPsPerMs, i + 1, params_.frames(), 1000 * i});
      if (params_.mode.is("slow")) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (params_.mode.is("escape")) throw GuestFailure("at \x1b[31mmain\nsecond line");
    if (params_.mode.is("late_failure")) result.guest_failure = "watchdog\nlast access: 0x0";
    result.stats.push_back({"frame.displayed", shown, "count", "n"});
    result.stats.push_back(
        {"sync.strict", std::uint64_t{request.strict_sync ? 1u : 0u}, "count", "asked for"});
    result.timeline_masters = {"arm_d"};
    if (request.timeline_row) request.timeline_row(result.timeline_masters, {0, kPsPerMs, {32}, {8}});
    result.timeline = {{kPsPerMs, 2 * kPsPerMs, {64}, {0}}};
    result.stalls = {{"dcache", "lut", "vpbe", 7}};
    result.latency = {{"arm_d", "read", "first", 1000, 2000, 3}};
    if (params_.mode.is("lost_output")) app::side_output("the toy", result.lost, [] { throw std::bad_alloc(); });
    result.uart = "hello from the guest\n";
    return result;
  }

 private:
  struct Params : ParamGroup {
    Params() : ParamGroup("run") {}
    IntParam frames{*this,   "frames",         IntParam::Unit::kCount, 3, 1,
                    100'000, "frames to show", Origin::kChoice,        ""};
    TextParam file{*this, "file", "", "a file that is read"};
    ListParam list{*this, "list", {0, 0}, {2}, "two numbers", Origin::kChoice, ""};
    EnumParam mode{*this,
                   "mode",
                   "good",
                   {"good", "slow", "guest_failure", "late_failure", "defect", "broken_check",
                    "user_error", "not_modelled", "out_of_memory", "out_of_memory_in_kernel",
                    "no_thread", "not_modelled_in_kernel", "stopped_decoding", "escape", "lost_output"},
                   "how it ends | or not",
                   Origin::kAssumed,
                   "",
                   {"good", "slow", "a fake"}};
  } params_;
};

}  // namespace fovea::test
