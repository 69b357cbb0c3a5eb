#include "sw/lens/fast_lut.h"

#include <math.h>

#define ONE (1u << FAST_LUT_FRACTION)
#define TWO_31 2147483648.0
#define TWO_32 4294967296.0
/* Largest error of the interpolation, px. Pieces become fewer with its cube root, exact entries
 * become more in proportion. */
#define BUDGET (1.0 / 16384.0)
/* Errors of the fixed-point arithmetic in units of a position, README.md: at most 2.95. */
#define ROUNDING 4.0
/* A larger guard would send more than one entry in 40 to double precision. */
#define GUARD_MAX (ONE / 128u)
/* Largest value of |t (t - 1/2) (t - 1)| between 0 and 1, times two: 1 / (6 sqrt(3)). */
#define CUBIC_PEAK 0.09622504486493763

/* A place where the interpolation equals the gain. */
typedef struct node {
  double s, r, gain;
} node_t;

typedef struct cover {
  fast_lut_t *fast;
  double gain_max, gain_scale;
  double lever;  /* largest ratio of a source offset to gain * r */
  uint32_t at;   /* the pieces so far end here */
  uint32_t step; /* length to be tried next */
  node_t left;   /* node at `at` */
  double error;  /* of the interpolation, px, the largest so far */
  double slope;  /* change of a source position for one unit of s, px, the largest so far */
} cover_t;

static int32_t rounded(double x) { return (int32_t)(x < 0.0 ? x - 0.5 : x + 0.5); }

static node_t node_at(const cover_t *c, double units) {
  const double s = units / c->fast->s_scale;
  return (node_t){s, lens_sqrt(s), lens_gain(c->fast->lens, s)};
}

/* Bound of the interpolation's error in px. The gain is `hyperbola` / r + G, where 1 / r and G are
 * integrals of weight / (s + t) over t >= 0 and t >= 1, with weights of one sign. Of such a
 * function, the third divided difference is at most the second one divided by s + 0 or s + 1. */
static double interpolation_error(const cover_t *c, const node_t *mid, const node_t *right,
                                  double hyperbola) {
  const node_t *left = &c->left;
  double bend = left->gain - 2.0 * mid->gain + right->gain, third = 0.0;
  if (hyperbola != 0.0) {
    const double part = hyperbola * (1.0 / left->r - 2.0 / mid->r + 1.0 / right->r);
    bend -= part;
    third = fabs(part) / left->s;
  }
  third += fabs(bend) / (1.0 + left->s);
  return c->lever * right->r * CUBIC_PEAK * (right->s - left->s) * third;
}

static void append(cover_t *c, uint32_t span, const node_t *mid, const node_t *right) {
  const double rise = right->gain - c->left.gain;
  const double bend = c->left.gain - 2.0 * mid->gain + right->gain;
  uint32_t shift = 0;
  while (span << shift <= 1u << 30) ++shift;
  const double inverse = TWO_31 / (double)(span << shift);
  c->fast->piece[c->fast->piece_count++] =
      (fast_lut_piece_t){c->at,
                         span,
                         shift,
                         rounded(c->left.gain * c->gain_scale),
                         rounded(2.0 * (rise - 2.0 * bend) * inverse * c->gain_scale),
                         rounded(8.0 * bend * inverse * inverse * c->gain_scale)};
  const double slope = c->lever * right->r * (fabs(rise) + 2.0 * fabs(bend)) / (double)span;
  if (!(slope <= c->slope)) c->slope = slope;
}

/* Appends pieces up to `end`. The gain must be smooth between; `hyperbola`: see
 * interpolation_error(). */
