#include "model/board/camera_fault.h"

#include "model/common/check.h"

namespace fovea::board {

FaultParams::FaultParams() : ParamGroup("fault") {
  const auto only = [this](ParamBase& p, const char* condition, auto... words) {
    p.matters_only(condition, {&kind}, [this, words...] { return (kind.is(words) || ...); });
  };
  for (ParamBase* p : std::initializer_list<ParamBase*>{&start, &end})
    p->matters_only("a fault.kind other than none", {&kind}, [this] { return !kind.is("none"); });
  camera.matters_only("a fault.kind other than none and stuck_select", {&kind}, [this] { return of_camera(); });
  for (ParamBase* p : std::initializer_list<ParamBase*>{&select_line, &select_level})
    only(*p, "fault.kind = stuck_select", "stuck_select");
  only(wrong_bits, "fault.kind = sync_noise", "sync_noise");
  only(every, "fault.kind = sync_noise", "sync_noise");
  only(lines, "fault.kind = missing_lines or short_lines", "missing_lines", "short_lines");
  only(samples, "fault.kind = short_lines", "short_lines");
  only(drift, "fault.kind = clock_drift", "clock_drift");
}

video::SignalFault FaultParams::of_lines() const {
  video::SignalFault out;
  if (kind.is("sync_noise")) {
    out.wrong_bits = static_cast<unsigned>(wrong_bits());
    out.every = static_cast<unsigned>(every());
  } else if (kind.is("missing_lines") || kind.is("short_lines")) {
    out.lines = static_cast<unsigned>(lines());
    out.samples = kind.is("short_lines") ? static_cast<unsigned>(samples()) : 0;
  }
  return out;
}

CameraFault::CameraFault(sc_core::sc_module_name name, const FaultParams& params,
                         const video::CameraWiring& wiring, video::Tvp5146& decoder,
                         AnalogueMultiplexer* multiplexer)
    : sc_module(name), params_(params), wiring_(wiring), decoder_(decoder), multiplexer_(multiplexer) {
  FOVEA_CHECK(multiplexer || !params.kind.is("stuck_select"), "a select line of no multiplexer is stuck");
  SC_METHOD(step);
  sensitive << timer_.event();
}

void CameraFault::apply(bool present) {
  if (params_.kind.is("stuck_select"))
    return multiplexer_->stick(static_cast<unsigned>(params_.select_line()),
                               present ? std::optional(params_.select_level() != 0) : std::nullopt);
  const auto camera = static_cast<std::size_t>(params_.camera());
  if (params_.kind.is("unplugged"))
    decoder_.connect(camera, !present && wiring_.connected);
  else if (params_.kind.is("wrong_standard"))
    decoder_.set_standard(camera, wiring_.is_625 != present);
  else if (params_.kind.is("clock_drift"))
    decoder_.set_clock_offset(camera, wiring_.clock_offset + (present ? params_.drift() : 0));
  else
    decoder_.disturb(camera, present ? params_.of_lines() : video::SignalFault{});
}

void CameraFault::step() {
  const Picoseconds now = kernel_time();
  if (!present_ && now < params_.start()) return timer_.at(params_.start());
  present_ = !present_;
  apply(present_);
  if (present_ && params_.end() > now) timer_.at(params_.end());
}

}  // namespace fovea::board
