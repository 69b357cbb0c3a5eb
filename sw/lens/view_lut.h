/* Look-up tables of composed views: displayed pixels that show a camera's picture through a projective map instead of
 * the one of lens_source(). Portable C11 that needs only math.h; README.md describes the maps and the rule of the
 * seams. */
#ifndef FOVEA_LENS_VIEW_LUT_H
#define FOVEA_LENS_VIEW_LUT_H

#include <stdint.h>

#include "model/contract/view_page.h"
#include "sw/lens/fast_lut.h"
#include "sw/lens/lens.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Where a camera's picture lies in the frame that the table points into. */
typedef struct view_place {
  uint32_t halved;    /* 1: only every second pixel of every second row of it is there */
  uint32_t left, top; /* of its first pixel; even */
} view_place_t;

/** A map from the display to a camera's picture. */
typedef struct view_map {
  const lens_t *lens; /* not owned */
  view_place_t place;
  uint32_t pitch_bytes; /* of the frame */
  /* Row by row a matrix from the displayed pixel (u, v, 1) to a direction: x right, y down, z along the axis. */
  double m[9];
  /* Derived by view_map_fixed_point(); a null pointer: double precision throughout. */
  const fast_lut_t *fast;
  double x_scale, y_scale; /* units of a position for a gain of fast_lut, shifted by 32 */
  double s_max;            /* tan(theta) squared, of what `fast` covers */
  int32_t centre_column, centre_row; /* of the lens, plus half a pixel; FAST_LUT_FRACTION */
} view_map_t;

/** The map of a picture at half width and half height: what the display of lens_source() shows, in
 * a rectangle whose first pixel is (left, top). Mapping none gives the picture as it is. */
void view_map_half(view_map_t *map, const lens_t *lens, uint32_t left, uint32_t top);

/** Has view_map_row() compute in fixed point where that gives the same entries.
 * @param fast memory for this map, in use as long as the map
 * @param wide memory likewise
 * @return what fast_lut_prepare() says; other than FAST_LUT_OK, double precision stays */
fast_lut_result_t view_map_fixed_point(view_map_t *map, fast_lut_t *fast, lens_t *wide);

/** The exact position that the displayed position (u, v) shows, in the camera's whole picture. */
lens_point_t view_map_source(const view_map_t *map, double u, double v);

/** Table entries of the pairs from `first` to before `end` in row v, to entries[0] and on: byte offsets
 * into the frame. Outside the picture, and for directions at 90 degrees from the axis and beyond, it
 * is the black word behind a frame of the camera's height (lens_black_offset()). */
void view_map_row(const view_map_t *map, uint32_t v, uint32_t first, uint32_t end, uint32_t *entries);

#define VIEW_NO_CAMERA VIEW_CAMERAS /* black */
#define VIEW_SPANS_MAX 3u

/** Neighbouring pairs of a row, up to before `end`, that show one camera. */
typedef struct view_span {
  uint32_t camera; /* or VIEW_NO_CAMERA */
  uint32_t end;
} view_span_t;

/** Whose picture row v of the four-way view shows. @return number of spans; none is empty */
uint32_t view_four_way_row(uint32_t pairs, uint32_t rows, uint32_t v, view_span_t spans[VIEW_SPANS_MAX]);

/** Whose picture row v of the bird's-eye view shows. The seams begin at the corners of the car and run
 * outwards at 45 degrees in the displayed picture; a pair belongs to the camera of its first pixel, or
 * with pair method B of its centre. On a seam it belongs to the front or rear camera.
 * @return number of spans; none is empty */
uint32_t view_birds_eye_row(const view_rectangle_t *car, int pair_method_b, uint32_t pairs, uint32_t v,
                            view_span_t spans[VIEW_SPANS_MAX]);

#ifdef __cplusplus
}
#endif
#endif
