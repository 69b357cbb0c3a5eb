#include "sw/lens/lens.h"

#include <math.h>

#define PI 3.14159265358979323846
#define RADIANS(deg) ((deg) * (PI / 180.0))
#define SIDE_MAX 4096u
/* For smaller values of tan(theta) squared, R / tan(theta) is replaced by its limit, to avoid 0 / 0
 * on the axis. */
#define NEAR_AXIS 1e-18

static int positive(double x) { return x > 0.0 && x < HUGE_VAL; }

double lens_focal_from_fov(uint32_t mapping, double width, double fov_deg, int paper_literal) {
  const double fov = RADIANS(fov_deg);
  if (!positive(fov)) return 0.0;
  switch (mapping) {
    case LENS_RECTILINEAR:
      return fov_deg < 180.0 ? width / (2.0 * tan(fov / 2.0)) : 0.0;
    case LENS_LINEAR:
      return fov_deg < 360.0 ? width / fov : 0.0;
    case LENS_ORTHOGRAPHIC:
      return fov_deg <= 180.0 ? width / (2.0 * sin(fov / 2.0)) : 0.0;
    case LENS_EQUISOLID:
      if (fov_deg >= 360.0) return 0.0;
      return width / (4.0 * sin(paper_literal ? fov / 2.0 : fov / 4.0));
    case LENS_STEREOGRAPHIC:
      return fov_deg < 360.0 ? width / (4.0 * tan(fov / 4.0)) : 0.0;
    default:
      return 0.0;
  }
}

void lens_view_default(lens_view_t *view) {
  *view = (lens_view_t){
      .mapping = LENS_EQUISOLID, .fov_deg = 180.0, .in_aspect = 1.0, .out_aspect = 1.0};
}

static lens_result_t init_table(lens_t *lens, const lens_view_t *view) {
  if (view->table_count < 2 || view->table_count > PARAM_TABLE_MAX || !positive(view->theta_max))
    return LENS_BAD_TABLE;
  if (view->table_r[0] != 0.0) return LENS_BAD_TABLE;
  for (uint32_t i = 1; i < view->table_count; ++i)
    if (!(view->table_r[i] > view->table_r[i - 1]) || !positive(view->table_r[i]))
      return LENS_BAD_TABLE;
  lens->table_r = view->table_r;
  lens->table_count = view->table_count;
  lens->table_scale = (double)(view->table_count - 1) / view->theta_max;
  return LENS_OK;
}

static int good_size(lens_size_t s) {
  return s.width != 0 && s.width % 2 == 0 && s.width <= SIDE_MAX && s.height != 0 &&
         s.height <= SIDE_MAX;
}

lens_result_t lens_init(lens_t *lens, const lens_view_t *view, uint32_t width, uint32_t height) {
  const lens_size_t size = {width, height};
  return lens_init_sizes(lens, view, size, size);
}

lens_result_t lens_init_sizes(lens_t *lens, const lens_view_t *view, lens_size_t source,
                              lens_size_t result) {
  if (!good_size(source) || !good_size(result)) return LENS_BAD_SIZE;
  if (view->mapping > LENS_TABLE) return LENS_BAD_MAPPING;
  if (view->pair_method > PAIR_CENTRE) return LENS_BAD_PAIR;

  *lens = (lens_t){.mapping = view->mapping,
                   .width = result.width,
                   .height = result.height,
                   .source_width = source.width,
                   .source_height = source.height,
                   .pair_method_b = view->pair_method == PAIR_CENTRE,
                   .centre_x = view->centre_x,
                   .centre_y = view->centre_y,
                   .shift_x = view->shift_x,
                   .shift_y = view->shift_y,
                   .in_aspect = view->in_aspect,
                   .out_aspect = view->out_aspect,
                   .tan_limit_squared = HUGE_VAL};
  if (view->theta_max > 0.0 && view->theta_max < PI / 2.0)
    lens->tan_limit_squared = tan(view->theta_max) * tan(view->theta_max);

  if (view->mapping == LENS_NONE) {
    lens->focal = lens->out_focal = 1.0;
    return LENS_OK;
  }
  if (!positive(view->in_aspect) || !positive(view->out_aspect)) return LENS_BAD_FOCAL;
  if (view->mapping == LENS_TABLE) {
    const lens_result_t table = init_table(lens, view);
    if (table != LENS_OK) return table;
    lens->focal = view->focal_px != 0.0 ? view->focal_px : view->table_r[1] * lens->table_scale;
  } else if (view->focal_px != 0.0) {
    lens->focal = view->focal_px;
  } else {
    lens->focal = lens_focal_from_fov(view->mapping, (double)source.width, view->fov_deg,
                                      (view->flags & PARAM_PAPER_LITERAL_FOCAL) != 0);
    if (!positive(lens->focal)) return LENS_BAD_FOV;
  }
  lens->out_focal = view->out_focal_px != 0.0 ? view->out_focal_px : lens->focal;
  if (!positive(lens->focal) || !positive(lens->out_focal)) return LENS_BAD_FOCAL;
  lens->scale_x = 1.0 / lens->out_focal;
  lens->scale_y = 1.0 / (lens->out_focal * lens->out_aspect);
  return LENS_OK;
}

