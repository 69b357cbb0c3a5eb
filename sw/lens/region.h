/* A region of interest: a rectangle of the corrected picture that fills the display. It is a scale and a shift of the
 * view, so that the table builders need to know nothing of it. Portable C11; README.md has the definition. */
#ifndef FOVEA_LENS_REGION_H
#define FOVEA_LENS_REGION_H

#include "sw/lens/lens.h"

#ifdef __cplusplus
extern "C" {
#endif

/** In pixels of the corrected picture; pixel n reaches from n to n + 1. */
typedef struct lens_region {
  double left, top, width, height;
} lens_region_t;

/* No region is enlarged more than this. */
#define LENS_REGION_SCALE_MAX 4.0

/** Whether it lies in a picture of this size, and is at least 1 / LENS_REGION_SCALE_MAX of it wide or high. */
int lens_region_fits(const lens_region_t *region, uint32_t width, uint32_t height);

/** By how much it is enlarged until it touches two opposite edges of the picture. */
double lens_region_scale(const lens_region_t *region, uint32_t width, uint32_t height);

/** Has `view` show the region of the picture that it shows now.
 * @param lens derived from `view`, with a mapping other than none
 * @param region one that fits the lens's width and height */
void lens_show_region(lens_view_t *view, const lens_t *lens, const lens_region_t *region);

#ifdef __cplusplus
}
#endif
#endif
