/* A blinking status box, blended onto the picture through the cache. */
#ifndef FOVEA_FIRMWARE_OVERLAY_H
#define FOVEA_FIRMWARE_OVERLAY_H

#include <stdint.h>

/* Place and size in the output picture, pixels; even, inside every supported picture. */
#define OVERLAY_LEFT 32u
#define OVERLAY_TOP 32u
#define OVERLAY_WIDTH 64u
#define OVERLAY_HEIGHT 16u

#define OVERLAY_LUMA 0x50u
#define OVERLAY_LUMA_PATCHED 0xC0u

/** 1 in frames that show the box: eight on, eight off, by frame number. */
static inline int overlay_visible(uint32_t sequence) { return (sequence & 8u) == 0; }

/** Replaces each luma Y of the box by (Y + luma) / 2, rounded down; chroma stays. */
void overlay_draw(uint8_t *frame, uint32_t pitch_bytes, uint8_t luma);

/** Returns the immediate of one instruction, OVERLAY_LUMA as linked (see patch.S). */
uint32_t overlay_luma(void);

/** Runs overlay_luma(), replaces that immediate in memory, makes the caches agree, and returns what
 * it gives now. */
uint32_t overlay_patch(uint32_t luma);

#endif