const char *lens_result_text(lens_result_t result) {
  switch (result) {
    case LENS_OK:
      return "ok";
    case LENS_BAD_SIZE:
      return "width must be even, sides 1 to 4096";
    case LENS_BAD_MAPPING:
      return "mapping must be 0 to 6";
    case LENS_BAD_PAIR:
      return "pair method must be 0 or 1";
    case LENS_BAD_FOV:
      return "field of view outside what the mapping can show";
    case LENS_BAD_FOCAL:
      return "focal lengths and aspects must be positive";
    case LENS_BAD_TABLE:
      return "table needs 2 to 129 entries rising from 0, and theta_max";
  }
  return "unknown";
}

static double table_radius(const lens_t *lens, double theta) {
  const double position = theta * lens->table_scale;
  uint32_t i = (uint32_t)position;
  if (i > lens->table_count - 2) i = lens->table_count - 2;
  return lens->table_r[i] + (lens->table_r[i + 1] - lens->table_r[i]) * (position - (double)i);
}

double lens_radius(const lens_t *lens, double theta) {
  const double f = lens->focal;
  switch (lens->mapping) {
    case LENS_RECTILINEAR:
      return f * tan(theta);
    case LENS_LINEAR:
      return f * theta;
    case LENS_ORTHOGRAPHIC:
      return f * sin(theta);
    case LENS_EQUISOLID:
      return 2.0 * f * sin(theta / 2.0);
    case LENS_STEREOGRAPHIC:
      return 2.0 * f * tan(theta / 2.0);
    case LENS_TABLE:
      return table_radius(lens, theta);
    default:
      return 0.0;
  }
}

double lens_sqrt(double x) {
  union {
    double value;
    uint64_t bits;
  } in = {x}, start = {0}, slope = {0};
  const int32_t exponent = (int32_t)(in.bits >> 52);
  if (exponent <= 0 || exponent >= 0x7FF) return sqrt(x);
  /* x = a * 4^half with 1 <= a < 4; `a` and the inverse root `y` (1/2 < y <= 1) in units of 2^-30.
   */
  const int32_t odd = (exponent - 1023) & 1;
  const int32_t half_exponent = (exponent - 1023 - odd) / 2;
  const uint64_t mantissa = (in.bits & 0xFFFFFFFFFFFFFull) | 1ull << 52;
  const uint64_t a = (mantissa << odd) >> 22;
  /* 1.0664 - a * 39 / 256 is within 9 % of the inverse root. Each iteration squares the relative
   * error (times 1.5): 0.086, 0.012, 2e-4, 6e-8, then the 2^-28 of the arithmetic. */
  uint64_t y = 1145038281u - (a * 39u >> 8);
  for (int i = 0; i < 4; ++i) {
    const uint64_t ay = a * y >> 30;
    const uint64_t residue = (3ull << 30) - (ay * y >> 30);
    y = y * residue >> 31;
  }
  const uint64_t root = a * y >> 30; /* 1 <= root < 2, or slightly below 1 for a = 1 */
  /* One more step in double precision: root + (x - root^2) * y / 2, with an error of about 2^-53.
   */
  start.value = (double)(uint32_t)root;
  slope.value = (double)(uint32_t)y;
  start.bits += (uint64_t)((int64_t)(half_exponent - 30)) << 52;
  slope.bits += (uint64_t)((int64_t)(-half_exponent - 31)) << 52;
  return start.value + (x - start.value * start.value) * slope.value;
}

static double linear_gain(double f, double r) { return f * atan(r) / r; }

static double table_gain(const lens_t *lens, double r) { return table_radius(lens, atan(r)) / r; }

double lens_gain(const lens_t *lens, double r_squared) {
  const double f = lens->focal;
  switch (lens->mapping) {
    case LENS_RECTILINEAR:
      return f;
    case LENS_LINEAR:
      return r_squared < NEAR_AXIS ? f : linear_gain(f, lens_sqrt(r_squared));
    case LENS_ORTHOGRAPHIC:
      return f / lens_sqrt(1.0 + r_squared);
    case LENS_EQUISOLID: {
      /* The textbook form f * sqrt(2 * (1 - 1 / h)) / r loses digits near the axis. This form is
       * equal to it and does not. */
      const double h = lens_sqrt(1.0 + r_squared);
      return f * lens_sqrt(2.0 / (h * (h + 1.0)));
    }
    case LENS_STEREOGRAPHIC:
      return 2.0 * f / (1.0 + lens_sqrt(1.0 + r_squared));
    case LENS_TABLE:
      return r_squared < NEAR_AXIS ? lens->table_r[1] * lens->table_scale
                                   : table_gain(lens, lens_sqrt(r_squared));
    default:
      return 0.0;
  }
}

/* Offset of the source from the optical centre, which the four mirror images of an output position
 * share. Returns 0 beyond theta_max. */
