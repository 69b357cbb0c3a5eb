// The two video links between blocks: BT.656 from the decoder, active lines to the display.
#pragma once
#include <cstdint>
#include <span>
#include <systemc>

#include "model/common/clock.h"
#include "model/video/core/bt656.h"
#include "model/video/core/frame_assembler.h"

namespace fovea::video {

/// Computes the bytes of a line on request.
class Bt656Renderer {
 public:
  virtual ~Bt656Renderer() = default;
  /// All standard.line_bytes bytes of the line that was announced last; valid until the next line.
  virtual std::span<const std::uint8_t> render() = 0;
};

/// A line that shows no camera's picture.
inline constexpr int kNoCamera = -1;

/// A line on the wire, announced at its first sample (EAV). Sample i is on the wire from clock edge
/// first_sample + i to the next edge.
struct Bt656Line {
  const Standard* standard;
  const Clock* clock;          ///< the byte clock; outlives the call
  Picoseconds start;           ///< time of edge first_sample
  std::uint64_t first_sample;  ///< edge number of the EAV's first byte
  std::uint64_t field_index;   ///< field number of the picture source; only for statistics and
                               ///< tests
  unsigned number;             ///< line number; only for statistics and tests: receivers count
                               ///< lines themselves
  std::uint8_t eav_xy, sav_xy;
  Bt656Renderer* renderer;
  int camera = kNoCamera;  ///< whose picture it shows; only for statistics and tests
  unsigned missing = 0;    ///< samples that it lacks at its end: the next line comes so much earlier
  std::span<const std::uint8_t> bytes() const { return renderer->render(); }
};

class Bt656If : public virtual sc_core::sc_interface {
 public:
  virtual void line(const Bt656Line& line) = 0;
};

class DisplayLineIf : public virtual sc_core::sc_interface {
 public:
  /// Called when the last sample of the line has been sent.
  virtual void line(const DisplayLine& line) = 0;
  /// The raster was switched off; an incomplete frame is lost.
  virtual void raster_off() = 0;
};

}  // namespace fovea::video
