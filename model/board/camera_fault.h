// A fault of a camera's cable at a time of the experiment.
#pragma once
#include <systemc>

#include "model/common/param.h"
#include "model/common/timer.h"
#include "model/contract/param_page.h"
#include "model/video/tvp5146.h"

namespace fovea::board {

struct FaultParams : ParamGroup {
  EnumParam kind{*this, "kind", "none", {"none", "unplugged"},
                 "what happens to a camera during the run: its cable is unplugged, and plugged in again",
                 Origin::kChoice, ""};
  IntParam camera{*this, "camera", IntParam::Unit::kCount, 0, 0, PARAM_CAMERAS_MAX - 1,
                  "number of the camera", Origin::kChoice, ""};
  IntParam start{*this, "start", IntParam::Unit::kTime, kPsPerSecond, 0, 3600 * kPsPerSecond,
                 "when it begins, after power-up", Origin::kChoice, ""};
  IntParam end{*this, "end", IntParam::Unit::kTime, 2 * kPsPerSecond, 0, 3600 * kPsPerSecond,
               "when it is over; not after fault.start: never", Origin::kChoice, ""};
  FaultParams() : ParamGroup("fault") {
    for (ParamBase* p : std::initializer_list<ParamBase*>{&camera, &start, &end})
      p->matters_only("a fault.kind other than none", {&kind}, [this] { return !kind.is("none"); });
  }
};

/// Unplugs the cable at fault.start and plugs it in again at fault.end.
class CameraFault : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(CameraFault);
  CameraFault(sc_core::sc_module_name name, const FaultParams& params, video::Tvp5146& decoder);

 private:
  void step();
  const FaultParams& params_;
  video::Tvp5146& decoder_;
  Timer timer_;
  bool present_ = false;
};

}  // namespace fovea::board
