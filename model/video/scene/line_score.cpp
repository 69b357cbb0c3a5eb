#include "model/video/scene/line_score.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "model/common/check.h"
#include "model/video/scene/picture_quality.h"

namespace fovea::video {
namespace {

/// A pair of pixels moves as a whole, so that a line may have dark pixels within: so many are bridged.
constexpr int kBridged = 2;
constexpr int kStep = 4;        ///< pixels by which a line may be beside its continuation
constexpr int kLost = 4;        ///< rows after which a line that is not seen has ended; more would bridge corners
constexpr std::size_t kSlopeRows = 16;  ///< of which the direction of a line is taken
constexpr unsigned kFewest = 8; ///< points of a line that is counted

/// Luma of a grey of RGB.
double chart_luma(double grey) {
  const auto level = static_cast<std::uint8_t>(grey);
  return to_ycbcr(level, level, level).y;
}

int to_pixel(double position) { return static_cast<int>(std::lround(position)); }

/// The luma of a picture, with lines that run along rows turned so that they run down columns.
class Sheet {
 public:
  Sheet(const Picture& picture, bool turned) : picture_(picture), turned_(turned) {}
  int length() const { return static_cast<int>(turned_ ? picture_.width : picture_.height); }
  int breadth() const { return static_cast<int>(turned_ ? picture_.height : picture_.width); }
  /// Luma above the wall, as part of the lines' own.
  double brightness(int along, int across) const {
    const auto u = static_cast<unsigned>(turned_ ? along : across), v = static_cast<unsigned>(turned_ ? across : along);
    static const double dark = chart_luma(kChartDark), bright = chart_luma(kChartBright);
    return (picture_.row(v)[2 * u + 1] - dark) / (bright - dark);
  }
  bool bright(int along, int across) const {
    return across >= 0 && across < breadth() && brightness(along, across) > 0.3;
  }

 private:
  const Picture& picture_;
  bool turned_;
};

struct LinePoint {
  double along, across;
};

/// Follows lines in one direction of a picture.
class Follower {
 public:
  /// @param widest a wider bright piece is not a line that runs in this direction
  Follower(const Sheet& sheet, int widest) : sheet_(sheet), widest_(widest) {}

  /// A piece of bright pixels that contains one.
  struct Piece {
    int first, last;
  };
  Piece piece_at(int along, int across) const {
    Piece p{across, across};
    for (int c = across - 1; c >= p.first - kBridged - 1; --c)
      if (sheet_.bright(along, c)) p.first = c;
    for (int c = across + 1; c <= p.last + kBridged + 1; ++c)
      if (sheet_.bright(along, c)) p.last = c;
    return p;
  }

  /// The centre of brightness of the line there; nothing for what is no line, or not all of one.
  std::optional<double> centre(int along, const Piece& p) const {
    if (p.last - p.first >= widest_ || p.first < 2 || p.last > sheet_.breadth() - 3) return std::nullopt;
    double weight = 0, moment = 0;
    for (int i = p.first - 1; i <= p.last + 1; ++i) {
      const double b = std::max(sheet_.brightness(along, i), 0.0);
      weight += b;
      moment += b * i;
    }
    return moment / weight;
  }

  /// Lines met in row `along` from `across` outwards.
  std::vector<double> met(int along, int across, int outwards) const {
    std::vector<double> out;
    for (int c = across; c >= 0 && c < sheet_.breadth(); c += outwards) {
      if (!sheet_.bright(along, c)) continue;
      const Piece p = piece_at(along, c);
      if (const auto at = centre(along, p)) out.push_back(*at);
      c = outwards > 0 ? p.last : p.first;
    }
    return out;
  }

  /// The points of the line that is at `across` in row `along`; none if they are too few.
  std::vector<LinePoint> line(int along, double across) const {
    std::vector<LinePoint> points{{static_cast<double>(along), across}};
    follow(points, 1);
    std::reverse(points.begin(), points.end());
    follow(points, -1);
    if (points.size() < kFewest) points.clear();
    return points;
  }

