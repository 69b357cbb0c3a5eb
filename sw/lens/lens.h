/* Lens model and look-up table. Portable C11 that needs only math.h; README.md describes the
 * geometry. */
#ifndef FOVEA_LENS_LENS_H
#define FOVEA_LENS_LENS_H

#include <stdint.h>

#include "model/contract/param_page.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum lens_result {
  LENS_OK = 0,
  LENS_BAD_SIZE,    /* width odd, or a side is 0 or above 4096 */
  LENS_BAD_MAPPING, /* not an enum lens_mapping */
  LENS_BAD_PAIR,    /* not an enum param_pair_method */
  LENS_BAD_FOV,     /* beyond what the mapping can represent */
  LENS_BAD_FOCAL,   /* a focal length or aspect is not a positive finite number */
  LENS_BAD_TABLE    /* fewer than 2 entries, theta_max missing, or entries not increasing from 0 */
} lens_result_t;

/** A checked lens and view, with all derived values. */
typedef struct lens {
  uint32_t mapping;
  uint32_t width, height; /* of the result, pixels */
  uint32_t source_width, source_height;
  int pair_method_b;
  double focal;              /* of the lens, px */
  double out_focal;          /* of the corrected view, px */
  double centre_x, centre_y; /* px */
  double shift_x, shift_y;   /* px */
  double in_aspect, out_aspect;
  double scale_x, scale_y;  /* from output pixels to tan(theta) */
  double tan_limit_squared; /* for the largest angle shown; HUGE_VAL: all angles below 90 degrees */
  double table_scale;       /* table intervals per radian */
  uint32_t table_count;
  const double *table_r; /* not owned: points into the lens_view_t */
} lens_t;

/** Exact source position of an output position, in input pixels relative to the first pixel. */
typedef struct lens_point {
  double column, row;
  int visible; /* 0: beyond theta_max, the position is not valid */
} lens_point_t;

/** Focal length in px from the picture's width (px) and full field of view (degrees): the correct
 * formula of each mapping, or for the equisolid mapping the paper's printed equation (10) if
 * `paper_literal` is set. 0 if the mapping has no such focal length at that field of view. */
double lens_focal_from_fov(uint32_t mapping, double width, double fov_deg, int paper_literal);

/** Lens and view with defaults: equisolid, 180 degrees, square pixels, centred. */
void lens_view_default(lens_view_t *view);

/** Checks `view` for a picture of width x height and derives `lens`. The view must outlive `lens`.
 */
lens_result_t lens_init(lens_t *lens, const lens_view_t *view, uint32_t width, uint32_t height);

/** The size of a picture, in pixels. */
typedef struct lens_size {
  uint32_t width, height;
} lens_size_t;

/** The same for a source of another size than the result. Lens, field of view and optical centre are
 * those of the source. Both pictures have one pitch; the black word lies behind the source. */
lens_result_t lens_init_sizes(lens_t *lens, const lens_view_t *view, lens_size_t source,
                              lens_size_t result);

/** A sentence for a message about a result. */
const char *lens_result_text(lens_result_t result);

/** Image radius R in px at the angle theta (radians) from the axis, by the definition of the
 * mapping. Not limited to 90 degrees. A table is interpolated linearly and ends at theta_max. */
double lens_radius(const lens_t *lens, double theta);

/** R(theta) / tan(theta) in px for tan(theta) squared, without trigonometry where the mapping
 * allows it. */
double lens_gain(const lens_t *lens, double r_squared);

/** Square root of a normal positive number, accurate to 2 units in the last place and computed
 * mostly with integers: on a core without floating point it takes far fewer instructions than the C
 * library's. */
double lens_sqrt(double x);

/** Middle of a side of `side` pixels: the position of its middle pixel. */
double lens_output_centre(uint32_t side);

/** Ray of the output position (u, v) in pixels: x and y for 1 along the axis. */
double lens_output_x(const lens_t *lens, double u);
double lens_output_y(const lens_t *lens, double v);

/** Source of the output position (u, v) in pixels; u and v may be fractional. */
lens_point_t lens_source(const lens_t *lens, double u, double v);

/** Number of table entries of a picture: one for each pair of pixels. */
static inline uint32_t lens_lut_entries(uint32_t width, uint32_t height) {
  return width / 2 * height;
}

/** Table entry for a source position: byte offset of the aligned pixel pair from the start of the
 * frame, or `black_offset` for a position outside the picture. */
uint32_t lens_lut_entry(const lens_t *lens, lens_point_t source, uint32_t pitch_bytes,
                        uint32_t black_offset);

/** Byte offset of the reserved black word, directly after the last line. */
static inline uint32_t lens_black_offset(uint32_t height, uint32_t pitch_bytes) {
  return height * pitch_bytes;
}

/** Fills `lut` row by row, with width / 2 entries per row of the result. Uses the symmetry of a centred view; the
 * entries are the same as if each was computed separately. */
void lens_build_lut(const lens_t *lens, uint32_t *lut, uint32_t pitch_bytes);

/** A black pixel pair in UYVY: Y = 16, Cb = Cr = 128. */
#define LENS_BLACK_WORD 0x10801080u

#ifdef __cplusplus
}
#endif
#endif
