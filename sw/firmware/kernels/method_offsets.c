/* 16-bit entries, in strips. */
#include "encoded.h"
#include "loop_ram.h"
#include "sw/remap/offsets.h"

static const char *prepare(remap_table_t *table, arena_t *arena) {
  static const uint8_t kWidest[] = {9, 5, 3, 2, 0};
  return encoded_prepare(table, arena, offsets_encode, kWidest);
}

static void run(const remap_table_t *table, const void *in, void *out) {
  const offsets_table_t *offsets = table->encoded;
  for (uint32_t n = 0; n < offsets->head.strips; ++n) {
    const offsets_strip_t *strip = &offsets->strip[n];
    uint32_t *to = encoded_begin(table, strip->strip, in, out);
    remap_offsets(to, encoded_at(table, strip->rows_at), LOOP_RAM);
  }
  encoded_black(table, out);
}

const remap_method_t method_KERNEL_OFFSETS = {"offsets16", prepare, run};
