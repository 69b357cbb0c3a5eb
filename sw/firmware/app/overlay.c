#include "overlay.h"

#ifndef FOVEA_HOST_TEST
#include "../drivers/cp15.h"
#include "state.h"
#endif

void overlay_draw(uint8_t *frame, uint32_t pitch_bytes, uint8_t luma) {
  for (uint32_t v = OVERLAY_TOP; v < OVERLAY_TOP + OVERLAY_HEIGHT; ++v) {
    uint8_t *row = frame + v * pitch_bytes + OVERLAY_LEFT * 2u;
    for (uint32_t i = 1; i < OVERLAY_WIDTH * 2u; i += 2) /* byte order Cb Y Cr Y */
      row[i] = (uint8_t)((row[i] + luma) / 2u);
  }
}

#ifndef FOVEA_HOST_TEST
uint32_t overlay_patch(uint32_t luma) {
  /* A volatile pointer keeps the compiler from removing or merging the two calls. */
  uint32_t (*volatile function)(void) = overlay_luma;
  function(); /* brings the old instruction into the I-cache */
  /* Hides from the compiler that this is a function: it would access the word byte by byte. */
  volatile uint32_t *instruction;
  __asm__("" : "=r"(instruction) : "0"(overlay_luma));
  *instruction = (*instruction & ~0xFFu) | (luma & 0xFFu);
#ifndef OMIT_D_CLEAN
  dcache_clean_range((const void *)instruction, CACHE_LINE_BYTES);
#endif
#ifndef OMIT_I_INVALIDATE
  icache_invalidate_range((const void *)instruction, CACHE_LINE_BYTES);
#endif
  return function();
}

static struct {
  int drawn;
  uint32_t pitch_bytes;
  uint8_t luma;
} overlay;

void overlay_start(int drawn, int patched, uint32_t pitch_bytes) {
  overlay.drawn = drawn;
  overlay.pitch_bytes = pitch_bytes;
  overlay.luma = OVERLAY_LUMA;
  if (!patched) return;
  overlay.luma = (uint8_t)overlay_patch(OVERLAY_LUMA_PATCHED);
  fw_state.patched_value = overlay.luma;
}

void overlay_frame(uint8_t *out, uint32_t sequence) {
  if (overlay.drawn && overlay_visible(sequence))
    overlay_draw(out, overlay.pitch_bytes, overlay.luma);
}
#endif
