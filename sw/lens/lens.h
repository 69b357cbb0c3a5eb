/* Lens model and look-up table. Portable C11, needs only math.h; README.md has the geometry. */
#ifndef FOVEA_LENS_LENS_H
#define FOVEA_LENS_LENS_H

#include <stdint.h>

#include "sw/lens/param_page.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum lens_result {
  LENS_OK = 0,
  LENS_BAD_SIZE,    /* width odd, or a side is 0 or above 4096 */
  LENS_BAD_MAPPING, /* not an enum lens_mapping */
  LENS_BAD_FOV,     /* outside what the mapping can show */
  LENS_BAD_FOCAL,   /* a focal length or aspect is not a positive finite number */
  LENS_BAD_TABLE    /* fewer than 2 entries, theta_max missing, or not increasing from 0 */
} lens_result_t;

/** A lens and view, checked and with everything derived. */
typedef struct lens {
  uint32_t mapping;
  uint32_t width, height; /* pixels */
  int pair_method_b;
  double focal;              /* of the lens, px */
  double out_focal;          /* of the corrected view, px */
  double centre_x, centre_y; /* px */
  double shift_x, shift_y;   /* px */
  double in_aspect, out_aspect;
  double scale_x, scale_y;  /* output pixels to tan(theta) */
  double tan_limit_squared; /* of the largest angle shown; HUGE_VAL: all below 90 degrees */
  double table_scale;       /* table intervals per radian */
  uint32_t table_count;
  const double *table_r; /* borrowed from the page */
} lens_t;

/** Exact source position of an output position, in input pixels from the picture's first pixel. */
typedef struct lens_point {
  double column, row;
  int visible; /* 0: beyond theta_max; the position is then meaningless */
} lens_point_t;

/** Focal length in px from width and full field of view: the correct one per mapping, or the
 * paper's printed equation (10) for the equisolid mapping when `paper_literal` is set.
 * 0 if the mapping has no such focal length at that field of view. */
double lens_focal_from_fov(uint32_t mapping, double width, double fov_deg, int paper_literal);

/** Checks `page` for a picture of width x height and derives `lens`. The page must outlive it. */
lens_result_t lens_init(lens_t *lens, const param_page_t *page, uint32_t width, uint32_t height);

/** Sentence for a result, for a message. */
const char *lens_result_text(lens_result_t result);

/** Image radius R in px at angle theta (radians) from the axis, by the mapping's definition.
 * Not limited to 90 degrees. A table is linear between its entries and ends at theta_max. */
double lens_radius(const lens_t *lens, double theta);

/** R(theta) / tan(theta) in px, given tan(theta) squared; no trigonometry where the mapping allows.
 */
double lens_gain(const lens_t *lens, double r_squared);

/** Square root of a normal positive number to within 2 units in the last place, mostly in integers:
 * far fewer instructions than the C library's on a core without floating point. */
double lens_sqrt(double x);

/** Source of the output position (u, v); u and v may be fractional. */
lens_point_t lens_source(const lens_t *lens, double u, double v);

/** Table entries of a picture: one per pair of pixels. */
static inline uint32_t lens_lut_entries(uint32_t width, uint32_t height) {
  return width / 2 * height;
}

/** Entry for a source position: byte offset of the aligned pair word from the start of the frame,
 * or `black_offset` for a position outside the picture. */
uint32_t lens_lut_entry(const lens_t *lens, lens_point_t source, uint32_t pitch_bytes,
                        uint32_t black_offset);

/** Byte offset of the reserved black word: right behind the last line. */
static inline uint32_t lens_black_offset(uint32_t height, uint32_t pitch_bytes) {
  return height * pitch_bytes;
}

/** Fills `lut` (row by row, width / 2 entries a row). Uses the symmetry of a centred view: entries
 * are the same as those computed one by one. */
void lens_build_lut(const lens_t *lens, uint32_t *lut, uint32_t pitch_bytes);

/** The pair UYVY black, Y 16, Cb = Cr = 128. */
#define LENS_BLACK_WORD 0x10801080u

#ifdef __cplusplus
}
#endif
#endif