static fast_lut_result_t cover_until(cover_t *c, uint32_t end, double hyperbola) {
  while (c->at < end) {
    /* Two are left for theta_max. */
    if (c->fast->piece_count == FAST_LUT_PIECES_MAX - 2u) return FAST_LUT_PIECES;
    const uint32_t span = c->step < end - c->at ? c->step : end - c->at;
    const node_t mid = node_at(c, (double)c->at + 0.5 * (double)span);
    const node_t right = node_at(c, (double)(c->at + span));
    const double bend = fabs(c->left.gain - 2.0 * mid.gain + right.gain);
    /* Keeps the coefficients in range: |d1| + |d2| / 2 below 2^31, and the gain below 2^31. */
    const int fits = fabs(right.gain - c->left.gain) + 8.0 * bend <= c->gain_max / 8.0;
    const double error = interpolation_error(c, &mid, &right, hyperbola);
    if (span > 1u && !(fits && error <= BUDGET)) {
      const uint32_t shorter = span > 3u ? span - span / 4u : span - 1u;
      c->step = !fits || !(error <= 8.0 * BUDGET) ? span / 2u : shorter;
      continue;
    }
    if (!fits) return FAST_LUT_RANGE;
    /* Between the two ends of a piece of one unit there is no s. */
    if (span > 1u && error > c->error) c->error = error;
    append(c, span, &mid, &right);
    c->at += span;
    c->left = right;
    if (error < BUDGET / 2.0) {
      const uint32_t longer = error < BUDGET / 8.0 ? span * 2u : span + span / 4u + 1u;
      if (longer > c->step) c->step = longer;
    }
  }
  return FAST_LUT_OK;
}

/* A table's gain is smooth from knot to knot only. */
static fast_lut_result_t cover_table(cover_t *c, uint32_t end) {
  const lens_t *lens = c->fast->lens;
  for (uint32_t i = 1; i < lens->table_count && c->at < end; ++i) {
    const double theta = (double)i / lens->table_scale;
    /* The last interval goes on beyond its end, as in lens_radius(). */
    double knot = TWO_31;
    if (i < lens->table_count - 1u && theta < 1.5707) {
      const double tangent = tan(theta);
      knot = tangent * tangent * c->fast->s_scale + 0.5;
    }
    const double first = lens->table_r[i - 1];
    const double at_axis = first - (lens->table_r[i] - first) * (double)(i - 1);
    const fast_lut_result_t result =
        cover_until(c, knot < (double)end ? (uint32_t)knot : end, at_axis);
    if (result != FAST_LUT_OK) return result;
  }
  return FAST_LUT_OK;
}

/* The largest value that the gain can have: R / tan(theta) <= R / theta, which between two knots
 * lies between its values there. The closed forms fall from the axis on. */
static double largest_gain(const lens_t *lens) {
  double largest = lens_gain(lens, 0.0);
  if (lens->mapping == LENS_TABLE)
    for (uint32_t i = 2; i < lens->table_count; ++i) {
      const double gain = lens->table_r[i] * lens->table_scale / (double)i;
      if (gain > largest) largest = gain;
    }
  return largest;
}

static double larger(double a, double b) { return a > b ? a : b; }

static double first_pixel(const lens_t *lens) { return lens->pair_method_b ? 0.5 : 0.0; }

static fast_lut_result_t choose_scales(cover_t *c) {
  fast_lut_t *f = c->fast;
  const lens_t *lens = f->lens;
  const double x_max =
      larger(fabs(lens_output_x(lens, 0.0)), fabs(lens_output_x(lens, (double)lens->width)));
  const double y_max =
      larger(fabs(lens_output_y(lens, 0.0)), fabs(lens_output_y(lens, (double)lens->height)));
  const double s_max = larger(x_max * x_max + y_max * y_max, 1e-9);
  f->s_scale = (TWO_31 - 1024.0) / s_max;
  c->lever = larger(1.0, lens->in_aspect);
  c->gain_max = largest_gain(lens);
  /* In a piece, the interpolation exceeds the gain's largest value by 1 / 64 of it at most. */
  c->gain_scale = TWO_31 * (31.0 / 32.0) / c->gain_max;
  const double x_scale = TWO_32 * (double)ONE / c->gain_scale;
  f->y_scale = x_scale * lens->in_aspect;
  /* Written so that a value that is not a number does not fit. */
  const double centre_column = lens_output_centre(lens->source_width) + lens->centre_x + 0.5;
  const double centre_row = lens_output_centre(lens->source_height) + lens->centre_y + 0.5;
  if (!(x_scale * x_max < TWO_31 - 1.0 && f->y_scale * y_max < TWO_31 - 1.0 && s_max < 1e8 &&
        fabs(centre_column) < 8191.0 && fabs(centre_row) < 8191.0))
    return FAST_LUT_RANGE;
  f->centre_column = rounded(centre_column * (double)ONE);
  f->centre_row = rounded(centre_row * (double)ONE);
  for (uint32_t i = 0; i < lens->width / 2u; ++i) {
    const double x = lens_output_x(lens, 2.0 * (double)i + first_pixel(lens));
    f->column[i] = (fast_lut_column_t){(uint32_t)(x * x * f->s_scale + 0.5), rounded(x * x_scale)};
  }
  return FAST_LUT_OK;
}

