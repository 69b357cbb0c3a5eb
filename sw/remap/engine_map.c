#include "engine_map.h"

#include <stddef.h>

#include "sw/firmware/registers.h"

/* A value in the field with this mask. */
#define FIELD(mask, value) ((uint32_t)(value) * ((mask) & (~(mask) + 1u)))

enum mode { TABLE = 0, GRID = 1, RADIAL = 2, PROJECT = 3 };

static const char kRange[] = "the view does not fit into the engine's numbers";

/* The nearest number with `fraction` bits behind the binary point; 0 if it has more than `bits` bits
 * with sign. */
static int fixed(double value, uint32_t fraction, uint32_t bits, uint32_t *out) {
  const double scaled = value * (double)(1u << fraction);
  const double limit = (double)(1u << (bits - 1u));
  if (!(scaled > -limit && scaled < limit - 1.0)) return 0;
  *out = (uint32_t)(int32_t)(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
  return 1;
}

static remap_engine_job_t job_of(enum mode mode, uint32_t width, uint32_t height,
                                 uint32_t pitch_bytes) {
  return (remap_engine_job_t){
      .mode = FIELD(ENGINE_MODE_MODE, mode),
      .size = FIELD(ENGINE_SIZE_PAIRS, width / 2u) | FIELD(ENGINE_SIZE_ROWS, height),
      .src_pitch = pitch_bytes,
      .src_size = FIELD(ENGINE_SRC_SIZE_WIDTH, width) | FIELD(ENGINE_SRC_SIZE_HEIGHT, height),
      .dst_pitch = pitch_bytes,
      .border = LENS_BLACK_WORD,
      .radius_limit = 0xFFFFFFFFu};
}

remap_engine_job_t remap_engine_table(uint32_t width, uint32_t height, uint32_t pitch_bytes) {
  remap_engine_job_t job = job_of(TABLE, width, height, pitch_bytes);
  job.map_words = lens_lut_entries(width, height);
  return job;
}

/* With a third form that is 0 everywhere no position has a source. */
void remap_engine_blacken(remap_engine_job_t *job) {
  job->mode = FIELD(ENGINE_MODE_MODE, PROJECT);
  job->map_words = 0;
  job->c[0] = job->c[1] = job->c[2] = 0;
}

remap_engine_job_t remap_engine_part(const engine_part_t *part, uint32_t width, uint32_t height,
                                     uint32_t pitch_bytes) {
  remap_engine_job_t job = remap_engine_table(width, height, pitch_bytes);
  job.size = FIELD(ENGINE_SIZE_PAIRS, part->pairs) | FIELD(ENGINE_SIZE_ROWS, part->rows);
  job.dst_base = part->top * pitch_bytes + part->left * 4u;
  job.dst_pitch = part->every * pitch_bytes + (uint32_t)(part->slant * 4);
  job.map_words = (uint32_t)part->pairs * part->rows;
  return job;
}

void remap_engine_part_map(const engine_part_t *part, const uint32_t *lut, uint32_t width,
                           uint32_t *map) {
  for (uint32_t row = 0; row < part->rows; ++row) {
    const int32_t left = (int32_t)part->left + (int32_t)row * part->slant;
    const uint32_t *from = lut + (part->top + row * part->every) * (width / 2u) + (uint32_t)left;
    for (uint32_t i = 0; i < part->pairs; ++i) *map++ = *from++;
  }
}

/* The pixel of a pair whose source is looked for, relative to the pair's first one. */
static double first_pixel(const lens_t *lens) { return lens->pair_method_b ? 0.5 : 0.0; }

static uint32_t nodes_along(uint32_t pixels) {
  return ((pixels + (1u << REMAP_ENGINE_GRID_LOG2) - 1u) >> REMAP_ENGINE_GRID_LOG2) + 1u;
}

uint32_t remap_engine_grid_words(uint32_t width, uint32_t height) {
  return nodes_along(width) * nodes_along(height);
}

const char *remap_engine_grid(const lens_t *lens, uint32_t pitch_bytes, remap_engine_job_t *job,
                              uint32_t *map) {
  *job = job_of(GRID, lens->width, lens->height, pitch_bytes);
  job->mode |= FIELD(ENGINE_MODE_GRID_LOG2, REMAP_ENGINE_GRID_LOG2);
  job->map_words = remap_engine_grid_words(lens->width, lens->height);
  const double first = first_pixel(lens);
  if (!fixed(first, 16, 32, &job->a[0])) return kRange;
  job->a[1] = 2u << 16;
  job->b[2] = 1u << 16;
  for (uint32_t h = 0; h < nodes_along(lens->height); ++h)
    for (uint32_t g = 0; g < nodes_along(lens->width); ++g) {
      const double u = (double)(g << REMAP_ENGINE_GRID_LOG2) + first;
      const double v = (double)(h << REMAP_ENGINE_GRID_LOG2);
      const lens_point_t p = lens_source(lens, u, v);
      uint32_t x, y;
      if (!p.visible) return "a grid cannot express the largest visible angle";
      if (!fixed(p.column - u, 4, 16, &x) || !fixed(p.row - v, 4, 16, &y)) return kRange;
      *map++ = (x & 0xFFFFu) | y << 16;
    }
  return NULL;
}

/* A linear form that is `first` at the first pixel and `second` a step later. */
static int form(double first, double second, uint32_t *value, uint32_t *step) {
  return fixed(first, 16, 32, value) && fixed(second - first, 16, 32, step);
}

static double larger(double a, double b) { return a > b ? a : b; }
static double absolute(double x) { return x < 0.0 ? -x : x; }

/* The gain R / r in px / px at a square radius of the view, px^2. */
static double gain_at(const lens_t *lens, double square) {
  const double f = lens->out_focal;
  return lens_gain(lens, square / (f * f)) / f;
}

const char *remap_engine_radial(const lens_t *lens, uint32_t pitch_bytes, remap_engine_job_t *job,
                                uint32_t *map) {
  if (lens->mapping == LENS_NONE) return "a mapping is needed, and the page has none";
  *job = job_of(RADIAL, lens->width, lens->height, pitch_bytes);
  const double f = lens->out_focal, first = first_pixel(lens);
  const double y0 = lens_output_y(lens, 0.0) * f, y1 = lens_output_y(lens, 1.0) * f;
  if (!form(lens_output_x(lens, first) * f, lens_output_x(lens, first + 2.0) * f, &job->a[0],
            &job->a[1]) ||
      !form(y0, y1, &job->b[0], &job->b[2]) ||
      !form(y0 * lens->in_aspect, y1 * lens->in_aspect, &job->c[0], &job->c[2]) ||
      !fixed(lens_output_centre(lens->width) + lens->centre_x, 16, 32, &job->centre_x) ||
      !fixed(lens_output_centre(lens->height) + lens->centre_y, 16, 32, &job->centre_y))
    return kRange;

  const double x = larger(absolute(lens_output_x(lens, 0.0)),
                          absolute(lens_output_x(lens, (double)lens->width))) * f;
  const double y = larger(absolute(y0), absolute(lens_output_y(lens, (double)lens->height) * f));
  if (larger(x, y * larger(1.0, lens->in_aspect)) >= 2047.0) return kRange;
  const double largest = x * x + y * y + 1.0;
  uint32_t log2 = 0;
  while ((double)(REMAP_ENGINE_PIECES_MAX << log2) <= largest) ++log2;
  const double width = (double)(1u << log2);
  const uint32_t pieces = (uint32_t)(largest / width) + 1u;
  job->mode |= FIELD(ENGINE_MODE_PIECES, pieces) | FIELD(ENGINE_MODE_PIECE_LOG2, log2);
  job->map_words = 3u * pieces;
  const double limit = lens->tan_limit_squared * f * f * 256.0;
  if (limit < 4294967295.0) job->radius_limit = (uint32_t)limit;
  for (uint32_t n = 0; n < pieces; ++n) {
    /* The parabola through both ends of the piece and its middle. */
    const double a = gain_at(lens, (double)n * width);
    const double b = gain_at(lens, ((double)n + 0.5) * width);
    const double c = gain_at(lens, ((double)n + 1.0) * width);
    if (!fixed(a, 20, 26, map++) || !fixed(-3.0 * a + 4.0 * b - c, 20, 26, map++) ||
        !fixed(2.0 * a - 4.0 * b + 2.0 * c, 20, 26, map++))
      return kRange;
  }
  return NULL;
}
