/* Composed views by the remap engine: the part of each camera is a few jobs (sw/remap/engine_parts.h), all of which
 * make one displayed picture. */
#ifndef FOVEA_FIRMWARE_COMPOSITION_ENGINE_H
#define FOVEA_FIRMWARE_COMPOSITION_ENGINE_H

#include "../kernels/arena.h"
#include "config.h"
#include "sw/lens/view_lut.h"

typedef struct engine_view {
  const config_t *config;
  int quad; /* all parts come from one frame */
  uint32_t (*spans)(uint32_t row, view_span_t spans[VIEW_SPANS_MAX]); /* whose each pair of a row is; see view_lut.h */
} engine_view_t;

/** Makes the jobs of the view whose table is `lut`, with a line on the UART.
 * @return a null pointer, or why the engine cannot make the view */
const char *engine_view_build(const engine_view_t *view, arena_t *arena);

/** As composition_run(). The core sleeps meanwhile. */
void engine_view_run(const uint8_t *const sources[], uint8_t *out);

#endif
