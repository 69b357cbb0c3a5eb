// Parameters of the switched central resource and of the bridges into it.
#pragma once
#include <array>
#include <memory>
#include <string>

#include "model/common/masters.h"
#include "model/common/param.h"

namespace fovea::bus {

/// Of a master's port; both sides of a transfer controller have the same.
struct MasterPortParams : ParamGroup {
  using U = IntParam::Unit;
  EnumParam width;
  IntParam request_latency;
  IntParam response_latency;
  explicit MasterPortParams(Master m)
      : ParamGroup("bus." + std::string(stat_name(m))),
        width(*this, "width", is_arm(m) ? "32bit" : "64bit", {"16bit", "32bit", "64bit"},
              "data that crosses the port in a crossbar clock, each way", Origin::kAssumed,
              width_source(m)),
        request_latency(*this, "request_latency", U::kCycles, is_arm(m) ? 3 : 2, 0, 16,
                        "crossbar clocks (SYSCLK4) through the bridge before arbitration",
                        Origin::kAssumed, "no public figure; dm365.md 12 #6: 2 to 4 per hop"),
        response_latency(*this, "response_latency", U::kCycles, is_arm(m) ? 3 : 2, 0, 16,
                         "crossbar clocks from the crossbar back to the master's port",
                         Origin::kAssumed, "no public figure; dm365.md 12 #6: 2 to 4 per hop") {}
  static const char* width_source(Master m) {
    if (is_arm(m))
      return "AHB beats are 32 bits (arm926.md 3); that the bridge gathers none is assumed";
    if (m == Master::kVpfe || m == Master::kVpbe)
      return "VPSS buffers to DMA bus on the DM355: 64 bits, dm365.md 6.2";
    return "no public figure; dm365.md 4: TC buses equal the crossbar's 64 bits";
  }
  static bool is_arm(Master m) { return m == Master::kArmI || m == Master::kArmD; }
  /// log2 of the bytes of a beat.
  unsigned beat_log2() const { return 1 + static_cast<unsigned>(width.index()); }
};

struct CrossbarParams : ParamGroup {
  using U = IntParam::Unit;
  IntParam timeline_interval{*this, "timeline_interval", U::kTime, kPsPerMs, 10 * kPsPerUs,
                             kPsPerSecond, "width of one row of timeline.csv", Origin::kChoice,
                             ""};
  std::array<std::unique_ptr<MasterPortParams>, kStatCount> ports;
  const MasterPortParams& port(Master m) const { return *ports[stat_index(m)]; }
  CrossbarParams() : ParamGroup("bus") {
    for (std::size_t i = 0; i < kStatCount; ++i)
      ports[i] = std::make_unique<MasterPortParams>(static_cast<Master>(i));
  }
};

}  // namespace fovea::bus
