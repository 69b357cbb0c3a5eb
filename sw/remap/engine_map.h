/* Jobs of the remap engine (rtl/README.md) for a picture, and the maps that follow from a lens. Portable
 * C11 that needs sw/lens; double precision, as few positions are computed. */
#ifndef FOVEA_REMAP_ENGINE_MAP_H
#define FOVEA_REMAP_ENGINE_MAP_H

#include <stdint.h>

#include "sw/lens/lens.h"
#include "sw/remap/engine_parts.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The engine's registers from MODE to C2, in their order, as they are written. */
typedef struct remap_engine_job {
  uint32_t mode, size;
  uint32_t src_base, src_pitch, src_size; /* byte address of the source, bytes */
  uint32_t dst_base, dst_pitch;
  uint32_t map_base, map_words;
  uint32_t border;
  uint32_t radius_limit, centre_x, centre_y;
  uint32_t a[3], b[3], c[3];
} remap_engine_job_t;

#define REMAP_ENGINE_MAP_ALIGNMENT 64u
#define REMAP_ENGINE_GRID_LOG2 4u /* a node for every 16 pixels */
#define REMAP_ENGINE_PIECES_MAX 128u
#define REMAP_ENGINE_RADIAL_WORDS_MAX (3u * REMAP_ENGINE_PIECES_MAX)

/** The job that follows the look-up table, which is its map. Source and result have the same size, in
 * pixels, and pitch; the addresses of source, result and map are left 0, here and below. */
remap_engine_job_t remap_engine_table(uint32_t width, uint32_t height, uint32_t pitch_bytes);

/** Makes of a job one that paints its whole result in the colour of the border, and reads nothing. */
void remap_engine_blacken(remap_engine_job_t *job);

/** The job of a part of a picture (engine_parts.h), by a table; its result's address is relative to the picture's. The
 * map has an entry for each pair of the part, row by row: remap_engine_part_map() copies them from the table of the
 * whole picture. */
remap_engine_job_t remap_engine_part(const engine_part_t *part, uint32_t width, uint32_t height,
                                     uint32_t pitch_bytes);
void remap_engine_part_map(const engine_part_t *part, const uint32_t *lut, uint32_t width,
                           uint32_t *map);

/** Number of words of a grid's map. */
uint32_t remap_engine_grid_words(uint32_t width, uint32_t height);

/** Fills `map` with a node for every 2^REMAP_ENGINE_GRID_LOG2 pixels, exact to 1/16 px, and `job`.
 * @return a null pointer, or the reason why no grid expresses the lens */
const char *remap_engine_grid(const lens_t *lens, uint32_t pitch_bytes, remap_engine_job_t *job,
                              uint32_t *map);

/** Fills `map`, room for REMAP_ENGINE_RADIAL_WORDS_MAX words, with pieces of the function from square
 * radius to gain, as narrow as so many pieces allow, and `job`.
 * @return a null pointer, or the reason why the engine's numbers do not express the lens */
const char *remap_engine_radial(const lens_t *lens, uint32_t pitch_bytes, remap_engine_job_t *job,
                                uint32_t *map);

#ifdef __cplusplus
}
#endif

#endif
