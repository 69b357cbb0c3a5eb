// A progressive camera at the digital video port: it sends its lines to the ISIF without a decoder.
#pragma once
#include <array>
#include <cstdint>
#include <systemc>

#include "model/common/sc_ports.h"
#include "model/common/timer.h"
#include "model/video/core/picture.h"
#include "model/video/wire.h"

namespace fovea::video {

/// Sends 8-bit 4:2:2 with embedded timing codes, as BT.656 does, in a progressive raster: from power-up plus its
/// phase on, one field after another, with F = 0. Frame k shows what its source has for field 2 k, so that film and
/// motion run as fast as with an interlaced camera of the same frame rate. Its byte clock is the pixel clock of the
/// port (PCLK), two periods a pixel. Not modelled: the sensor's registers, separate syncs.
class DigitalCamera : public sc_core::sc_module {
 public:
  ClockIn clock{"clock"};  ///< byte clock
  sc_core::sc_port<Bt656If> video{"video"};

  SC_HAS_PROCESS(DigitalCamera);
  /// @param standard a progressive one; outlives the camera
  /// @throws UserError for a picture that does not have the raster's size
  DigitalCamera(sc_core::sc_module_name name, const Standard& standard, PictureSource& source, Picoseconds phase);

  std::uint64_t lines_sent() const { return next_line_; }
  /// The source's field that is shown by the frame whose samples are on the wire at `now`.
  std::uint64_t source_field(Picoseconds now) const;

 private:
  void clock_changed();
  void send_line();
  std::span<const std::uint8_t> compose(LinePosition at);

  const Standard& standard_;
  PictureSource& source_;
  const Picoseconds phase_;
  Clock edges_;
  bool started_ = false;
  std::uint64_t origin_ = 0;     // edge at which line 0 begins
  std::uint64_t next_line_ = 0;  // counted from the first one
  const Picture* picture_ = nullptr;  // of frame picture_frame_; asked for once per frame
  std::uint64_t picture_frame_ = 0;
  Timer line_timer_;
  std::array<std::uint8_t, kMaxLineBytes> bytes_{};
};

}  // namespace fovea::video
