#include "tb/rtl/lens_maps.h"

#include <algorithm>
#include <cmath>

namespace fovea::rtl {
namespace {

std::int32_t fixed(double value, unsigned bits) {
  return static_cast<std::int32_t>(std::lround(std::ldexp(value, static_cast<int>(bits))));
}

Job picture(const lens_t& lens, Mode mode) {
  Job job;
  job.mode = mode;
  job.pairs = job.src_pitch = job.dst_pitch = lens.width / 2;
  job.rows = job.src_height = lens.height;
  job.src_width = lens.width;
  job.src_base = 0x2000'0000;
  job.dst_base = 0x2010'0000;
  return job;
}

double first_pixel(const lens_t& lens) { return lens.pair_method_b ? 0.5 : 0; }

}  // namespace

MappedJob table_job(const lens_t& lens) {
  MappedJob m{picture(lens, Mode::kTable), {}};
  m.map.resize(lens_lut_entries(lens.width, lens.height));
  lens_build_lut(&lens, m.map.data(), lens.width * 2);
  return m;
}

MappedJob grid_job(const lens_t& lens, unsigned grid_log2) {
  MappedJob m{picture(lens, Mode::kGrid), {}};
  m.job.grid_log2 = grid_log2;
  m.job.a[0] = fixed(first_pixel(lens), 16);
  m.job.a[1] = 2 << 16;
  m.job.b[2] = 1 << 16;
  for (unsigned h = 0; h < grid_rows(m.job); ++h)
    for (unsigned g = 0; g < grid_nodes(m.job); ++g) {
      const double u = (g << grid_log2) + first_pixel(lens), v = h << grid_log2;
      const lens_point_t p = lens_source(&lens, u, v);
      const auto q4 = [](double offset) {
        return static_cast<std::uint32_t>(std::clamp(std::lround(offset * 16), -32768L, 32767L)) &
               0xFFFF;
      };
      m.map.push_back(q4(p.column - u) | q4(p.row - v) << 16);
    }
  return m;
}

MappedJob radial_job(const lens_t& lens) {
  MappedJob m{picture(lens, Mode::kRadial), {}};
  Job& job = m.job;
  const double f = lens.out_focal;
  const auto x = [&](double u) { return lens_output_x(&lens, u) * f; };
  const auto y = [&](double v) { return lens_output_y(&lens, v) * f; };
  const double first = first_pixel(lens);
  job.a[0] = fixed(x(first), 16);
  job.a[1] = fixed(x(first + 2) - x(first), 16);
  job.b[0] = fixed(y(0), 16);
  job.b[2] = fixed(y(1) - y(0), 16);
  job.c[0] = fixed(y(0) * lens.in_aspect, 16);
  job.c[2] = fixed((y(1) - y(0)) * lens.in_aspect, 16);
  job.centre_x = fixed(lens_output_centre(lens.width) + lens.centre_x, 16);
  job.centre_y = fixed(lens_output_centre(lens.height) + lens.centre_y, 16);
  const double farthest_x = std::max(std::abs(x(0)), std::abs(x(lens.width)));
  const double farthest_y = std::max(std::abs(y(0)), std::abs(y(lens.height)));
  const double largest = farthest_x * farthest_x + farthest_y * farthest_y + 1;
  while (std::ldexp(128, static_cast<int>(job.piece_log2)) < largest) ++job.piece_log2;
  const double width = std::ldexp(1, static_cast<int>(job.piece_log2));
  job.pieces = static_cast<unsigned>(largest / width) + 1;
  const double limit = lens.tan_limit_squared * f * f * 256;
  job.radius_limit = limit < 4294967295.0 ? static_cast<std::uint32_t>(limit) : 0xFFFFFFFF;
  const auto gain = [&](double s) { return lens_gain(&lens, s / (f * f)) / f; };
  for (unsigned n = 0; n < job.pieces; ++n) {
    const double a = gain(n * width), b = gain((n + 0.5) * width), c = gain((n + 1) * width);
    for (const double k : {a, -3 * a + 4 * b - c, 2 * a - 4 * b + 2 * c})
      m.map.push_back(static_cast<std::uint32_t>(fixed(k, 20)));
  }
  return m;
}

}  // namespace fovea::rtl
