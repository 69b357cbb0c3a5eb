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
  bool genlocked = false;    ///< it follows the syncs of others: after a fault its next frame begins with theirs
};

/// What is wrong with the lines that a camera sends; by default nothing.
struct SignalFault {
  unsigned wrong_bits = 0;  ///< in each damaged timing code: 1 or 2 of F, V, H and P3 to P0 in turn
  unsigned every = 1;       ///< one of so many lines has damaged codes
  unsigned lines = 0;       ///< of each field, from the middle of the picture on, that are missing or short
  unsigned samples = 0;     ///< that each of them lacks at its end; 0: the whole line is missing
};

/// Bits that are wrong in the n-th damaged code: every one, or every pair, of the seven coded bits in turn.
constexpr std::uint8_t wrong_bits(unsigned bits, std::uint64_t n) {
  if (bits == 1) return static_cast<std::uint8_t>(1u << n % 7);
  unsigned left = static_cast<unsigned>(n % 21);  // 7 * 6 / 2 pairs
  for (unsigned high = 1;; left -= high++)
    if (left < high) return static_cast<std::uint8_t>(1u << high | 1u << left);
}

/// The camera runs from power-up plus its phase, whatever the decoder does. Its samples are counted
/// at 27 MHz of its own clock, which a line-locked decoder follows.
class CameraSignal {
 public:
  /// @throws UserError for a picture that does not fit the standard
  explicit CameraSignal(const CameraWiring& wiring);

  /// The nominal clock has changed at `now`; its first start is the camera's power-up.
  void clock_changed(Frequency nominal, Picoseconds now);
  /// From the next edge on the camera's clock is so many parts per million off the nominal one.
  void set_clock_offset(double ppm, Picoseconds now);
  /// The camera sends another standard: line 1 of its next even field begins at clock edge `edge`, or, if a genlocked
  /// camera returns to the standard that it had at first, where the next frame of those that it follows begins. A
  /// picture with more rows than the standard has shows those in the middle.
  void set_standard(bool is_625, const Placement& placement, std::uint64_t edge, Picoseconds now);
  /// All lines that are still to come begin so many samples earlier: some were left out.
  void leave_out(std::uint64_t samples) {
    origin_ -= static_cast<std::int64_t>(samples);
    left_out_ += static_cast<std::int64_t>(samples);
  }
  /// What a genlocked camera does at the beginning of a frame once nothing is wrong with its lines: it waits for the
  /// syncs that it follows (assumed: at its next frame). @return whether the lines to come begin later now
  bool follow_again() {
    if (!wiring_.genlocked || !left_out_ || fault.lines) return false;
    origin_ += left_out_;
    left_out_ = 0;
    return true;
  }
  /// Number of the field whose samples are on the wire at `now`.
  std::uint64_t field_at(Picoseconds now) const;
  /// Start of field k (its first line). k must not be before the last change of the clock.
  Picoseconds field_time(std::uint64_t k) const;
  /// The first line that begins at clock edge `edge` or later.
  std::uint64_t line_from(std::uint64_t edge) const;
  /// Clock edge at which a line begins.
  std::uint64_t line_edge(std::uint64_t line) const {
    return static_cast<std::uint64_t>(origin_) + line * standard_->line_bytes;
  }
  /// Field and number of a line; the lines are counted from the last change of the standard.
  LinePosition position(std::uint64_t line) const {
    LinePosition p = locate(*standard_, line);
    p.field += first_field_;
    return p;
  }
  /// The picture of a field, asked for once per field.
  const Picture& picture(std::uint64_t field);

  const Standard& standard() const { return *standard_; }
  const Placement& placement() const { return wiring_.placement; }
  const Clock& clock() const { return clock_; }
  std::uint8_t input() const { return wiring_.input; }
  unsigned width() const { return wiring_.source->width(); }
  unsigned height() const { return wiring_.source->height(); }

  bool connected;      ///< a cable is plugged in
  bool led = true;     ///< to the decoder's input; false: an external multiplexer leads another camera there
  SignalFault fault;   ///< of the lines that are sent

 private:
  CameraWiring wiring_;
  const Standard* standard_;
  Frequency nominal_;
  Clock clock_;
  bool started_ = false;
  std::int64_t origin_ = 0;          // clock edge at which line 0 begins; before edge 0 after lines
                                     // were left out
  std::int64_t left_out_ = 0;        // samples, since it began with the others
  std::uint64_t first_edge_ = 0;     // at which its first line began
  std::uint64_t first_field_ = 0;    // of line 0; even
  std::uint64_t stopped_field_ = 0;  // the field at the time the clock stopped
  const Picture* picture_ = nullptr;
  std::uint64_t picture_field_ = 0;
};

}  // namespace fovea::video
