#include "tb/oracle/lens_oracle.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace fovea::oracle {
namespace {

const double kPi = std::acos(-1.0);
constexpr double kFarAway = 1e9;

unsigned from_width(const Geometry& g) { return g.source_width ? g.source_width : g.width; }
unsigned from_height(const Geometry& g) { return g.source_height ? g.source_height : g.height; }

/// The pair column of a position: nearest pixel, bit 0 cleared, halved; pairs change at 2m - 0.5.
/// Method B wants the aligned pair whose centre 2m + 0.5 is nearest: the same rounding.
double pair_of(double x) { return std::floor((x + 0.5) / 2); }
double row_of(double y) { return std::floor(y + 0.5); }

bool is_inside(const Geometry& g, const Position& p) {
  return p.x >= -0.5 && p.x < from_width(g) - 0.5 && p.y >= -0.5 && p.y < from_height(g) - 0.5;
}

std::uint32_t black_entry(const Geometry& g) { return from_height(g) * g.pitch_bytes; }

std::uint32_t entry_at(const Geometry& g, const Position& p) {
  if (!is_inside(g, p)) return black_entry(g);
  return static_cast<std::uint32_t>(row_of(p.y)) * g.pitch_bytes +
         static_cast<std::uint32_t>(pair_of(p.x)) * 4;
}

/// Distance from v to the nearest of `offset + n * step`.
double to_grid(double v, double step, double offset) {
  const double part = (v - offset) / step;
  return std::abs(part - std::round(part)) * step;
}

/// How far p is from the rectangle of the picture; only for p outside.
double to_picture(const Geometry& g, const Position& p) {
  const double x = std::max({-0.5 - p.x, p.x - (from_width(g) - 0.5), 0.0});
  const double y = std::max({-0.5 - p.y, p.y - (from_height(g) - 0.5), 0.0});
  return std::max(x, y);
}

/// R(theta), continued beyond theta_max.
double radius_continued(const Geometry& g, double theta) {
  const double f = lens_focal(g);
  switch (g.mapping) {
    case Mapping::kNone:
    case Mapping::kRectilinear:
      return f * std::tan(theta);
    case Mapping::kLinear:
      return f * theta;
    case Mapping::kOrthographic:
      return f * std::sin(theta);
    case Mapping::kEquisolid:
      return 2 * f * std::sin(theta / 2);
    case Mapping::kStereographic:
      return 2 * f * std::tan(theta / 2);
    case Mapping::kKannalaBrandt: {
      const double t2 = theta * theta;
      return f * theta * (1 + t2 * (g.k[0] + t2 * (g.k[1] + t2 * (g.k[2] + t2 * g.k[3]))));
    }
    case Mapping::kTable:
      break;
  }
  const double at = theta / g.theta_max * static_cast<double>(g.table_r.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), g.table_r.size() - 2);
  const double part = at - static_cast<double>(i);
  return g.table_r[i] * (1 - part) + g.table_r[i + 1] * part;
}

/// A source position, continued beyond theta_max, and how many pixels the direction is within it.
struct Traced {
  Position at;
  double reach = kFarAway;  ///< negative: invisible
};

Traced trace(const Geometry& g, double u, double v) {
  const double from_x = (from_width(g) - 1) / 2.0, from_y = (from_height(g) - 1) / 2.0;
  const double mid_x = (g.width - 1) / 2.0, mid_y = (g.height - 1) / 2.0;
  if (g.mapping == Mapping::kNone) return {{u - mid_x + from_x + g.shift_x, v - mid_y + from_y + g.shift_y}};
  const double focal = output_focal(g);
  const double x = (u - mid_x + g.shift_x) / focal;
  const double y = (v - mid_y + g.shift_y) / (focal * g.out_aspect);
  const double r = std::hypot(x, y);
  if (r == 0) return {{from_x + g.centre_x, from_y + g.centre_y}};
  const double theta = std::atan(r);
  const double radius = radius_continued(g, theta);
  Traced t{
      {from_x + g.centre_x + radius * x / r, from_y + g.centre_y + g.in_aspect * radius * y / r}};
  if (g.theta_max > 0) t.reach = radius_continued(g, g.theta_max) - radius;
  return t;
}

Traced trace_pair(const Geometry& g, unsigned pair, unsigned row) {
  return trace(g, 2.0 * pair + (g.method == PairMethod::kPairCentre ? 0.5 : 0.0), row);
}

