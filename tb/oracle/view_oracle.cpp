#include "tb/oracle/view_oracle.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fovea::oracle {
namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

double radians(double degrees) { return degrees * std::acos(-1.0) / 180; }

Vector times(const Matrix& m, const Vector& v) {
  Vector out{};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) out[i] += m[i][k] * v[k];
  return out;
}

/// The direction of a ground point in the axes right, down, forward of the camera: ground axes (forward, left, up)
/// are turned by yaw about up, then renamed, then pitched about right, then rolled about forward.
Vector seen_from(const CarCamera& c, double x, double y) {
  const double yaw = radians(c.yaw), pitch = radians(c.pitch), roll = radians(c.roll);
  const Vector level = times({{{std::cos(yaw), std::sin(yaw), 0}, {-std::sin(yaw), std::cos(yaw), 0}, {0, 0, 1}}},
                             {x - c.x, y - c.y, -c.height});
  const Vector named{-level[1], -level[2], level[0]};
  const Vector pitched = times(
      {{{1, 0, 0}, {0, std::cos(pitch), -std::sin(pitch)}, {0, std::sin(pitch), std::cos(pitch)}}}, named);
  return times({{{std::cos(roll), std::sin(roll), 0}, {-std::sin(roll), std::cos(roll), 0}, {0, 0, 1}}}, pitched);
}

int birds_eye_camera(const Views& w, double u, double v) {
  const Geometry& g = w.lens[0];
  // Outside the car, in pixels: beyond its sides, beyond its ends.
  const double beside = std::abs(u - (g.width - 1) / 2.0) - w.car_width / w.ground_width * g.width / 2;
  const double beyond = std::abs(v - (g.height - 1) / 2.0) - w.car_length / w.ground_height * g.height / 2;
  const bool in_front = v < (g.height - 1) / 2.0, to_the_left = u < (g.width - 1) / 2.0;
  if (beside <= 0 && beyond < 0) return -1;
  if (beyond >= 0 && beyond >= beside) return in_front ? 0 : 2;
  return to_the_left ? 3 : 1;
}

std::uint32_t black_of(const Geometry& g) { return g.height * g.pitch_bytes; }

/// Entry of a position, which may be outside the picture.
std::uint32_t entry_of(const Views& w, int camera, const Position& p) {
  const Geometry& g = w.lens[static_cast<std::size_t>(camera)];
  double column = std::floor(p.x + 0.5), row = std::floor(p.y + 0.5);
  if (!(column >= 0 && row >= 0 && column < g.width && row < g.height)) return black_of(g);
  if (w.quad) {
    column = std::floor(column / 2) + (camera % 2) * (g.width / 2);
    row = std::floor(row / 2) + (camera / 2) * (g.height / 2);
  }
  return static_cast<std::uint32_t>(row) * g.pitch_bytes + static_cast<std::uint32_t>(column / 2) * 4;
}

double first_of(const Geometry& g) { return g.method == PairMethod::kPairCentre ? 0.5 : 0; }

bool is_right(const Views& w, const Shown& s, std::uint32_t entry, double tolerance) {
  const std::uint32_t black = black_of(w.lens[0]);
  if (s.camera < 0) return entry == black;
  if (!s.ahead) return entry == black;
  const Geometry& g = w.lens[static_cast<std::size_t>(s.camera)];
  if (std::abs(s.at.x) > 1e8) return entry == black;  // beyond theta_max
  for (const double dy : {-tolerance, 0.0, tolerance})
    for (const double dx : {-tolerance, 0.0, tolerance})
      if (entry == entry_of(w, s.camera, {s.at.x + dx, s.at.y + dy})) return true;
  // On the rim of the image circle, either is right.
  if (g.theta_max > 0 && entry == black) {
    const auto rim = lens_radius(g, g.theta_max);
    const double x = s.at.x - (g.width - 1) / 2.0 - g.centre_x, y = s.at.y - (g.height - 1) / 2.0 - g.centre_y;
    return rim && std::abs(std::hypot(x, y / g.in_aspect) - *rim) < tolerance;
  }
  return false;
}

}  // namespace