static int source_offset(const lens_t *lens, double x, double y, double *dx, double *dy) {
  const double r_squared = x * x + y * y;
  /* The last table entry still belongs to the lens: only larger angles are invisible. */
  if (!(r_squared <= lens->tan_limit_squared)) return 0;
  const double gain = lens_gain(lens, r_squared);
  *dx = gain * x;
  *dy = lens->in_aspect * gain * y;
  return 1;
}

double lens_output_centre(uint32_t side) { return ((double)side - 1.0) / 2.0; }

double lens_output_x(const lens_t *lens, double u) {
  return (u - lens_output_centre(lens->width) + lens->shift_x) * lens->scale_x;
}

double lens_output_y(const lens_t *lens, double v) {
  return (v - lens_output_centre(lens->height) + lens->shift_y) * lens->scale_y;
}

lens_point_t lens_source(const lens_t *lens, double u, double v) {
  if (lens->mapping == LENS_NONE) /* pixel for pixel, around the middle */
    return (lens_point_t){u + ((double)lens->source_width - (double)lens->width) / 2.0 + lens->shift_x,
                          v + ((double)lens->source_height - (double)lens->height) / 2.0 + lens->shift_y, 1};
  double dx, dy;
  if (!source_offset(lens, lens_output_x(lens, u), lens_output_y(lens, v), &dx, &dy))
    return (lens_point_t){0.0, 0.0, 0};
  return (lens_point_t){lens_output_centre(lens->source_width) + lens->centre_x + dx,
                        lens_output_centre(lens->source_height) + lens->centre_y + dy, 1};
}

/* floor(x + 0.5) for a position that may be far outside the picture; -1 for all positions below 0.
 */
static int32_t nearest(double x) {
  if (!(x >= -0.5)) return -1;
  if (x > 1e6) return 1000000;
  return (int32_t)(x + 0.5);
}

uint32_t lens_lut_entry(const lens_t *lens, lens_point_t source, uint32_t pitch_bytes,
                        uint32_t black_offset) {
  if (!source.visible) return black_offset;
  const int32_t column = nearest(source.column);
  const int32_t row = nearest(source.row);
  if (column < 0 || row < 0 || column >= (int32_t)lens->source_width ||
      row >= (int32_t)lens->source_height)
    return black_offset;
  return (uint32_t)row * pitch_bytes + ((uint32_t)column & ~1u) * 2u;
}

void lens_build_lut(const lens_t *lens, uint32_t *lut, uint32_t pitch_bytes) {
  const uint32_t pairs = lens->width / 2;
  const uint32_t black = lens_black_offset(lens->source_height, pitch_bytes);
  const double first = lens->pair_method_b ? 0.5 : 0.0;
  /* Mirror images: rows v and H-1-v if the view is not shifted vertically. Columns can be mirrored
   * only with method B, whose positions 2i + 0.5 are symmetric; without it, the mirror image of a
   * first pixel (even) is a second one (odd). */
  const int mirror_rows = lens->mapping != LENS_NONE && lens->shift_y == 0.0;
  const int mirror_columns =
      lens->mapping != LENS_NONE && lens->shift_x == 0.0 && lens->pair_method_b;
  const uint32_t rows = mirror_rows ? (lens->height + 1) / 2 : lens->height;
  const uint32_t columns = mirror_columns ? (pairs + 1) / 2 : pairs;
  const double centre_column = lens_output_centre(lens->source_width) + lens->centre_x;
  const double centre_row = lens_output_centre(lens->source_height) + lens->centre_y;

  for (uint32_t v = 0; v < rows; ++v) {
    uint32_t *upper = lut + v * pairs;
    uint32_t *lower = lut + (lens->height - 1 - v) * pairs;
    const double y = lens_output_y(lens, (double)v);
    for (uint32_t i = 0; i < columns; ++i) {
      const double u = 2.0 * (double)i + first;
      if (lens->mapping == LENS_NONE) {
        upper[i] = lens_lut_entry(lens, lens_source(lens, u, (double)v), pitch_bytes, black);
        continue;
      }
      double dx = 0.0, dy = 0.0;
      const int visible = source_offset(lens, lens_output_x(lens, u), y, &dx, &dy);
      const lens_point_t p = {centre_column + dx, centre_row + dy, visible};
      upper[i] = lens_lut_entry(lens, p, pitch_bytes, black);
      if (mirror_rows) {
        const lens_point_t q = {p.column, centre_row - dy, visible};
        lower[i] = lens_lut_entry(lens, q, pitch_bytes, black);
      }
      if (mirror_columns) {
        const lens_point_t q = {centre_column - dx, p.row, visible};
        upper[pairs - 1 - i] = lens_lut_entry(lens, q, pitch_bytes, black);
        if (mirror_rows) {
          const lens_point_t s = {centre_column - dx, centre_row - dy, visible};
          lower[pairs - 1 - i] = lens_lut_entry(lens, s, pitch_bytes, black);
        }
      }
    }
  }
}
