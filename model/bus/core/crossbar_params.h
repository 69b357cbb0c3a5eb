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
        width(*this, "width", is_core(m) ? "32bit" : "64bit", {"16bit", "32bit", "64bit"},
              "data that crosses the port in a crossbar clock, each way",
              is_video(m) ? Origin::kFamily : Origin::kAssumed, width_source(m), width_belief(m)),
        request_latency(*this, "request_latency", U::kCycles, is_core(m) ? 3 : 2, 0, 16,
                        "crossbar clocks (SYSCLK4) through the bridge before arbitration",
                        Origin::kAssumed, kLatencySource, latency_belief(m)),
        response_latency(*this, "response_latency", U::kCycles, is_core(m) ? 3 : 2, 0, 16,
                         "crossbar clocks from the crossbar back to the master's port",
                         Origin::kAssumed, kLatencySource, latency_belief(m)) {}
  static constexpr const char* kLatencySource = "no public figure for a bridge of this chip";
  static const char* width_source(Master m) {
    if (is_core(m))
      return "the core's AHB beats are 32 bits (ARM DDI 0198); that the bridge gathers none is "
             "assumed";
    if (is_video(m)) return "TMS320DM355 (SPRS463A): 64 bits from the VPSS buffers to the DMA bus";
    return "no public figure; the transfer controllers' buses are taken as wide as the crossbar";
  }
  static Belief width_belief(Master m) {
    if (is_core(m))
      return {"32bit", "64bit", "a bridge may gather two AHB beats into one of the crossbar"};
    if (is_video(m)) return {"64bit", "64bit", "the video front end changed little since the DM355"};
    return {"32bit", "64bit", "transfer controllers of sister chips have 32 or 64 bits"};
  }
  static Belief latency_belief(Master m) {
    if (is_core(m))
      return {"2 cycles", "6 cycles",
              "a clock-crossing bridge takes two clocks at least; above six a core at 297 MHz could "
              "not remap the 25 PAL frames a second that were reported for a DM365"};
    return {"1 cycles", "4 cycles", "from a register stage to a clock-crossing bridge"};
  }
  static bool is_video(Master m) { return master_info(m).bridge == Bridge::kVideo; }
  /// log2 of the bytes of a beat.
  unsigned beat_log2() const { return width.is("16bit") ? 1 : width.is("32bit") ? 2 : 3; }
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
      add_part(*(ports[i] = std::make_unique<MasterPortParams>(master_of_stat(i))));
  }
};

}  // namespace fovea::bus
