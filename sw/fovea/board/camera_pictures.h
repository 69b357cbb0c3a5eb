// Keeps what the camera sends, so that each displayed frame can be put beside the frame it shows.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "model/video/core/picture.h"
#include "model/video/camera_signal.h"

namespace fovea::app {

/// Delivers the pictures of another source unchanged and remembers those of the last fields.
class CameraPictures : public video::PictureSource {
 public:
  explicit CameraPictures(video::PictureSource& source) : source_(source) {}
  unsigned width() const override { return source_.width(); }
  unsigned height() const override { return source_.height(); }
  const video::Picture& field(std::uint64_t k) override;

  /// The picture of a field; null if it is not kept any more.
  const video::Picture* kept(std::uint64_t field) {
    const Kept& kept = place(field);
    return kept.field == field ? &kept.picture : nullptr;
  }
  /// The frame whose first field began at `start`, woven from its two fields as the decoder sends their
  /// rows; null if it is not kept any more. Valid until the next call of frame().
  const video::Picture* frame(const video::CameraSignal& signal, Picoseconds start);
  /// The first field of the frame that frame() gave last.
  std::uint64_t first_field() const { return woven_first_; }

 private:
  /// More than the fields between a frame's capture and the end of its first display. A frame that is
  /// shown later, or again, is the one that was asked for last, or is not there.
  static constexpr std::size_t kFields = 16;
  struct Kept {
    std::optional<std::uint64_t> field;
    video::Picture picture;
  };
  Kept& place(std::uint64_t field) { return kept_[field % kFields]; }

  video::PictureSource& source_;
  std::array<Kept, kFields> kept_;
  std::optional<Picoseconds> woven_start_;
  std::uint64_t woven_first_ = 0;
  video::Picture woven_;
};

}  // namespace fovea::app
