// Parameters of the switched central resource and of the bridges into it.
#pragma once
#include <array>
#include <memory>
#include <string>

#include "model/common/masters.h"
#include "model/common/param.h"

namespace fovea::bus {

struct MasterPortParams : ParamGroup {
  using U = IntParam::Unit;
  IntParam request_latency;
  IntParam response_latency;
  explicit MasterPortParams(Master m)
      : ParamGroup("bus." + std::string(kMasterNames[index(m)])),
        request_latency(*this, "request_latency", U::kCycles, is_arm(m) ? 3 : 2, 0, 16,
                        "crossbar clocks (SYSCLK4) through the bridge before arbitration",
                        Origin::kAssumed, "no public figure; dm365.md 12 #6: 2 to 4 per hop"),
        response_latency(*this, "response_latency", U::kCycles, is_arm(m) ? 3 : 2, 0, 16,
                         "crossbar clocks from the crossbar back to the master's port",
                         Origin::kAssumed, "no public figure; dm365.md 12 #6: 2 to 4 per hop") {}
  static bool is_arm(Master m) { return m == Master::kArmI || m == Master::kArmD; }
};

struct CrossbarParams : ParamGroup {
  using U = IntParam::Unit;
  IntParam timeline_interval{*this, "timeline_interval", U::kTime, kPsPerMs, 10 * kPsPerUs,
                             kPsPerSecond, "width of one row of timeline.csv", Origin::kChoice,
                             ""};
  std::array<std::unique_ptr<MasterPortParams>, kMasterCount> ports;
  CrossbarParams() : ParamGroup("bus") {
    for (std::size_t i = 0; i < kMasterCount; ++i)
      ports[i] = std::make_unique<MasterPortParams>(static_cast<Master>(i));
  }
};

}  // namespace fovea::bus
