// A 4:2:2 picture, and the interface of picture sources for the camera.
#pragma once
#include <cstdint>
#include <vector>

namespace fovea::video {

/// A 4:2:2 picture with 8-bit samples in the order Cb Y0 Cr Y1 (UYVY), rows top to bottom, no
/// padding.
struct Picture {
  unsigned width = 0;   ///< pixels, even
  unsigned height = 0;  ///< rows
  std::vector<std::uint8_t> uyvy;

  Picture() = default;
  /// A picture of one colour; black by default (Y 16, C 128).
  Picture(unsigned w, unsigned h, std::uint8_t y = 16, std::uint8_t cb = 128, std::uint8_t cr = 128)
      : width(w), height(h), uyvy(std::size_t{w} * h * 2) {
    for (std::size_t i = 0; i + 3 < uyvy.size(); i += 4) {
      uyvy[i] = cb;
      uyvy[i + 1] = y;
      uyvy[i + 2] = cr;
      uyvy[i + 3] = y;
    }
  }
  unsigned row_bytes() const { return width * 2; }
  const std::uint8_t* row(unsigned y) const { return uyvy.data() + std::size_t{y} * row_bytes(); }
  std::uint8_t* row(unsigned y) { return uyvy.data() + std::size_t{y} * row_bytes(); }
  friend bool operator==(const Picture&, const Picture&) = default;
};

/// In place of a camera's number: the picture of none.
inline constexpr unsigned kNoCamera = ~0u;

/// Delivers what the camera sees. Field k starts k field periods after power-up. field(k) returns a
/// picture of full height for that instant; the encoder sends the rows of the field's parity. The
/// result must depend on k only. The reference is valid until the next call.
class PictureSource {
 public:
  virtual ~PictureSource() = default;
  virtual unsigned width() const = 0;
  virtual unsigned height() const = 0;
  virtual const Picture& field(std::uint64_t k) = 0;
};

}  // namespace fovea::video
