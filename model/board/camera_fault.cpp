#include "model/board/camera_fault.h"

namespace fovea::board {

CameraFault::CameraFault(sc_core::sc_module_name name, const FaultParams& params,
                         video::Tvp5146& decoder)
    : sc_module(name), params_(params), decoder_(decoder) {
  SC_METHOD(step);
  sensitive << timer_.event();
}

void CameraFault::step() {
  const Picoseconds now = kernel_time();
  if (!present_ && now < params_.start()) return timer_.at(params_.start());
  present_ = !present_;
  decoder_.connect(params_.camera(), !present_);
  if (present_ && params_.end() > now) timer_.at(params_.end());
}

}  // namespace fovea::board
