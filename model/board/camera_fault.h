// A fault of a camera, of its cable or of the multiplexer at a time of the experiment.
#pragma once
#include <systemc>

#include "model/board/analogue_multiplexer.h"
#include "model/common/param.h"
#include "model/common/timer.h"
#include "model/contract/param_page.h"
#include "model/video/tvp5146.h"

namespace fovea::board {

struct FaultParams : ParamGroup {
  using U = IntParam::Unit;
  EnumParam kind{*this, "kind", "none",
                 {"none", "unplugged", "wrong_standard", "sync_noise", "missing_lines", "short_lines",
                  "clock_drift", "stuck_select"},
                 "what happens to a camera during the run, and is over later: its cable is unplugged; it "
                 "sends the other standard; its timing codes have wrong bits; lines of each field are "
                 "missing, or too short; its clock is off; or, with cameras.multiplexer = gpio, a select line "
                 "of the multiplexer is stuck",
                 Origin::kChoice, ""};
  IntParam camera{*this, "camera", U::kCount, 0, 0, PARAM_CAMERAS_MAX - 1,
                  "number of the camera", Origin::kChoice, ""};
  IntParam start{*this, "start", U::kTime, kPsPerSecond, 0, 3600 * kPsPerSecond,
                 "when it begins, after power-up", Origin::kChoice, ""};
  IntParam end{*this, "end", U::kTime, 2 * kPsPerSecond, 0, 3600 * kPsPerSecond,
               "when it is over; not after fault.start: never", Origin::kChoice, ""};
  IntParam wrong_bits{*this, "wrong_bits", U::kCount, 1, 1, 2,
                      "wrong bits in each damaged timing code (EAV and SAV); every one, or every pair, of "
                      "the seven coded bits in turn. One is corrected, two are detected (ITU-R BT.656)",
                      Origin::kChoice, ""};
  IntParam every{*this, "every", U::kCount, 1, 1, 100'000,
                 "one of so many lines has damaged timing codes", Origin::kChoice, ""};
  IntParam lines{*this, "lines", U::kCount, 4, 1, 100,
                 "lines of each field, from the middle of the picture on, that are missing or short: what "
                 "follows comes earlier",
                 Origin::kChoice, ""};
  IntParam samples{*this, "samples", U::kCount, 400, 4, 1400,
                   "samples of 27 MHz that each short line lacks at its end", Origin::kChoice, ""};
  RealParam drift{*this, "drift", "ppm", 500, -10'000, 10'000,
                  "of the camera's clock from 27 MHz while the fault is present, in parts per million",
                  Origin::kChoice, ""};
  IntParam select_line{*this, "select_line", U::kCount, 0, 0, MULTIPLEXER_LINES - 1,
                       "select line of the multiplexer that is stuck; 0 is the lowest bit of the camera's number",
                       Origin::kChoice, ""};
  IntParam select_level{*this, "select_level", U::kCount, 0, 0, 1, "level at which that line is stuck",
                        Origin::kChoice, ""};
  FaultParams();

  /// It is a fault of a camera, or of its cable.
  bool of_camera() const { return !kind.is("none") && !kind.is("stuck_select"); }
  /// The fault of the lines that the kind means.
  video::SignalFault of_lines() const;
};

/// Brings the fault at fault.start and takes it away at fault.end.
class CameraFault : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(CameraFault);
  /// @param wiring of the camera: what it is without the fault
  /// @param multiplexer null if there is none, which a stuck select line needs
  CameraFault(sc_core::sc_module_name name, const FaultParams& params,
              const video::CameraWiring& wiring, video::Tvp5146& decoder, AnalogueMultiplexer* multiplexer);

 private:
  void step();
  void apply(bool present);
  const FaultParams& params_;
  const video::CameraWiring wiring_;
  video::Tvp5146& decoder_;
  AnalogueMultiplexer* const multiplexer_;
  Timer timer_;
  bool present_ = false;
};

}  // namespace fovea::board
