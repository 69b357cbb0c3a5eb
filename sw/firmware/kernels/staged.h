/* The inner loop of the staged remap. */
#ifndef FOVEA_FIRMWARE_STAGED_H
#define FOVEA_FIRMWARE_STAGED_H

#include <stdint.h>

/** Bytes of each row of a tile that go to `ram`; the others go to `out`. */
#define STAGED_RAM_BYTES 64u

/** Computes a tile of 40 x 24 pairs (sw/remap/tiles.h) from its window.
 * @param out where the first row's pair 16 goes (a multiple of 32), minus `step`
 * @param code tile_stream_t.code
 * @param ram where pairs 0 to 15 of all rows go, one row behind the other
 * @param step bytes from the end of a row to pair 16 of the next one */
void staged_tile(uint8_t *out, const uint16_t *code, uint32_t *ram, uint32_t step);

#endif