 private:
  /// Goes on from the last point, with the direction that the points from there on have.
  void follow(std::vector<LinePoint>& points, int direction) const {
    const std::size_t begin = points.size() - 1;
    int last = static_cast<int>(points.back().along);
    for (int along = last + direction; along >= 0 && along < sheet_.length(); along += direction) {
      if (std::abs(along - last) > kLost) return;
      const LinePoint& newest = points.back();
      const LinePoint& before = points[std::max(begin, points.size() - std::min(points.size(), kSlopeRows))];
      const double rows = newest.along - before.along;
      const double slope = std::abs(rows) >= kSlopeRows / 2.0 ? (newest.across - before.across) / rows : 0;
      if (const auto at = near(along, newest.across + slope * (along - newest.along))) {
        points.push_back({static_cast<double>(along), *at});
        last = along;
      }
    }
  }
  std::optional<double> near(int along, double across) const {
    const int middle = to_pixel(across);
    for (int d = 0; d <= kStep; ++d)
      for (const int c : {middle - d, middle + d})
        if (sheet_.bright(along, c)) return centre(along, piece_at(along, c));
    return std::nullopt;
  }

  const Sheet& sheet_;
  int widest_;
};

/// Sum of the squared distances of points from the straight line that fits them best: the smaller eigenvalue of their
/// moments of second order.
double squared_distances(const std::vector<LinePoint>& points) {
  const double n = static_cast<double>(points.size());
  double a = 0, c = 0, aa = 0, cc = 0, ac = 0;
  for (const LinePoint& p : points) a += p.along / n, c += p.across / n;
  for (const LinePoint& p : points) {
    aa += (p.along - a) * (p.along - a);
    cc += (p.across - c) * (p.across - c);
    ac += (p.along - a) * (p.across - c);
  }
  return std::max(0.0, (aa + cc) / 2 - std::hypot((aa - cc) / 2, ac));
}

/// Places of one side of square n in a view: along, from the axis at `along0` with `focal_along` pixels for the wall's
/// unit; nothing if the line across is not wholly inside.
unsigned places_of(unsigned n, double along0, double focal_along, int length, double across, double half_width,
                   int breadth) {
  if (across - half_width < 2 || across + half_width > breadth - 3) return 0;
  const double half = chart_half_side(n) * focal_along;
  const double first = std::max(0.0, std::ceil(along0 - half));
  const double last = std::min(length - 1.0, std::floor(along0 + half));
  return last >= first ? static_cast<unsigned>(last - first) + 1 : 0;
}

}  // namespace

bool LineScore::can_score(const PinholeView& view) {
  return std::abs(view.shift_x) < (view.width - 1) / 2.0 && std::abs(view.shift_y) < (view.height - 1) / 2.0;
}

LineScore::LineScore(const PinholeView& view) : view_(view), ideal_(line_chart_view(view)) {
  if (!can_score(view)) throw UserError("the optical axis is not in the view whose lines are to be scored");
}

LineScore::Result LineScore::operator()(const Picture& shown) const {
  if (shown.width != view_.width || shown.height != view_.height)
    throw UserError("the view of the line chart has another size than the picture that is compared with it");
  Result out;
  out.psnr_y = psnr_y(shown, ideal_);
  out.ssim_y = ssim_y(shown, ideal_);
  double sum = 0;
  for (const bool turned : {false, true}) {
    const Sheet sheet(shown, turned);
    const double middle[] = {(view_.width - 1) / 2.0 - view_.shift_x, (view_.height - 1) / 2.0 - view_.shift_y};
    const double focal[] = {view_.focal, view_.focal * view_.aspect};
    const double along0 = middle[!turned], across0 = middle[turned];
    const double half_width = kChartLine * focal[turned] / 2 + 1;
    const Follower follower(sheet, static_cast<int>(4 * half_width) + 4);
    for (const int side : {-1, 1}) {
      const auto met = follower.met(to_pixel(along0), to_pixel(across0), side);
      for (unsigned n = 1; n <= kChartSquares; ++n) {
        const double across = across0 + side * (n * kChartPitch * focal[turned]);
        const unsigned expected =
            places_of(n, along0, focal[!turned], sheet.length(), across, half_width, sheet.breadth());
        std::vector<LinePoint> points;
        if (n <= met.size()) points = follower.line(to_pixel(along0), met[n - 1]);
        const auto found = static_cast<unsigned>(points.size());
        if (found) sum += squared_distances(points);
        out.places += found;
        out.missed += expected - std::min(expected, found);
      }
    }
  }
  out.straightness = out.places ? std::sqrt(sum / out.places) : 0;
  return out;
}

}  // namespace fovea::video
