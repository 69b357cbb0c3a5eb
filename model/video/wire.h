// The two video links between blocks: BT.656 from decoder or camera to the capture, active lines to the display.
#pragma once
#include <cstdint>
#include <span>
#include <systemc>

#include "model/common/clock.h"
#include "model/video/core/bt656.h"
#include "model/video/core/frame_assembler.h"

namespace fovea::video {

/// The beginning of a line on the wire. Sample i is on the wire from clock edge first_sample + i to the next edge.
struct Bt656Line {
  const Standard* standard;    ///< the raster that it is in
  const Clock* clock;          ///< the byte clock; outlives the call
  std::uint64_t first_sample;  ///< number of the present clock edge, that of the EAV's first byte
  std::uint8_t eav_xy;         ///< the fourth byte of the EAV, in which bits may be wrong
};

class Bt656If : public virtual sc_core::sc_interface {
 public:
  /// A line begins now.
  /// @return whether the receiver takes its bytes. Only then the sender composes them, and calls take_line() before
  /// anything else happens.
  virtual bool begin_line(const Bt656Line& line) = 0;
  /// The bytes of the line that has just begun, EAV first: standard->line_bytes of them, or fewer where samples are
  /// missing at its end, so that the next line comes earlier. Valid during the call.
  virtual void take_line(std::span<const std::uint8_t> bytes) = 0;
};

class DisplayLineIf : public virtual sc_core::sc_interface {
 public:
  /// Called when the last sample of the line has been sent.
  virtual void line(const DisplayLine& line) = 0;
  /// The raster was switched off; an incomplete frame is lost.
  virtual void raster_off() = 0;
};

}  // namespace fovea::video
