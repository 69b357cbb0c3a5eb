#include "model/video/scene/plan_score.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "model/common/check.h"

namespace fovea::video {
namespace {

constexpr int kReach = 10;          ///< pixels to each side in which a line is looked for
constexpr double kLineLuma = 40.0;  ///< brighter than the darkest quarter around it by this: part of a line

std::uint8_t luma(const Picture& p, int u, int v) { return p.row(static_cast<unsigned>(v))[2 * u + 1]; }

/// Centre of brightness of the line near column u; nothing if there is none.
std::optional<double> line_at(const Picture& p, int u, int v) {
  double darkest = 255;
  for (int i = u - kReach; i <= u + kReach; ++i) darkest = std::min<double>(darkest, luma(p, i, v));
  double weight = 0, moment = 0;
  for (int i = u - kReach; i <= u + kReach; ++i) {
    const double excess = luma(p, i, v) - darkest - kLineLuma;
    if (excess <= 0) continue;
    weight += excess;
    moment += excess * i;
  }
  if (weight < kLineLuma) return std::nullopt;
  return moment / weight;
}

}  // namespace

PlanScore::PlanScore(const GroundPicture& ground, double car_length, double car_width)
    : ground_(ground),
      car_length_(car_length),
      car_width_(car_width),
      plan_(car_park_plan(ground.width, ground.height, ground.metres_across, ground.metres_along)),
      mask_(std::size_t{ground.width} * ground.height) {
  const double run = ground_.metres_across / ground_.width, rise = ground_.metres_along / ground_.height;
  for (unsigned v = 0; v < ground.height; ++v)
    for (unsigned u = 0; u < ground.width; ++u) {
      const double x = ((ground.height - 1) / 2.0 - v) * rise;
      // A pair may lie half within the car.
      mask_[std::size_t{v} * ground.width + u] = !in_car(x, ((ground.width - 1) / 2.0 - (u & ~1u)) * run) &&
                                                 !in_car(x, ((ground.width - 1) / 2.0 - (u | 1u)) * run);
    }
}

bool PlanScore::in_car(double x, double y) const {
  return std::abs(x) <= car_length_ / 2 && std::abs(y) <= car_width_ / 2;
}

PlanScore::Result PlanScore::operator()(const Picture& shown) const {
  if (shown.width != ground_.width || shown.height != ground_.height)
    throw UserError("the plan has another size than the picture that is compared with it");
  const double run = ground_.metres_across / ground_.width, rise = ground_.metres_along / ground_.height;
  const auto width = static_cast<int>(ground_.width), height = static_cast<int>(ground_.height);
  Result out;
  out.psnr_y = psnr_y(shown, plan_, mask_);
  out.ssim_y = ssim_y(shown, plan_, mask_);
  double error = 0;
  for (int v = 0; v < height; ++v) {
    const double x = ((height - 1) / 2.0 - v) * rise;
    if (!car_park_has_bay_lines(x)) continue;
    for (unsigned n = 0; n < kBayLines; ++n) {
      const double y = bay_line(n);
      const int u = static_cast<int>(std::lround((width - 1) / 2.0 - y / run));
      if (u < kReach || u + kReach >= width || in_car(x, y - kReach * run) || in_car(x, y + kReach * run)) continue;
      const auto expected = line_at(plan_, u, v), got = line_at(shown, u, v);
      if (!expected) continue;
      if (!got) {
        ++out.missed;
        continue;
      }
      error += (*got - *expected) * (*got - *expected);
      ++out.lines;
    }
  }
  out.line_error = out.lines ? std::sqrt(error / out.lines) : 0;
  return out;
}

}  // namespace fovea::video
