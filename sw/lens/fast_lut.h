/* The look-up table of lens_build_lut() in fixed point: neither roots nor trigonometry in the loop.
 * README.md has the method and the bound of its error. */
#ifndef FOVEA_LENS_FAST_LUT_H
#define FOVEA_LENS_FAST_LUT_H

#include <stdint.h>

#include "sw/lens/lens.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FAST_LUT_FRACTION 17u /* bits of a source position behind the binary point */
#define FAST_LUT_PIECES_MAX 384u
#define FAST_LUT_PAIRS_MAX 2048u

typedef enum fast_lut_result {
  FAST_LUT_OK = 0,
  FAST_LUT_NO_LENS, /* mapping none */
  FAST_LUT_RANGE,   /* the scales do not fit: positions of 8192 px and more, or a zoom that large */
  FAST_LUT_PIECES,  /* the lens needs more than FAST_LUT_PIECES_MAX pieces */
  FAST_LUT_GUARD, /* the bound of the error is so large that too many entries would be exact ones */
  FAST_LUT_RESULTS
} fast_lut_result_t;

/** An interval of s = tan(theta) squared in which the gain R(theta) / tan(theta) is
 * c0 + d1 t / 2 + d2 t^2 / 4, with t = (s - start) * 2^shift / 2^31 between 0 and 1. */
typedef struct fast_lut_piece {
  uint32_t start, span; /* units of s */
  uint32_t shift;       /* or FAST_LUT_EXACT, FAST_LUT_BLACK */
  int32_t c0, d1, d2;   /* units of the gain */
} fast_lut_piece_t;

#define FAST_LUT_EXACT 32u /* around theta_max: entries are computed in double precision */
#define FAST_LUT_BLACK 33u /* beyond theta_max */

typedef struct fast_lut_column {
  uint32_t x_squared; /* units of s */
  int32_t x;          /* times a gain, shifted by 32: a position */
} fast_lut_column_t;

/** What fast_lut_prepare() derives from a lens. About 25 KiB. */
typedef struct fast_lut {
  const lens_t *lens;                /* not owned */
  double s_scale;                    /* units of s */
  double y_scale;                    /* units of y, with the input's aspect */
  int32_t centre_column, centre_row; /* of the source, plus half a pixel; FAST_LUT_FRACTION */
  /** Entries whose position is as near as this to a place where the entry changes are computed in
   * double precision: the bound of the error, in units of 2^-FAST_LUT_FRACTION px. */
  uint32_t guard;
  uint32_t piece_count;
  fast_lut_piece_t piece[FAST_LUT_PIECES_MAX];
  fast_lut_column_t column[FAST_LUT_PAIRS_MAX];
} fast_lut_t;

/** Chooses scales and pieces for a lens that lens_init() has accepted; `lens` must outlive `fast`.
 * For any other result than FAST_LUT_OK, `fast` is of no use, and lens_build_lut() has to build the
 * table. */
fast_lut_result_t fast_lut_prepare(fast_lut_t *fast, const lens_t *lens);

/** Fills `lut` like lens_build_lut(), with the same entries. Returns how many of them had to be
 * computed in double precision. */
uint32_t fast_lut_build(const fast_lut_t *fast, uint32_t *lut, uint32_t pitch_bytes);

/** The approximated source of output pair `pair` in row `row`, plus half a pixel, in units of
 * 2^-FAST_LUT_FRACTION px. Returns 0 where fast_lut_build() does not use it: around theta_max and
 * beyond. For tests of the error. */
int fast_lut_source(const fast_lut_t *fast, uint32_t pair, uint32_t row, int32_t *source_column,
                    int32_t *source_row);

/** A sentence for a message about a result. */
const char *fast_lut_result_text(fast_lut_result_t result);

#ifdef __cplusplus
}
#endif
#endif
