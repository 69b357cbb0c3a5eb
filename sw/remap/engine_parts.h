/* Regions of a picture as jobs of the remap engine. A job makes pairs x rows words of which each row begins the same
 * distance behind the one before: a rectangle, or with another distance a parallelogram. A region whose edges run
 * straight down or at 45 degrees, such as a camera's part of a bird's-eye view, is covered by a few of them. Portable
 * C11 without a library. */
#ifndef FOVEA_REMAP_ENGINE_PARTS_H
#define FOVEA_REMAP_ENGINE_PARTS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A region's pairs of a row: from `first` to before `end`; none if both are equal. */
typedef struct engine_span {
  uint16_t first, end;
} engine_span_t;

/** Pairs that one job makes: row k of it is row top + k * every of the picture, and begins at pair
 * left + k * slant. */
typedef struct engine_part {
  uint16_t pairs, rows;
  uint16_t top, every; /* 1, or 2: each second row, as an edge at 45 degrees moves by a pair in two rows */
  uint16_t left;
  int16_t slant;
} engine_part_t;

/** Covers a region: each of its pairs is in one part at least, and none is in a part that is not in the region. Pairs
 * in two parts are made twice.
 * @param spans of each of the `rows` rows of the picture
 * @param part called for each part, with `context`; other than 0 ends the search
 * @return what the last call has returned; 0 for an empty region */
int engine_parts_cover(const engine_span_t *spans, uint32_t rows,
                       int (*part)(void *context, const engine_part_t *part), void *context);

#ifdef __cplusplus
}
#endif

#endif
