#include "model/video/scene/car_park.h"

#include <cmath>

namespace fovea::video {
namespace {

constexpr SceneColour kSky{170, 190, 215};
constexpr SceneColour kWhite{225, 225, 220}, kYellow{215, 175, 40}, kBlue{45, 85, 175}, kInk{25, 25, 25};
constexpr double kLine = 0.12;   ///< width of a marked line, m
constexpr double kBay = 2.5;     ///< from one bay's line to the next, m
constexpr double kBayRear = -2.9, kBayFront = 2.7;  ///< ends of the lines, m
constexpr double kSquare = 0.4;  ///< of the chart, m
constexpr double kFar = 60;      ///< what is further away is sky, m

bool between(double v, double low, double high) { return v >= low && v < high; }

/// Whether v is on one of the lines at low, low + kBay, ...
bool on_bay_line(double v, double first, double last) {
  const double n = std::round((v - first) / kBay);
  return n >= 0 && first + n * kBay < last + 0.01 && std::abs(v - first - n * kBay) < kLine / 2;
}

/// Asphalt: grain of 5 cm, as a hash of the place.
SceneColour asphalt(double x, double y) {
  const auto cell = [](double v) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(v / 0.05)));
  };
  std::uint32_t h = cell(x) * 0x9e37'79b1u ^ cell(y) * 0x85eb'ca77u;
  h = (h ^ h >> 15) * 0x2c1b'3c6du;
  h ^= h >> 13;
  const double grey = 88 + static_cast<double>(h & 15) - 7.5;
  return {grey, grey, grey + 4};
}

}  // namespace

double bay_line(unsigned n) { return (n - (kBayLines - 1) / 2.0) * kBay; }

bool car_park_has_bay_lines(double x) { return x > kBayRear + 0.2 && x < kBayFront - 0.2; }

SceneColour car_park_colour(double x, double y) {
  // The car's own row of bays, the row across the lane, and a kerb behind.
  if (between(x, kBayRear, kBayFront) && on_bay_line(y, bay_line(0), bay_line(kBayLines - 1))) return kWhite;
  if (std::abs(x - kBayRear) < kLine / 2 && std::abs(y) < 3.5 * kBay + kLine / 2) return kWhite;
  if (between(x, 7.5, 12.5) && on_bay_line(y, -4 * kBay, 4 * kBay)) return kWhite;
  if (between(x, -4.4, -4.1)) return kYellow;
  if (between(x, -2.4, 2.2) && between(y, 1.5 * kBay + 0.4, 2.5 * kBay - 0.4)) return kBlue;
  // The chart in front, and a smaller one behind.
  if ((between(x, 3.6, 4.8) && std::abs(y) < 12 * kSquare) || (between(x, -3.7, -3.3) && std::abs(y) < 9 * kSquare)) {
    const auto squares = static_cast<long>(std::floor(x / kSquare + 1e-9) + std::floor(y / kSquare + 1e-9));
    return squares % 2 == 0 ? kWhite : kInk;
  }
  // An arrow in the lane, to the left.
  if (std::abs(x - 5.9) < 0.12 && between(y, -1, 1)) return kWhite;
  if (between(y, 1, 1.8) && std::abs(x - 5.9) < 1.8 - y - 0.3) return kWhite;
  return asphalt(x, y);
}

Picture car_park_plan(unsigned width, unsigned height, double metres_x, double metres_y) {
  return mean_picture(width, height, 4, [&](double u, double v) {
    return car_park_colour(((height - 1) / 2.0 - v) * metres_y / height, ((width - 1) / 2.0 - u) * metres_x / width);
  });
}

CarParkSource::CarParkSource(const Raster& raster, const LensModel& lens, const Mount& mount)
    : StampedSource(raster, {lens.cx(), lens.cy()}) {
  const MountAxes axes = axes_of(mount);
  picture_ = mean_picture(raster.width, raster.height, 3, [&](double u, double v) {
    Ray ray;
    Point at;
    if (!lens.unproject({u, v}, ray)) return SceneColour{};
    if (!meets_ground(mount, axes, ray, at) || std::hypot(at.x, at.y) > kFar) return kSky;
    return car_park_colour(at.x, at.y);
  });
}

}  // namespace fovea::video
