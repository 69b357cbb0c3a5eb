/* 4-bit deltas, in strips; the deltas lie in the internal RAM. */
#include "encoded.h"
#include "loop_ram.h"
#include "sw/remap/deltas.h"

static const char *prepare(remap_table_t *table, arena_t *arena) {
  static const uint8_t kWidest[] = {12, 9, 5, 3, 2, 0};
  return encoded_prepare(table, arena, deltas_encode, kWidest);
}

static void run(const remap_table_t *table, const void *in, void *out) {
  const deltas_table_t *deltas = table->encoded;
  for (uint32_t n = 0; n < deltas->head.strips; ++n) {
    const deltas_strip_t *strip = &deltas->strip[n];
    copy_lines(LOOP_RAM->list.delta, strip->delta, sizeof strip->delta);
    uint32_t *to = encoded_begin(table, strip->strip, in, out);
    remap_deltas(to, encoded_at(table, strip->rows_at), LOOP_RAM);
  }
  encoded_black(table, out);
}

const remap_method_t method_KERNEL_DELTAS = {"deltas4", prepare, run};
