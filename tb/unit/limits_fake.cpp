// A program with the command line of `fovea` over a toy board, whose figures are simple functions of its
// parameters. FAKE_LIMITS_LOG names a file that gets a line for each run.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <thread>

#include "model/cpu/core/stats.h"
#include "sw/fovea/cli/cli.h"
#include "tb/unit/fake_tools.h"

namespace fovea::test {
namespace {

using U = IntParam::Unit;

struct Toy : ParamGroup {
  IntParam value{*this, "value", U::kCount, 0, 0, 1000, "what is searched", Origin::kChoice, ""};
  IntParam limit{*this, "limit", U::kCount, 500, 0, 2000, "the largest value without a drop", Origin::kChoice, ""};
  IntParam floor{*this, "floor", U::kCount, 0, 0, 2000, "the smallest value without a drop", Origin::kChoice, ""};
  IntParam hole{*this, "hole", U::kCount, 2000, 0, 2000, "from here on all is good again", Origin::kChoice, ""};
  IntParam slipping{
      *this,           "slipping", U::kCount, 2000, 0, 2000, "from here on the loop slips once, in the window",
      Origin::kChoice, ""};
  IntParam slipped{
      *this, "slipped", U::kCount, 2000, 0, 2000, "from here on it has slipped before the window", Origin::kChoice, ""};
  IntParam losing{*this,           "losing", U::kCount, 2000, 0, 2000, "from here on every third frame is shown again",
                  Origin::kChoice, ""};
  IntParam clock{*this, "clock", U::kHertz, 100'000'000, 1'000'000, 1'000'000'000, "a clock", Origin::kChoice, ""};
  RealParam angle{*this, "angle", "deg", 0, 0, 90, "an angle", Origin::kChoice, ""};
  IntParam contention{*this, "contention", U::kCount, 0, 0, 100, "ms that others cost", Origin::kChoice, ""};
  EnumParam mode{*this, "mode", "good", {"good", "guest_failure", "user_error", "defect", "slow", "bare"},
                 "how it ends", Origin::kChoice, ""};
  TextParam file{*this, "file", "", "a file that is read"};
  Toy() : ParamGroup("toy") {}
};

struct Latency : ParamGroup {
  IntParam request{*this, "request_latency", U::kCycles,       3,      0,
                   32,    "there",           Origin::kAssumed, "none", {"2 cycles", "6 cycles", "a toy's belief"}};
  IntParam response{*this,      "response_latency",
                    U::kCycles, 3,
                    0,          32,
                    "back",     Origin::kAssumed,
                    "none",     {"2 cycles", "6 cycles", "a toy's belief"}};
  Latency() : ParamGroup("bus.arm_d") {}
};

struct Memory : ParamGroup {
  IntParam request{*this, "request_latency", U::kCycles,      8,         0,
                   32,    "there",           Origin::kFamily, "sisters", {"8 cycles", "32 cycles", "a toy's belief"}};
  IntParam response{*this, "return_latency", U::kCycles, 2, 0, 32, "back", Origin::kChoice, ""};
  Memory() : ParamGroup("ddr") {}
};

struct Priority : ParamGroup {
  EnumParam arm{*this, "arm", "reset", {"reset", "0", "7"}, "of the core", Origin::kChoice, ""};
  EnumParam idle{*this, "idle", "reset", {"reset", "0", "7"}, "of no master", Origin::kChoice, ""};
  Priority() : ParamGroup("priority") {}
};

struct Run : ParamGroup {
  IntParam frames{*this, "frames", U::kCount, 3, 1, 1000, "frames of the window", Origin::kChoice, ""};
  TextParam until{*this, "until", "frames", "when it ends"};
  IntParam start_limit{*this, "start_limit", U::kTime, 30 * kPsPerSecond, kPsPerMs, 3600 * kPsPerSecond, "limit",
                       Origin::kChoice, ""};
  Run() : ParamGroup("run") {}
};

struct Load : ParamGroup {
  EnumParam port{*this, "port", "load", {"load", "other"}, "port", Origin::kChoice, ""};
  IntParam outstanding{*this, "outstanding", U::kCount, 0, 0, 16, "bursts", Origin::kChoice, ""};
  IntParam bytes{*this, "bytes", U::kBytes, 64, 4, 64, "size", Origin::kChoice, ""};
  IntParam gap{*this, "gap", U::kTime, 0, 0, kPsPerMs, "pause", Origin::kChoice, ""};
  IntParam priority{*this, "priority", U::kCount, 7, 0, 7, "priority", Origin::kChoice, ""};
  EnumParam pattern{*this, "pattern", "sequential", {"sequential", "random"}, "addresses", Origin::kChoice, ""};
  EnumParam kind{*this, "kind", "read", {"read", "write", "mixed", "copy"}, "direction", Origin::kChoice, ""};
  IntParam start{*this, "start", U::kTime, 0, 0, kPsPerSecond, "begin", Origin::kChoice, ""};
  Load() : ParamGroup("load") {}
  /// MB/s; without pauses 700.
  double rate() const {
    if (outstanding() == 0) return 0;
    if (gap() == 0) return 700;
    return static_cast<double>(outstanding() * bytes()) / static_cast<double>(gap()) * 1e6;
  }
};

class ToyBoard : public app::Machine {
 public:
  void declare(ParamSet& params) override {
    for (ParamGroup* g : {static_cast<ParamGroup*>(&toy_), static_cast<ParamGroup*>(&bridge_),
                          static_cast<ParamGroup*>(&memory_), static_cast<ParamGroup*>(&priority_),
                          static_cast<ParamGroup*>(&load_), static_cast<ParamGroup*>(&run_)})
      params.add(*g);
  }

