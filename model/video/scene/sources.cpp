#include "model/video/scene/sources.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "model/common/check.h"

namespace fovea::video {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr std::size_t kStretchSteps = 4096;
/// r(theta) / sin(theta) has a pole at 180 degrees.
constexpr double kSphereLimit = 170 * kDegree;

Point middle(const Raster& raster) { return {(raster.width - 1) / 2.0, (raster.height - 1) / 2.0}; }

/// The lens of `still` in raster pixels. @throws UserError if the still is empty
LensModel stretched(const LensModel& lens, const RgbImage& still, const Raster& raster) {
  if (still.width == 0 || still.height == 0)
    throw UserError("camera.file: the still is empty: it needs at least 1x1 pixels");
  return lens.scaled(raster.width / static_cast<double>(still.width),
                     raster.height / static_cast<double>(still.height));
}

}  // namespace

StampedSource::StampedSource(const Raster& raster, const Point& centre) : raster_(raster) {
  if (raster.width == 0 || raster.height == 0 || raster.width % 2 != 0)
    throw UserError("camera raster " + std::to_string(raster.width) + "x" +
                    std::to_string(raster.height) + ": width must be even, both above 0");
  if (raster.stamped) layout_ = StampLayout::at(raster.width, raster.height, centre.x, centre.y);
}

const Picture& StampedSource::field(std::uint64_t k) {
  if (!layout_) return view(k);
  if (out_field_ != k) {
    out_ = view(k);
    stamp(out_, *layout_, k, raster_.camera);
    out_field_ = k;
  }
  return out_;
}

SphereSource::SphereSource(const RgbImage& still, const LensModel& lens, const Raster& raster,
                           const Motion& motion)
    : StampedSource(raster, stretched(lens, still, raster).project({0, 0, 1})),
      still_(still),
      lens_(lens),
      raster_lens_(stretched(lens, still, raster)),
      motion_(motion),
      row_(raster.width) {
  FOVEA_CHECK(motion.period_fields > 0, "the motion's period is one field at least");
  constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();
  directions_.resize(std::size_t{raster.width} * raster.height, {kNowhere, kNowhere, kNowhere});
  for (unsigned y = 0; y < raster.height; ++y)
    for (unsigned x = 0; x < raster.width; ++x) {
      Ray ray;
      if (raster_lens_.unproject({static_cast<double>(x), static_cast<double>(y)}, ray))
        directions_[std::size_t{y} * raster.width + x] = {
            static_cast<float>(ray.x), static_cast<float>(ray.y), static_cast<float>(ray.z)};
    }

  const double theta_max = std::min(lens_.theta_max(), kSphereLimit);
  const double cos_min = std::cos(theta_max);
  stretch_.resize(kStretchSteps + 2);
  for (std::size_t i = 0; i < stretch_.size(); ++i) {
    const double cosine = std::min(1.0, cos_min + (1 - cos_min) * i / kStretchSteps);
    const double theta = std::acos(cosine);
    stretch_[i] = static_cast<float>(theta > 1e-9 ? lens_.radius(theta) / std::sin(theta) : 1.0);
  }
  cos_min_ = static_cast<float>(cos_min);
  steps_per_cos_ = static_cast<float>(kStretchSteps / (1 - cos_min));
  if (motion_.amplitude_deg == 0) motion_.period_fields = 1;
  phases_.resize(motion_.period_fields);
}

const Picture& SphereSource::view(std::uint64_t k) {
  const auto phase = static_cast<unsigned>(k % motion_.period_fields);
  Picture& picture = phases_[phase];
  if (picture.uyvy.empty()) {
    const double turn = 2 * kPi * phase / motion_.period_fields;
    const double amplitude = motion_.amplitude_deg * kDegree;
    picture = Picture(width(), height());
    render(amplitude * std::sin(turn), amplitude / 2 * std::sin(2 * turn), picture);
  }
  return picture;
}

void SphereSource::render(double yaw, double pitch, Picture& picture) {
  // Rotation about the x axis (pitch), then about the y axis (yaw).
  const auto cy = static_cast<float>(std::cos(yaw)), sy = static_cast<float>(std::sin(yaw));
  const auto cp = static_cast<float>(std::cos(pitch)), sp = static_cast<float>(std::sin(pitch));
  const auto fx = static_cast<float>(lens_.fx()), fy = static_cast<float>(lens_.fy());
  const auto x0 = static_cast<float>(lens_.cx()), y0 = static_cast<float>(lens_.cy());
  const Direction* d = directions_.data();
  for (unsigned y = 0; y < height(); ++y) {
    for (unsigned x = 0; x < width(); ++x, ++d) {
      const float py = cp * d->y - sp * d->z;
      const float pz = sp * d->y + cp * d->z;
      const float rx = cy * d->x + sy * pz;
      const float rz = cy * pz - sy * d->x;
      // Also true for NaN: directions that the lens does not image.
      const float step = (rz - cos_min_) * steps_per_cos_;
      if (!(step >= 0)) {
        row_[x] = SampledImage::kBlackLanes;
        continue;
      }
      const auto index = std::min<std::size_t>(static_cast<std::size_t>(step), kStretchSteps);
      const float part = step - static_cast<float>(index);
      const float stretch = stretch_[index] + part * (stretch_[index + 1] - stretch_[index]);
      row_[x] = still_.sample(x0 + fx * stretch * rx, y0 + fy * stretch * py);
    }
    pack_row(row_.data(), width(), picture.row(y));
  }
}