fast_lut_result_t fast_lut_prepare(fast_lut_t *fast, const lens_t *lens) {
  if (lens->mapping == LENS_NONE) return FAST_LUT_NO_LENS;
  fast->lens = lens;
  fast->piece_count = 0;
  cover_t c = {.fast = fast};
  fast_lut_result_t result = choose_scales(&c);
  if (result != FAST_LUT_OK) return result;

  /* s is wrong by a unit, the limit by half of one. */
  const double limit = lens->tan_limit_squared * fast->s_scale;
  const uint32_t end = limit < TWO_31 ? (limit > 2.0 ? (uint32_t)limit - 2u : 0u) : 1u << 31;
  c.step = end;
  c.left = node_at(&c, 0.0);
  result = lens->mapping == LENS_TABLE ? cover_table(&c, end) : cover_until(&c, end, 0.0);
  if (result != FAST_LUT_OK) return result;
  if (end < 1u << 31) {
    const uint32_t beyond = (uint32_t)limit + 3u;
    fast->piece[fast->piece_count++] =
        (fast_lut_piece_t){end, beyond - end, FAST_LUT_EXACT, 0, 0, 0};
    fast->piece[fast->piece_count++] =
        (fast_lut_piece_t){beyond, UINT32_MAX - beyond, FAST_LUT_BLACK, 0, 0, 0};
  }

  /* A unit of s for its own error, another one for that of a table's knots. */
  const double guard = (c.error + 2.0 * c.slope) * (double)ONE + ROUNDING;
  if (!(guard <= (double)GUARD_MAX)) return FAST_LUT_GUARD;
  fast->guard = (uint32_t)guard + 1u;
  return FAST_LUT_OK;
}

const char *fast_lut_result_text(fast_lut_result_t result) {
  switch (result) {
    case FAST_LUT_OK:
      return "ok";
    case FAST_LUT_NO_LENS:
      return "no lens to correct";
    case FAST_LUT_RANGE:
      return "lens and view do not fit into 32 bits";
    case FAST_LUT_PIECES:
      return "the lens is too irregular";
    case FAST_LUT_GUARD:
      return "the view is too wide for the precision of 32 bits";
    case FAST_LUT_RESULTS:
      break;
  }
  return "unknown";
}

static inline int32_t high(int32_t a, int32_t b) { return (int32_t)((int64_t)a * b >> 32); }

static inline int32_t gain_of(const fast_lut_piece_t *p, uint32_t distance) {
  const int32_t t = (int32_t)(distance << p->shift);
  return p->c0 + high(p->d1 + high(p->d2, t), t);
}

/* The piece of s, from any other one on. */
static const fast_lut_piece_t *piece_of(const fast_lut_piece_t *p, uint32_t s) {
  while (s < p->start) --p;
  while (s - p->start >= p->span) ++p;
  return p;
}

typedef struct row {
  const fast_lut_t *fast;
  uint32_t v, pitch, black;
  uint32_t y_squared;
  int32_t y;
  uint32_t *upper, *lower; /* entries of row v and of row height - 1 - v */
  uint32_t exact;
} row_t;

static void set_row(row_t *row, uint32_t v) {
  const fast_lut_t *f = row->fast;
  const double y = lens_output_y(f->lens, (double)v);
  row->v = v;
  row->y_squared = (uint32_t)(y * y * f->s_scale + 0.5);
  row->y = rounded(y * f->y_scale);
}

static uint32_t exact_entry(row_t *row, uint32_t i, uint32_t v) {
  const lens_t *lens = row->fast->lens;
  const double u = 2.0 * (double)i + first_pixel(lens);
  ++row->exact;
  return lens_lut_entry(lens, lens_source(lens, u, (double)v), row->pitch, row->black);
}

