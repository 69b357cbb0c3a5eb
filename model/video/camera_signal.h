// The signal of one camera on its cable: when its lines and fields begin, and what they show.
#pragma once
#include <cstdint>

#include "model/common/clock.h"
#include "model/video/core/bt656.h"
#include "model/video/core/picture.h"

namespace fovea::video {

/// A camera on an input of the decoder.
struct CameraWiring {
  PictureSource* source = nullptr;
  std::uint8_t input = 0;  ///< code of the decoder's register 00 that selects it
  bool is_625 = true;
  Placement placement = kPlacement625;
  Picoseconds phase = 0;     ///< start of its first field after power-up
  double clock_offset = 0;   ///< of its clock from the nominal one, in parts per million
  bool connected = true;     ///< false: there is nothing on the input
};

/// The camera runs from power-up plus its phase, whatever the decoder does. Its samples are counted
/// at 27 MHz of its own clock, which a line-locked decoder follows.
class CameraSignal {
 public:
  /// @throws UserError for a picture that does not fit the standard
  explicit CameraSignal(const CameraWiring& wiring);

  /// The nominal clock has changed at `now`; its first start is the camera's power-up.
  void clock_changed(Frequency nominal, Picoseconds now);
  /// Number of the field whose samples are on the wire at `now`.
  std::uint64_t field_at(Picoseconds now) const;
  /// Start of field k (its first line). k must not be before the last change of the clock.
  Picoseconds field_time(std::uint64_t k) const;
  /// The first line that begins at clock edge `edge` or later.
  std::uint64_t line_from(std::uint64_t edge) const;
  /// Clock edge at which a line begins.
  std::uint64_t line_edge(std::uint64_t line) const { return origin_ + line * standard_.line_bytes; }
  /// The picture of a field, asked for once per field.
  const Picture& picture(std::uint64_t field);

  const Standard& standard() const { return standard_; }
  const Placement& placement() const { return wiring_.placement; }
  const Clock& clock() const { return clock_; }
  std::uint8_t input() const { return wiring_.input; }
  unsigned width() const { return wiring_.source->width(); }
  unsigned height() const { return wiring_.source->height(); }

  bool connected;  ///< a cable is plugged in

 private:
  CameraWiring wiring_;
  const Standard& standard_;
  Clock clock_;
  bool started_ = false;
  std::uint64_t origin_ = 0;         // clock edge at which line 0 begins
  std::uint64_t stopped_field_ = 0;  // the field at the time the clock stopped
  const Picture* picture_ = nullptr;
  std::uint64_t picture_field_ = 0;
};

}  // namespace fovea::video