VideoSource::VideoSource(std::vector<RgbImage> frames, const Raster& raster,
                         std::optional<Warp> warp)
    : StampedSource(raster, warp ? Point{warp->lens.cx(), warp->lens.cy()} : middle(raster)),
      frames_(std::move(frames)),
      row_(raster.width),
      current_(raster.width, raster.height) {
  if (frames_.empty()) throw UserError("camera.file: the video has no frames");
  const unsigned w = frames_[0].width, h = frames_[0].height;
  for (std::size_t i = 0; i < frames_.size(); ++i)
    if (frames_[i].width != w || frames_[i].height != h)
      throw UserError("camera.file: frame " + std::to_string(i) + " is " +
                      std::to_string(frames_[i].width) + "x" + std::to_string(frames_[i].height) +
                      ", the first one " + std::to_string(w) + "x" + std::to_string(h) +
                      "; all must have one size");
  if (!warp && w == raster.width && h == raster.height) return;

  constexpr float kOutside = -1e6f;
  const double flat_focal = warp ? w / 2.0 / std::tan(warp->flat_fov_deg / 2 * kDegree) : 0;
  positions_.reserve(std::size_t{raster.width} * raster.height);
  for (unsigned y = 0; y < raster.height; ++y)
    for (unsigned x = 0; x < raster.width; ++x) {
      if (!warp) {
        positions_.emplace_back((x + 0.5) * w / raster.width - 0.5,
                                (y + 0.5) * h / raster.height - 0.5);
        continue;
      }
      Ray ray;
      const bool seen =
          warp->lens.unproject({static_cast<double>(x), static_cast<double>(y)}, ray) &&
          ray.z > 1e-3;
      if (seen)
        positions_.emplace_back((w - 1) / 2.0 + flat_focal * ray.x / ray.z,
                                (h - 1) / 2.0 + flat_focal * ray.y / ray.z);
      else
        positions_.emplace_back(kOutside, kOutside);
    }
}

const Picture& VideoSource::view(std::uint64_t k) {
  const std::size_t index = k / 2 % frames_.size();
  if (current_index_ == index) return current_;
  current_index_ = index;
  if (positions_.empty()) {
    current_ = to_picture(frames_[index]);
    return current_;
  }
  if (sampled_)
    sampled_->assign(frames_[index]);
  else
    sampled_.emplace(frames_[index]);
  const SampledImage& frame = *sampled_;
  const std::pair<float, float>* p = positions_.data();
  for (unsigned y = 0; y < height(); ++y) {
    for (unsigned x = 0; x < width(); ++x, ++p) row_[x] = frame.sample(p->first, p->second);
    pack_row(row_.data(), width(), current_.row(y));
  }
  return current_;
}

ChartSource::ChartSource(const Raster& raster)
    : StampedSource(raster, middle(raster)), current_(raster.width, raster.height) {}

std::array<std::uint8_t, 4> ChartSource::pair(unsigned x, unsigned y, std::uint64_t k) {
  // An integer hash (Murmur3's finaliser): neighbouring positions get unrelated words.
  std::uint64_t h = k * 0x9e37'79b9'7f4a'7c15 + (std::uint64_t{y} << 32 | x);
  h = (h ^ h >> 33) * 0xff51'afd7'ed55'8ccd;
  h = (h ^ h >> 33) * 0xc4ce'b9fe'1a85'ec53;
  h ^= h >> 33;
  const auto luma = [](unsigned v) { return static_cast<std::uint8_t>(16 + v * 220 / 65536); };
  const auto chroma = [](unsigned v) { return static_cast<std::uint8_t>(16 + v * 225 / 65536); };
  return {chroma(h & 0xffff), luma(h >> 16 & 0xffff), chroma(h >> 32 & 0xffff), luma(h >> 48)};
}

const Picture& ChartSource::view(std::uint64_t k) {
  k += camera() * kCameraFields;
  for (unsigned y = 0; y < height(); ++y) {
    std::uint8_t* out = current_.row(y);
    for (unsigned x = 0; x < width(); x += 2, out += 4) {
      const auto bytes = pair(x, y, k);
      std::copy(bytes.begin(), bytes.end(), out);
    }
  }
  return current_;
}

}  // namespace fovea::video