  app::Result run(const app::Request& request) override {
    if (const char* log = std::getenv("FAKE_LIMITS_LOG")) std::ofstream(log, std::ios::app) << toy_.value() << "\n";
    app::Tools tools;
    tools.make(request.tools, {.params = request.params});
    app::Result result;
    tools.finish(cpu::Counts{}, result, result.lost);
    if (toy_.mode.is("guest_failure")) throw GuestFailure("PC 0x0 in nowhere");
    if (toy_.mode.is("user_error")) throw UserError("footage 'x' is missing");
    if (toy_.mode.is("defect")) throw std::logic_error("broken");
    while (toy_.mode.is("slow") && toy_.value() > 0 && !request.stop)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const bool bad = (toy_.value() > toy_.limit() || toy_.value() < toy_.floor()) && toy_.value() < toy_.hole();
    const bool overloaded = load_.rate() > 340.001 + 10.0 * static_cast<double>(load_.priority());
    const bool slow_clock = toy_.clock() < 250'000'000 && toy_.value() == 7;
    const std::uint64_t drops = (bad ? 3 : 0) + overloaded + slow_clock + (toy_.angle() > 30.5);
    const double ms = 10 + static_cast<double>(bridge_.request() + bridge_.response()) +
                      0.01 * static_cast<double>(memory_.request() + memory_.response()) +
                      (priority_.arm.is("0") ? 0 : static_cast<double>(toy_.contention()));
    result.complete = !request.stop;
    if (toy_.mode.is("bare")) return result;
    const auto count = [&](const char* name, std::uint64_t n) { result.stats.push_back({name, n, "1", "a count"}); };
    const bool ends_at_once = run_.until() != "frames";
    const std::uint64_t repeated = toy_.value() >= toy_.losing()     ? run_.frames() / 3
                                   : toy_.value() >= toy_.slipped()  ? 0
                                   : toy_.value() >= toy_.slipping() ? 1
                                                                     : 0;
    const double shown = static_cast<double>(run_.frames());
    count("frame.displayed", run_.frames());
    count("frame.dropped", drops);
    count("frame.repeated", repeated);
    count("capture.overflows", 0);
    count("display.underflows", 0);
    count("camera.1.frame.dropped", toy_.value() == 13 ? 1 : 0);
    count("bus.arm_d.transactions", 9);
    count("bus.vpbe.transactions", 9);
    count("bus.load.read_bytes", static_cast<std::uint64_t>(load_.rate() * 1e6));
    count("bus.load.write_bytes", 0);
    result.stats.push_back({"frame.nothing", std::nan(""), "s", "a mean of nothing"});
    if (ends_at_once) return result;
    const bool late = toy_.value() >= std::min({toy_.slipping(), toy_.slipped(), toy_.losing()});
    result.stats.push_back({"frame.rate", 25.0 * (shown - static_cast<double>(repeated)) / shown, "1/s", "rate"});
    result.stats.push_back({"frame.latency.max", late ? 0.1189 : 0.0789, "s", "latency"});
    result.stats.push_back({"frame.window", 1.0, "s", "window"});
    result.stats.push_back({"startup.first_frame", 0.25, "s", "first frame"});
    result.stats.push_back({"frame.remap_time.mean", ms * 1e-3, "s", "time"});
    result.stats.push_back({"frame.remap_time.max", ms * 1e-3, "s", "time"});
    video::Frame frame;
    frame.picture = video::Picture(32, 16, 128);
    frame.times.capture_start = 123'456'789;  // ps
    for (app::FrameSink* sink : request.frames) sink->displayed(frame, {});
    return result;
  }

 private:
  Toy toy_;
  Latency bridge_;
  Memory memory_;
  Priority priority_;
  Load load_;
  Run run_;
};

}  // namespace
}  // namespace fovea::test


int main(int argc, char** argv) {
  using namespace fovea::app;
  CliContext context{.out = std::cout, .err = std::cerr, .make_machine = [](MachineKind) {
                       return std::make_unique<fovea::test::ToyBoard>();
                     },
                     .tools = fovea::test::fake_tools()};
  install_signals(context);
  return run_cli({argv + 1, argv + argc}, context);
}