Shown shown_at(const Views& w, double u, double v) {
  const Geometry& first = w.lens[0];
  Shown out;
  if (!w.birds_eye) {
    const bool right = u >= first.width / 2, below = v >= first.height / 2;
    out.camera = right + 2 * below;
    const Geometry& g = w.lens[static_cast<std::size_t>(out.camera)];
    // A pixel of the half picture covers two pixels of the whole one, in both directions.
    out.at = source_position(g, 2 * (u - right * (first.width / 2)) + 0.5, 2 * (v - below * (first.height / 2)) + 0.5);
    return out;
  }
  out.camera = birds_eye_camera(w, u, v);
  if (out.camera < 0) return out;
  const Geometry& g = w.lens[static_cast<std::size_t>(out.camera)];
  const double x = ((g.height - 1) / 2.0 - v) * w.ground_height / g.height;
  const double y = ((g.width - 1) / 2.0 - u) * w.ground_width / g.width;
  const Vector ray = seen_from(w.mount[static_cast<std::size_t>(out.camera)], x, y);
  const double across = std::hypot(ray[0], ray[1]);
  out.ahead = ray[2] > 1e-6 * across;
  const auto radius = lens_radius(g, std::atan2(across, ray[2]));
  if (!radius) {
    out.at = {1e9, 1e9};
    return out;
  }
  const double scale = across > 0 ? *radius / across : 0;
  out.at = {(g.width - 1) / 2.0 + g.centre_x + scale * ray[0],
            (g.height - 1) / 2.0 + g.centre_y + g.in_aspect * scale * ray[1]};
  return out;
}

LutCheck check_view(std::span<const std::uint32_t> lut, const Views& w, double tolerance_px, double seam_px) {
  const Geometry& g = w.lens[0];
  LutCheck check;
  const std::size_t per_row = g.width / 2;
  check.entries = per_row * g.height;
  const std::size_t count = std::min(check.entries, lut.size());
  for (std::size_t i = 0; i < count; ++i) {
    const auto pair = static_cast<unsigned>(i % per_row), row = static_cast<unsigned>(i / per_row);
    const double u = 2.0 * pair + first_of(g);
    const Shown s = shown_at(w, u, row);
    const bool exact = s.camera < 0 || !s.ahead ? lut[i] == black_of(g) : lut[i] == entry_of(w, s.camera, s.at);
    if (exact) continue;
    bool right = is_right(w, s, lut[i], tolerance_px);
    for (const double du : {-seam_px, seam_px})
      right = right || (w.birds_eye && is_right(w, shown_at(w, u + du, row), lut[i], tolerance_px));
    if (right) {
      ++check.near_boundary;
      continue;
    }
    if (check.wrong++ == 0) {
      Expected e;
      e.exact = s.at;
      e.entry = s.camera < 0 ? black_of(g) : entry_of(w, s.camera, s.at);
      check.first_wrong = WrongEntry{pair, row, lut[i], e};
    }
  }
  check.wrong += std::max(check.entries, lut.size()) - count;
  return check;
}

std::vector<int> cameras_of(const Views& w) {
  const Geometry& g = w.lens[0];
  std::vector<int> out;
  for (unsigned row = 0; row < g.height; ++row)
    for (unsigned pair = 0; pair < g.width / 2; ++pair)
      out.push_back(shown_at(w, 2.0 * pair + first_of(g), row).camera);
  return out;
}

Frame compose(const std::array<const Frame*, 4>& frames, std::span<const std::uint32_t> lut,
              std::span<const int> cameras, std::uint32_t pitch_bytes) {
  const auto any = std::find_if(frames.begin(), frames.end(), [](const Frame* f) { return f != nullptr; });
  if (any == frames.end()) throw std::invalid_argument("no frame to compose");
  const unsigned width = (*any)->width, height = (*any)->height;
  if (lut.size() != std::size_t{width} / 2 * height || cameras.size() != lut.size())
    throw std::invalid_argument("the table is not of the frames' size");
  Frame out{width, height, {}};
  for (std::size_t i = 0; i < lut.size(); ++i) {
    const Frame* in = cameras[i] < 0 ? nullptr : frames[static_cast<std::size_t>(cameras[i])];
    if (!in || lut[i] == height * pitch_bytes) {
      out.uyvy.insert(out.uyvy.end(), {128, 16, 128, 16});
      continue;
    }
    const std::size_t row = lut[i] / pitch_bytes, byte = lut[i] % pitch_bytes;
    if (byte % 4 != 0 || row >= height || byte + 4 > std::size_t{width} * 2)
      throw std::invalid_argument("entry " + std::to_string(i) + " is outside the frame");
    const auto* from = in->uyvy.data() + row * width * 2 + byte;
    out.uyvy.insert(out.uyvy.end(), from, from + 4);
  }
  return out;
}

}  // namespace fovea::oracle