/// True if a position within the tolerance of `t` has this entry.
bool is_tolerable(const Geometry& g, const Traced& t, std::uint32_t entry, double tolerance) {
  if (t.reach < tolerance && entry == black_entry(g)) return true;
  if (t.reach < -tolerance) return false;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (entry == entry_at(g, {t.at.x + dx * tolerance, t.at.y + dy * tolerance})) return true;
  return false;
}

}  // namespace

double lens_focal(const Geometry& g) {
  if (g.focal_px > 0) return g.focal_px;
  const double fov = g.fov_deg * kPi / 180;
  const double w = from_width(g);
  switch (g.mapping) {
    case Mapping::kNone:
      return 1;
    case Mapping::kRectilinear:
      return w / (2 * std::tan(fov / 2));
    case Mapping::kLinear:
      return w / fov;
    case Mapping::kOrthographic:
      return w / (2 * std::sin(fov / 2));
    case Mapping::kEquisolid:
      return g.paper_literal_focal ? w / (4 * std::sin(fov / 2)) : w / (4 * std::sin(fov / 4));
    case Mapping::kStereographic:
      return w / (4 * std::tan(fov / 4));
    case Mapping::kKannalaBrandt:
      throw std::invalid_argument("a Kannala-Brandt lens needs its focal length in pixels");
    case Mapping::kTable:
      break;
  }
  // The slope of the table at the axis.
  if (g.table_r.size() < 2 || !(g.theta_max > 0))
    throw std::invalid_argument("a table lens needs at least two radii and theta_max");
  return (g.table_r[1] - g.table_r[0]) * static_cast<double>(g.table_r.size() - 1) / g.theta_max;
}

double output_focal(const Geometry& g) {
  return g.out_focal_px > 0 ? g.out_focal_px : lens_focal(g);
}

std::optional<double> lens_radius(const Geometry& g, double theta) {
  if (g.theta_max > 0 && theta > g.theta_max) return std::nullopt;
  return radius_continued(g, theta);
}

Position source_position(const Geometry& g, double u, double v) {
  const Traced t = trace(g, u, v);
  return t.reach < 0 ? Position{kFarAway, kFarAway} : t.at;
}

Expected expected_entry(const Geometry& g, unsigned pair, unsigned row) {
  const Traced t = trace_pair(g, pair, row);
  const bool in_picture = is_inside(g, t.at);
  Expected e;
  e.exact = t.at;
  e.inside = in_picture && t.reach >= 0;
  e.entry = e.inside ? entry_at(g, t.at) : black_entry(g);
  if (e.inside)
    e.margin = std::min({to_grid(t.at.x, 2, -0.5), to_grid(t.at.y, 1, -0.5), t.reach});
  else
    e.margin = std::max(in_picture ? 0.0 : to_picture(g, t.at), -t.reach);
  return e;
}

std::string WrongEntry::text() const {
  char line[200];
  std::snprintf(
      line, sizeof line,
      "entry of output pixels %u,%u in row %u: expected %u (source %.4f, %.4f; %.4f px from "
      "the boundary), got %u",
      pair * 2, pair * 2 + 1, row, expected.entry, expected.exact.x, expected.exact.y,
      expected.margin, got);
  return line;
}

LutCheck check_lut(std::span<const std::uint32_t> lut, const Geometry& g, double tolerance_px) {
  LutCheck check;
  const std::size_t per_row = g.width / 2;
  check.entries = per_row * g.height;
  const std::size_t count = std::min(check.entries, lut.size());
  for (std::size_t i = 0; i < count; ++i) {
    const auto pair = static_cast<unsigned>(i % per_row);
    const auto row = static_cast<unsigned>(i / per_row);
    const Expected e = expected_entry(g, pair, row);
    if (e.margin <= tolerance_px) ++check.at_risk;
    if (lut[i] == e.entry) continue;
    if (is_tolerable(g, trace_pair(g, pair, row), lut[i], tolerance_px)) {
      ++check.near_boundary;
      continue;
    }
    if (check.wrong++ == 0) check.first_wrong = WrongEntry{pair, row, lut[i], e};
  }
  check.wrong += std::max(check.entries, lut.size()) - count;
  return check;
}

std::vector<std::uint32_t> build_lut(const Geometry& g) {
  std::vector<std::uint32_t> lut;
  lut.reserve(std::size_t{g.width} / 2 * g.height);
  for (unsigned row = 0; row < g.height; ++row)
    for (unsigned pair = 0; pair < g.width / 2; ++pair)
      lut.push_back(expected_entry(g, pair, row).entry);
  return lut;
}

}  // namespace fovea::oracle
