#include "offsets.h"

const char kOffsetsSpan[] = "a row of a strip reads from more than 64 KiB of the source";

static const char *encode_strip(const remap_picture_t *picture, remap_memory_t *memory, void *form,
                                uint32_t *black) {
  offsets_strip_t *const strip = form;
  uint32_t entries[REMAP_GROUPS_MAX * REMAP_GROUP];
  const uint32_t pairs = strip->strip.groups * REMAP_GROUP;
  const uint32_t row_bytes = 4u + 2u * pairs;
  uint8_t *row = remap_take(memory, picture->rows * row_bytes, 32);
  if (row == NULL) return kRemapNoMemory;
  strip->rows_at = (uint32_t)(row - memory->base);
  uint32_t base = 0;
  for (uint32_t v = 0; v < picture->rows; ++v, row += row_bytes) {
    *black += remap_visible_row(picture, v, strip->strip, base, entries);
    base = entries[0];
    uint32_t highest = entries[0];
    for (uint32_t i = 1; i < pairs; ++i) {
      if (entries[i] < base) base = entries[i];
      if (entries[i] > highest) highest = entries[i];
    }
    if (highest - base > UINT16_MAX) return kOffsetsSpan;
    *(uint32_t *)row = base;
    uint16_t *offsets = (uint16_t *)(row + 4);
    for (uint32_t i = 0; i < pairs; ++i) offsets[i] = (uint16_t)(entries[i] - base);
  }
  return NULL;
}

const remap_head_t *offsets_encode(const remap_picture_t *picture, uint32_t widest,
                                   remap_memory_t *memory, const char **refusal) {
  return remap_encode(picture, widest, memory, sizeof(offsets_strip_t), encode_strip, refusal);
}
