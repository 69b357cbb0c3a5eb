/* A blinking status box, blended into the picture through the data cache. */
#ifndef FOVEA_FIRMWARE_OVERLAY_H
#define FOVEA_FIRMWARE_OVERLAY_H

#include <stdint.h>

/* Position and size in the output picture, in pixels; even, and inside every supported picture. */
#define OVERLAY_LEFT 32u
#define OVERLAY_TOP 32u
#define OVERLAY_WIDTH 64u
#define OVERLAY_HEIGHT 16u

#define OVERLAY_LUMA 0x50u
#define OVERLAY_LUMA_PATCHED 0xC0u

/** Returns 1 for frames that show the box: eight with it, then eight without. */
static inline int overlay_visible(uint32_t sequence) { return (sequence & 8u) == 0; }

/** Replaces each luma value Y in the box by (Y + luma) / 2, rounded down; chroma is kept. */
void overlay_draw(uint8_t *frame, uint32_t pitch_bytes, uint8_t luma);

/** Returns the immediate operand of one instruction, initially OVERLAY_LUMA (see patch.S). */
uint32_t overlay_luma(void);

/** Calls overlay_luma(), replaces that immediate in memory, makes the caches coherent, and returns
 * the function's new result. */
uint32_t overlay_patch(uint32_t luma);

/** To be called once, before overlay_frame().
 * @param drawn the box is drawn at all
 * @param patched its luma becomes OVERLAY_LUMA_PATCHED by overlay_patch(); `fw_state.patched_value` has the result */
void overlay_start(int drawn, int patched, uint32_t pitch_bytes);

/** Draws the box into a result, if it is drawn and this frame shows it. */
void overlay_frame(uint8_t *out, uint32_t sequence);

#endif
