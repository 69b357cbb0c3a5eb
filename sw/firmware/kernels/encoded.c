#include "encoded.h"

#include "loop_ram.h"

const char *encoded_prepare(remap_table_t *table, arena_t *arena, remap_encode_t *encode,
                            const uint8_t *widest) {
  const remap_picture_t picture = {table->width / 2u, table->height, table->pitch_bytes,
                                   table->lut, table->source_height};
  const char *refusal = kRemapNoMemory;
  for (; *widest != 0; ++widest) {
    arena_t trial = *arena;
    uint8_t *base = arena_take(&trial, 0, 32);
    if (base == NULL) return kRemapNoMemory;
    remap_memory_t memory = {base, 0, trial.end - trial.next};
    const remap_head_t *head = encode(&picture, *widest, &memory, &refusal);
    if (head == NULL) continue;
    table->encoded = arena_take(arena, head->bytes, 32);
    table->encoded_bytes = head->bytes;
    return NULL;
  }
  return refusal;
}

uint32_t *encoded_begin(const remap_table_t *table, remap_strip_t strip, const void *base,
                        void *out) {
  loop_ram_t *const ram = LOOP_RAM;
  ram->base = base;
  ram->rows = table->height;
  ram->gap = table->pitch_bytes - strip.groups * REMAP_GROUP * 4u;
  ram->groups = strip.groups;
  return (uint32_t *)out + strip.first * REMAP_GROUP;
}

void encoded_black(const remap_table_t *table, void *out) {
  const remap_head_t *head = table->encoded;
  remap_black(out, encoded_at(table, head->black_at));
}
