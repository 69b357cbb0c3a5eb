#include "deltas.h"

const char kDeltasTooMany[] = "more than 16 distances between neighbouring pairs in a strip";

/* The number of a delta, which is appended if it is new; DELTAS_MAX if there is no room. */
static uint32_t number_of(deltas_strip_t *strip, int32_t delta) {
  for (uint32_t n = 0; n < strip->deltas; ++n)
    if (strip->delta[n] == delta) return n;
  if (strip->deltas == DELTAS_MAX) return DELTAS_MAX;
  strip->delta[strip->deltas] = delta;
  return strip->deltas++;
}

static const char *encode_strip(const remap_picture_t *picture, remap_memory_t *memory, void *form,
                                uint32_t *black) {
  deltas_strip_t *const strip = form;
  uint32_t entries[REMAP_GROUPS_MAX * REMAP_GROUP];
  const uint32_t groups = strip->strip.groups;
  uint32_t *to = remap_take(memory, picture->rows * (1u + groups) * sizeof *to, 32);
  if (to == NULL) return kRemapNoMemory;
  strip->rows_at = (uint32_t)((uint8_t *)to - memory->base);
  strip->deltas = 0;
  for (uint32_t n = 0; n < DELTAS_MAX; ++n) strip->delta[n] = 0;
  /* The base of a row is free, so its first pair needs no delta of its own: it gets number 0, which
   * is the first distance within a row. */
  uint32_t start = 0;
  for (uint32_t v = 0; v < picture->rows; ++v) {
    *black += remap_visible_row(picture, v, strip->strip, start, entries);
    start = entries[0];
    uint32_t *const base = to++;
    const uint32_t *entry = entries;
    for (uint32_t g = 0; g < groups; ++g) {
      uint32_t word = 0;
      for (uint32_t i = 0; i < 32u; i += 4u, ++entry) {
        if (entry == entries) continue;
        const uint32_t n = number_of(strip, (int32_t)(entry[0] - entry[-1]));
        if (n == DELTAS_MAX) return kDeltasTooMany;
        word |= n << i;
      }
      *to++ = word << 2 | word >> 30;
    }
    *base = start - (uint32_t)strip->delta[0];
  }
  return NULL;
}

const remap_head_t *deltas_encode(const remap_picture_t *picture, uint32_t widest,
                                  remap_memory_t *memory, const char **refusal) {
  return remap_encode(picture, widest, memory, sizeof(deltas_strip_t), encode_strip, refusal);
}
