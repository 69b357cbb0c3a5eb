#include "model/video/scene/film_score.h"

#include <cmath>
#include <numbers>

namespace fovea::video {

FlatView flat_film_view(const RgbImage& frame, double fov_deg, const PinholeView& view) {
  const SampledImage film(frame);
  const double focal = frame.width / 2.0 / std::tan(fov_deg / 2 * std::numbers::pi / 180);
  FlatView out{Picture(view.width, view.height), PictureMask(std::size_t{view.width} * view.height)};
  std::vector<std::uint64_t> row(view.width);
  for (unsigned v = 0; v < view.height; ++v) {
    const double y = (v - (view.height - 1) / 2.0 + view.shift_y) / (view.focal * view.aspect);
    const double film_y = (frame.height - 1) / 2.0 + focal * y;
    for (unsigned u = 0; u < view.width; ++u) {
      const double x = (u - (view.width - 1) / 2.0 + view.shift_x) / view.focal;
      const double film_x = (frame.width - 1) / 2.0 + focal * x;
      row[u] = film.sample(static_cast<float>(film_x), static_cast<float>(film_y));
      out.seen[std::size_t{v} * view.width + u] = film_x >= -0.5 && film_x <= frame.width - 0.5 && film_y >= -0.5 &&
                                                  film_y <= frame.height - 0.5;
    }
    pack_row(row.data(), view.width, out.picture.row(v));
  }
  return out;
}

FilmScore::Result FilmScore::operator()(const Picture& shown, const RgbImage& frame) const {
  const FlatView truth = flat_film_view(frame, fov_deg_, view_);
  return {psnr_y(shown, truth.picture, truth.seen), ssim_y(shown, truth.picture, truth.seen)};
}

}  // namespace fovea::video
