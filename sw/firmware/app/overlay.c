#include "overlay.h"

#ifndef FOVEA_HOST_TEST
#include "../drivers/cp15.h"
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
#endif
