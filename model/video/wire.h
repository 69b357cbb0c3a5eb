// The two wires of the video blocks: BT.656 from the decoder, active lines to the display.
#pragma once
#include <cstdint>
#include <span>
#include <systemc>

#include "model/common/clock.h"
#include "model/video/core/bt656.h"
#include "model/video/core/frame_assembler.h"

namespace fovea::video {

/// Renders a line's bytes when somebody wants them.
class Bt656Renderer {
 public:
  virtual ~Bt656Renderer() = default;
  /// All standard.line_bytes bytes of the line announced last; valid until the next line.
  virtual std::span<const std::uint8_t> render() = 0;
};

/// One line on the wire, announced at its first sample (EAV). Sample i of it is on the wire from
/// clock edge first_sample + i to the next edge.
struct Bt656Line {
  const Standard* standard;
  const Clock* clock;          ///< the byte clock; outlives the call
  Picoseconds start;           ///< time of edge first_sample
  std::uint64_t first_sample;  ///< edge number of the EAV's first byte
  std::uint64_t field_index;   ///< the picture source's field number; for bookkeeping only
  unsigned number;             ///< line number; for bookkeeping only: receivers count themselves
  std::uint8_t eav_xy, sav_xy;
  Bt656Renderer* renderer;
  std::span<const std::uint8_t> bytes() const { return renderer->render(); }
};

class Bt656If : public virtual sc_core::sc_interface {
 public:
  virtual void line(const Bt656Line& line) = 0;
};

class DisplayLineIf : public virtual sc_core::sc_interface {
 public:
  /// Called when the line's last sample is out.
  virtual void line(const DisplayLine& line) = 0;
  /// The raster was switched off; a frame under way is lost.
  virtual void raster_off() = 0;
};

}  // namespace fovea::video
