// Picture sources of the camera: a still on a swaying view sphere, a video, and a test chart.
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

/// Size of the picture that the camera's encoder asks for, and whether marks are drawn into it.
struct Raster {
  unsigned width = 720;   ///< pixels, even
  unsigned height = 576;  ///< rows
  bool stamped = true;
};

/// A source whose pictures carry the marks of stamp.h.
class StampedSource : public PictureSource {
 public:
  unsigned width() const override { return raster_.width; }
  unsigned height() const override { return raster_.height; }
  /// The picture of field k, all rows of that one instant. Valid until the next call.
  const Picture& field(std::uint64_t k) final;
  /// Where the marks are; nothing when they are off.
  const std::optional<StampLayout>& stamps() const { return layout_; }

 protected:
  /// `centre`: the optical centre in raster pixels, where the marks gather.
  StampedSource(const Raster& raster, const Point& centre);
  /// Picture k without marks. May return the same object for many k, but never one that a later
  /// call changes behind the reference's back before the next call.
  virtual const Picture& view(std::uint64_t k) = 0;

 private:
  Raster raster_;
  std::optional<StampLayout> layout_;
  Picture out_;
  std::optional<std::uint64_t> out_field_;
};

/// How the view of a still sways: yaw = amplitude sin(2 pi p), pitch = amplitude / 2 sin(4 pi p),
/// p = k mod period / period.
struct Motion {
  unsigned period_fields = 60;
  double amplitude_deg = 0;  ///< 0: the picture stands still
};

/// A still photograph, looked at by a camera that turns about its optical centre. Each raster
/// pixel's direction is turned and looked up in the photograph through the photograph's own lens
/// model, so the optical centre and the distortion stay put while the scene moves. Black outside
/// the photograph. Keeps one picture per phase of the motion: period * width * height * 2 bytes.
class SphereSource : public StampedSource {
 public:
  /// `lens` in pixels of the still; the still is stretched to the raster's width and height.
  SphereSource(const RgbImage& still, const LensModel& lens, const Raster& raster,
               const Motion& motion);
  /// The lens as the raster sees it, in raster pixels.
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
  std::vector<Direction> directions_;  ///< per raster pixel; NaN where the lens images nothing
  std::vector<float> stretch_;         ///< r(theta) / sin(theta) over equal steps of cos(theta)
  float cos_min_, steps_per_cos_;
  std::vector<std::uint64_t> row_;
  std::vector<Picture> phases_;  ///< empty until first shown
};

/// The flat (rectilinear) picture a synthetic fish-eye is made of.
struct Warp {
  LensModel lens;       ///< the fish-eye, in raster pixels
  double flat_fov_deg;  ///< horizontal angle of the flat video, below 178
};

/// Frames of a 25 Hz video: fields 2n and 2n+1 show frame n, repeating from the start after the
/// last. Frames of another size are stretched to the raster; with a warp they are the scene of a
/// synthetic fish-eye. Bilinear: a strong reduction should be done before.
class VideoSource : public StampedSource {
 public:
  /// @throws UserError for no frames, or frames of different sizes
  VideoSource(std::vector<RgbImage> frames, const Raster& raster, std::optional<Warp> warp = {});

 protected:
  const Picture& view(std::uint64_t k) override;

 private:
  std::vector<RgbImage> frames_;
  std::vector<std::pair<float, float>> positions_;  ///< empty: frames have the raster's size
  std::vector<std::uint64_t> row_;
  std::optional<SampledImage> sampled_;  ///< the frame being drawn
  Picture current_;
  std::optional<std::size_t> current_index_;
};

/// A pattern in which nearly every byte differs from its neighbours in place and time: a wrong
/// address, row or field is a wrong byte. Levels within BT.601, never 0 or 255.
class ChartSource : public StampedSource {
 public:
  explicit ChartSource(const Raster& raster);
  /// The bytes Cb Y0 Cr Y1 of pixels x, x + 1 (x even) in row y of field k, without marks.
  static std::array<std::uint8_t, 4> pair(unsigned x, unsigned y, std::uint64_t k);

 protected:
  const Picture& view(std::uint64_t k) override;

 private:
  Picture current_;
};

}  // namespace fovea::video
