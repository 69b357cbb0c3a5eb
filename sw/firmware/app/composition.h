/* Views that are composed of the pictures of several cameras: look-up table of the whole displayed
 * picture, and the copying of each camera's part. */
#ifndef FOVEA_FIRMWARE_COMPOSITION_H
#define FOVEA_FIRMWARE_COMPOSITION_H

#include <stdint.h>

#include "../kernels/arena.h"
#include "config.h"

/** Reads the view page and builds `lut`, with messages on the UART. Entry n belongs to the camera that
 * the view shows there (sw/lens/view_lut.h) and is an offset in that camera's frame. A page that cannot be stops the
 * program. */
void composition_build(const config_t *config, arena_t *arena);

/** Composes a displayed picture.
 * @param sources the newest frame of each camera; a null pointer for one that has given none yet: its
 * part is black */
void composition_run(const uint8_t *const sources[], uint8_t *out);

/** Whether another device than the core reads the sources. Call after composition_build(). */
int composition_by_device(void);

/** Sum of some words of the sources. It is the same before and after composition_run() unless the
 * camera has written to them in between. */
uint32_t composition_sum(const uint8_t *const sources[]);

/** Number of sources: inputs of the decoder whose newest frames are kept. Call after
 * composition_build(). */
uint32_t composition_sources(void);

#endif