/* True within the guard of a multiple of `period`, a power of two. */
static inline int is_near(uint32_t position, uint32_t period, uint32_t guard) {
  return ((position + guard) & (period - 1u)) <= 2u * guard;
}

static inline __attribute__((always_inline)) void build_row(row_t *row,
                                                            const fast_lut_piece_t **piece,
                                                            int mirrored) {
  const fast_lut_t *f = row->fast;
  const lens_t *lens = f->lens;
  const uint32_t pairs = lens->width / 2u, last = lens->height - 1u - row->v;
  const uint32_t width = lens->source_width << FAST_LUT_FRACTION;
  const uint32_t height = lens->source_height << FAST_LUT_FRACTION;
  const uint32_t guard = f->guard, pitch = row->pitch, black = row->black;
  uint32_t i = 0;
  while (i < pairs) {
    const fast_lut_piece_t *p = piece_of(*piece, f->column[i].x_squared + row->y_squared);
    *piece = p;
    if (p->shift >= FAST_LUT_EXACT) {
      const int exact = p->shift == FAST_LUT_EXACT;
      row->upper[i] = exact ? exact_entry(row, i, row->v) : black;
      if (mirrored) row->lower[i] = exact ? exact_entry(row, i, last) : black;
      ++i;
      continue;
    }
    const uint32_t from = row->y_squared - p->start;
    do {
      const uint32_t distance = f->column[i].x_squared + from;
      if (distance >= p->span) break;
      const int32_t gain = gain_of(p, distance);
      const uint32_t column = (uint32_t)f->centre_column + (uint32_t)high(gain, f->column[i].x);
      const uint32_t dy = (uint32_t)high(gain, row->y);
      const uint32_t above = (uint32_t)f->centre_row + dy, below = (uint32_t)f->centre_row - dy;
      const int near_column = is_near(column, 2u * ONE, guard);
      const uint32_t word = column >> (FAST_LUT_FRACTION - 1u) & ~3u;
      if (near_column || is_near(above, ONE, guard))
        row->upper[i] = exact_entry(row, i, row->v);
      else
        row->upper[i] =
            column < width && above < height ? (above >> FAST_LUT_FRACTION) * pitch + word : black;
      if (!mirrored) continue;
      if (near_column || is_near(below, ONE, guard))
        row->lower[i] = exact_entry(row, i, last);
      else
        row->lower[i] =
            column < width && below < height ? (below >> FAST_LUT_FRACTION) * pitch + word : black;
    } while (++i < pairs);
  }
}

uint32_t fast_lut_build(const fast_lut_t *fast, uint32_t *lut, uint32_t pitch_bytes) {
  const lens_t *lens = fast->lens;
  const uint32_t pairs = lens->width / 2u;
  const int mirror_rows = lens->shift_y == 0.0;
  const uint32_t rows = mirror_rows ? (lens->height + 1u) / 2u : lens->height;
  const fast_lut_piece_t *piece = fast->piece;
  row_t row = {
      .fast = fast, .pitch = pitch_bytes, .black = lens_black_offset(lens->source_height, pitch_bytes)};
  for (uint32_t v = 0; v < rows; ++v) {
    const uint32_t last = lens->height - 1u - v;
    set_row(&row, v);
    row.upper = lut + v * pairs;
    row.lower = lut + last * pairs;
    if (mirror_rows && last != v)
      build_row(&row, &piece, 1);
    else
      build_row(&row, &piece, 0);
  }
  return row.exact;
}

int fast_lut_source(const fast_lut_t *fast, uint32_t pair, uint32_t row, int32_t *source_column,
                    int32_t *source_row) {
  row_t r = {.fast = fast};
  set_row(&r, row);
  const uint32_t s = fast->column[pair].x_squared + r.y_squared;
  const fast_lut_piece_t *p = piece_of(fast->piece, s);
  if (p->shift >= FAST_LUT_EXACT) return 0;
  const int32_t gain = gain_of(p, s - p->start);
  *source_column = fast->centre_column + high(gain, fast->column[pair].x);
  *source_row = fast->centre_row + high(gain, r.y);
  return 1;
}
