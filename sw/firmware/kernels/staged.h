/* The inner loop of the staged remap. */
#ifndef FOVEA_FIRMWARE_STAGED_H
#define FOVEA_FIRMWARE_STAGED_H

#include <stdint.h>

/** Computes a tile of 40 x 24 pairs (sw/remap/tiles.h) from its window.
 * @param out where its first row goes (a multiple of 32) minus `step`; every second row follows
 * @param code tile_stream_t.code
 * @param ram where the second row and every second one after it go, one behind the other
 * @param step bytes from the end of a row in `out` to the next one */
void staged_tile(uint8_t *out, const uint16_t *code, uint32_t *ram, uint32_t step);

#endif
