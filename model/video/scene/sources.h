// Picture sources of the camera: a still seen by a swaying camera, a video, and a test chart.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/video/core/picture.h"
#include "model/video/scene/colour.h"
#include "model/video/scene/lens_model.h"
#include "model/video/scene/rgb_image.h"
#include "model/video/scene/stamp.h"

namespace fovea::video {

/// Size of the picture that the camera's encoder needs, and whether marks are drawn into it.
struct Raster {
  unsigned width = 720;   ///< pixels, even
  unsigned height = 576;  ///< rows
  bool stamped = true;
  unsigned camera = 0;  ///< that the marks name
};

/// A source that draws the marks of stamp.h into its pictures.
class StampedSource : public PictureSource {
 public:
  unsigned width() const override { return raster_.width; }
  unsigned height() const override { return raster_.height; }
  /// The picture of field k, with all rows of that instant. Valid until the next call.
  const Picture& field(std::uint64_t k) final;
  /// Positions of the marks; empty if they are disabled.
  const std::optional<StampLayout>& stamps() const { return layout_; }

 protected:
  /// @param centre the optical centre in raster pixels; the marks are placed around it
  StampedSource(const Raster& raster, const Point& centre);
  /// Picture k without marks. May return the same object for several k, but must not change an
  /// object that it has returned before the next call.
  virtual const Picture& view(std::uint64_t k) = 0;
  unsigned camera() const { return raster_.camera; }

 private:
  Raster raster_;
  std::optional<StampLayout> layout_;
  Picture out_;
  std::optional<std::uint64_t> out_field_;
};

/// How the camera sways in front of a still: yaw = amplitude sin(2 pi p), pitch = amplitude / 2
/// sin(4 pi p), where p = (k mod period) / period.
struct Motion {
  unsigned period_fields = 60;
  double amplitude_deg = 0;  ///< 0: the picture does not move
};

/// A still photograph, seen by a camera that turns about its optical centre. The direction of each
/// raster pixel is rotated and looked up in the photograph through the photograph's own lens model.
/// So the optical centre and the distortion stay constant while the scene moves. Black outside the
/// photograph. Keeps one picture for each phase of the motion: period * width * height * 2 bytes.
class SphereSource : public StampedSource {
 public:
  /// `lens` is in pixels of the still, which is stretched to the raster's width and height.
  SphereSource(const RgbImage& still, const LensModel& lens, const Raster& raster,
               const Motion& motion);
  /// The lens in raster pixels.
  const LensModel& raster_lens() const { return raster_lens_; }

 protected:
  const Picture& view(std::uint64_t k) override;

 private:
  void render(double yaw, double pitch, Picture& picture);

  SampledImage still_;
  LensModel lens_, raster_lens_;
  Motion motion_;
  struct Direction {
    float x, y, z;
  };
  std::vector<Direction> directions_;  ///< for each raster pixel; NaN if the lens images nothing
                                       ///< there
  std::vector<float> stretch_;         ///< r(theta) / sin(theta) over equal steps of cos(theta)
  float cos_min_, steps_per_cos_;
  std::vector<std::uint64_t> row_;
  std::vector<Picture> phases_;  ///< each is empty until it is used
};

/// Parameters for a synthetic fish-eye picture made of flat (rectilinear) frames.
struct Warp {
  LensModel lens;       ///< the fish-eye lens, in raster pixels
  double flat_fov_deg;  ///< horizontal angle of the flat video in degrees, below 178
};

/// Frames of a 25 Hz video: fields 2n and 2n+1 show frame n; after the last frame it starts again.
/// Frames of another size are stretched to the raster; with a warp, they are the scene of a
/// synthetic fish-eye. Interpolation is bilinear, so large reductions should be done beforehand.
class VideoSource : public StampedSource {
 public:
  /// @throws UserError if there are no frames or their sizes differ
  VideoSource(std::vector<RgbImage> frames, const Raster& raster, std::optional<Warp> warp = {});
  /// The flat frame that fields 2n and 2n + 1 show.
  const RgbImage& flat_frame(std::uint64_t n) const { return frames_[n % frames_.size()]; }

 protected:
  const Picture& view(std::uint64_t k) override;

 private:
  std::vector<RgbImage> frames_;
  std::vector<std::pair<float, float>> positions_;  ///< empty if the frames have the size of the
                                                    ///< raster
  std::vector<std::uint64_t> row_;
  std::optional<SampledImage> sampled_;  ///< the current frame
  Picture current_;
  std::optional<std::size_t> current_index_;
};

/// A pattern in which nearly every byte differs from its neighbours in space and time, so that a
/// wrong address, row or field gives wrong bytes. All levels are within BT.601, never 0 or 255.
class ChartSource : public StampedSource {
 public:
  explicit ChartSource(const Raster& raster);
  /// The bytes Cb Y0 Cr Y1 of pixels x, x + 1 (x even) in row y of field k, without marks. Camera n
  /// shows field k + n * kCameraFields of camera 0.
  static constexpr std::uint64_t kCameraFields = std::uint64_t{1} << 40;
  static std::array<std::uint8_t, 4> pair(unsigned x, unsigned y, std::uint64_t k);

 protected:
  const Picture& view(std::uint64_t k) override;

 private:
  Picture current_;
};

}  // namespace fovea::video
