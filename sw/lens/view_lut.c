#include "sw/lens/view_lut.h"

#include <math.h>

#define ONE (1u << FAST_LUT_FRACTION)
/* Largest component of a direction for 1 along the axis that is computed in fixed point: 80 degrees. */
#define FIXED_POINT_MAX 6.0
/* The plane of the display ends before the horizon of the lens: 1 along the axis for so many across it. */
#define HORIZON 1e-6

void view_map_half(view_map_t *map, const lens_t *lens, uint32_t left, uint32_t top) {
  /* A mapping of none is a lens that images tangents, with a focal length of a pixel. */
  const int none = lens->mapping == LENS_NONE;
  const double scale_x = none ? 1.0 : lens->scale_x, scale_y = none ? 1.0 : lens->scale_y;
  /* Pixel n of the half picture covers pixels 2 n and 2 n + 1. */
  const double x = 0.5 - 2.0 * (double)left - lens_output_centre(lens->width) + lens->shift_x;
  const double y = 0.5 - 2.0 * (double)top - lens_output_centre(lens->height) + lens->shift_y;
  const double m[9] = {2.0 * scale_x, 0.0, x * scale_x, 0.0, 2.0 * scale_y, y * scale_y, 0.0, 0.0, 1.0};
  map->lens = lens;
  for (int i = 0; i < 9; ++i) map->m[i] = m[i];
}

static double gain_of_lens(const lens_t *lens, double r_squared) {
  return lens->mapping == LENS_NONE ? 1.0 : lens_gain(lens, r_squared);
}

static double aspect_of(const lens_t *lens) { return lens->mapping == LENS_NONE ? 1.0 : lens->in_aspect; }

static int32_t rounded(double x) { return (int32_t)(x < 0.0 ? x - 0.5 : x + 0.5); }

fast_lut_result_t view_map_fixed_point(view_map_t *map, fast_lut_t *fast, lens_t *wide) {
  map->fast = NULL;
  /* A view in which the directions have the range of FIXED_POINT_MAX. */
  *wide = *map->lens;
  wide->width = wide->height = 4;
  wide->shift_x = wide->shift_y = 0.0;
  wide->scale_x = wide->scale_y = FIXED_POINT_MAX / 2.5;
  const fast_lut_result_t result = fast_lut_prepare(fast, wide);
  if (result != FAST_LUT_OK) return result;
  const lens_t *lens = map->lens;
  const double column = lens_output_centre(lens->width) + lens->centre_x + 0.5;
  const double row = lens_output_centre(lens->height) + lens->centre_y + 0.5;
  if (!(fabs(column) < 8191.0 && fabs(row) < 8191.0)) return FAST_LUT_RANGE;
  map->centre_column = rounded(column * (double)ONE);
  map->centre_row = rounded(row * (double)ONE);
  map->y_scale = fast->y_scale;
  map->x_scale = fast->y_scale / lens->in_aspect;
  map->s_max = FIXED_POINT_MAX * FIXED_POINT_MAX;
  map->fast = fast;
  return FAST_LUT_OK;
}

/* Direction of (u, v) for 1 along the axis; 0 at the horizon and beyond. */
static inline int direction(const double *m, double u, double xv, double yv, double wv, double *x, double *y) {
  *x = m[0] * u + xv;
  *y = m[3] * u + yv;
  if (m[6] == 0.0 && wv == 1.0) return 1;
  const double w = m[6] * u + wv;
  if (!(w > HORIZON * (fabs(*x) + fabs(*y)))) return 0;
  const double inverse = 1.0 / w;
  *x *= inverse;
  *y *= inverse;
  return 1;
}

static int source(const view_map_t *map, double x, double y, lens_point_t *point) {
  const lens_t *lens = map->lens;
  const double r_squared = x * x + y * y;
  if (!(r_squared <= lens->tan_limit_squared)) return 0;
  const double gain = gain_of_lens(lens, r_squared);
  const int none = lens->mapping == LENS_NONE;
  point->column = lens_output_centre(lens->width) + (none ? 0.0 : lens->centre_x) + gain * x;
  point->row = lens_output_centre(lens->height) + (none ? 0.0 : lens->centre_y) + aspect_of(lens) * gain * y;
  point->visible = 1;
  return 1;
}

lens_point_t view_map_source(const view_map_t *map, double u, double v) {
  const double *m = map->m;
  lens_point_t point = {0.0, 0.0, 0};
  double x, y;
  if (direction(m, u, m[1] * v + m[2], m[4] * v + m[5], m[7] * v + m[8], &x, &y)) (void)source(map, x, y, &point);
  return point;
}

/* The word of a pixel of the camera's whole picture. */
static inline uint32_t word_of(const view_map_t *map, uint32_t column, uint32_t row) {
  const view_place_t *p = &map->place;
  return ((row >> p->halved) + p->top) * map->pitch_bytes + (((column >> p->halved) + p->left) & ~1u) * 2u;
}

static uint32_t exact_entry(const view_map_t *map, double x, double y, uint32_t black) {
  const lens_t *lens = map->lens;
  lens_point_t p;
  if (!source(map, x, y, &p)) return black;
  const double column = p.column + 0.5, row = p.row + 0.5;
  if (!(column >= 0.0 && row >= 0.0 && column < (double)lens->width && row < (double)lens->height)) return black;
  return word_of(map, (uint32_t)column, (uint32_t)row);
}

static inline int32_t high(int32_t a, int32_t b) { return (int32_t)((int64_t)a * b >> 32); }

/* True within the guard of a multiple of `period`, a power of two. */
static inline int is_near(uint32_t position, uint32_t period, uint32_t guard) {
  return ((position + guard) & (period - 1u)) <= 2u * guard;
}

/* The entry in fixed point. Returns 0 where it is not certain. `piece` is the last one that was used. */
static inline int fixed_entry(const view_map_t *map, double x, double y, const fast_lut_piece_t **piece,
                              uint32_t black, uint32_t *entry) {
  const fast_lut_t *f = map->fast;
  const lens_t *lens = map->lens;
  const double r_squared = x * x + y * y;
  if (!(r_squared < map->s_max)) return 0; /* then |x| and |y| are in range too */
  const uint32_t s = (uint32_t)(r_squared * f->s_scale + 0.5);
  const fast_lut_piece_t *p = *piece;
  while (s < p->start) --p;
  while (s - p->start >= p->span) ++p;
  *piece = p;
  if (p->shift >= FAST_LUT_EXACT) {
    *entry = black;
    return p->shift == FAST_LUT_BLACK;
  }
  const int32_t t = (int32_t)((s - p->start) << p->shift);
  const int32_t gain = p->c0 + high(p->d1 + high(p->d2, t), t);
  const uint32_t column = (uint32_t)map->centre_column + (uint32_t)high(gain, rounded(x * map->x_scale));
  const uint32_t row = (uint32_t)map->centre_row + (uint32_t)high(gain, rounded(y * map->y_scale));
  if (is_near(column, 2u * ONE, f->guard) || is_near(row, ONE, f->guard)) return 0;
  *entry = column < lens->width << FAST_LUT_FRACTION && row < lens->height << FAST_LUT_FRACTION
               ? word_of(map, column >> FAST_LUT_FRACTION, row >> FAST_LUT_FRACTION)
               : black;
  return 1;
}

void view_map_row(const view_map_t *map, uint32_t v, uint32_t first, uint32_t end, uint32_t *entries) {
  const lens_t *lens = map->lens;
  const double *m = map->m;
  const uint32_t black = lens_black_offset(lens->height, map->pitch_bytes);
  const double of_pair = lens->pair_method_b ? 0.5 : 0.0;
  const double xv = m[1] * (double)v + m[2], yv = m[4] * (double)v + m[5], wv = m[7] * (double)v + m[8];
  const fast_lut_piece_t *piece = map->fast != NULL ? map->fast->piece : NULL;
  for (uint32_t i = first; i < end; ++i, ++entries) {
    double x, y;
    if (!direction(m, 2.0 * (double)i + of_pair, xv, yv, wv, &x, &y))
      *entries = black;
    else if (piece == NULL || !fixed_entry(map, x, y, &piece, black, entries))
      *entries = exact_entry(map, x, y, black);
  }
}

static uint32_t add_span(view_span_t *spans, uint32_t count, uint32_t camera, uint32_t end) {
  if (end == (count == 0 ? 0u : spans[count - 1u].end)) return count;
  spans[count] = (view_span_t){camera, end};
  return count + 1u;
}

uint32_t view_four_way_row(uint32_t pairs, uint32_t rows, uint32_t v, view_span_t spans[VIEW_SPANS_MAX]) {
  const uint32_t first = v < rows / 2u ? 0u : 2u;
  const uint32_t count = add_span(spans, 0, first, pairs / 2u);
  return add_span(spans, count, first + 1u, pairs);
}

/* Number of pairs, of `pairs`, whose position 2 i + of_pair is less than u, or with `or_at` not above it. */
static uint32_t pairs_before(double u, double of_pair, uint32_t pairs, int or_at) {
  const double position = (u - of_pair) / 2.0;
  if (!(position >= 0.0)) return 0;
  if (position >= (double)pairs) return pairs;
  uint32_t n = (uint32_t)position; /* pairs 0 to n - 1 are before it */
  if ((double)n < position || or_at) ++n;
  return n < pairs ? n : pairs;
}

uint32_t view_birds_eye_row(const view_rectangle_t *car, int pair_method_b, uint32_t pairs, uint32_t v,
                            view_span_t spans[VIEW_SPANS_MAX]) {
  const double of_pair = pair_method_b ? 0.5 : 0.0, row = (double)v;
  double out = 0.0; /* how far the row is before or behind the car */
  uint32_t middle = VIEW_NO_CAMERA;
  if (row <= car->top) {
    out = car->top - row;
    middle = VIEW_FRONT;
  } else if (row >= car->bottom) {
    out = row - car->bottom;
    middle = VIEW_REAR;
  }
  const uint32_t left = pairs_before(car->left - out, of_pair, pairs, 0);
  uint32_t right = pairs_before(car->right + out, of_pair, pairs, 1);
  if (right < left) right = left;
  uint32_t count = add_span(spans, 0, VIEW_LEFT, left);
  count = add_span(spans, count, middle, right);
  return add_span(spans, count, VIEW_RIGHT, pairs);
}
