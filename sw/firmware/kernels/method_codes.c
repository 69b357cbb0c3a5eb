/* Byte codes: the patterns of a strip lie in the internal RAM while it is corrected. */
#include "encoded.h"
#include "loop_ram.h"
#include "sw/remap/codes.h"

static const char *prepare(remap_table_t *table, arena_t *arena) {
  static const uint8_t kWidest[] = {12, 9, 5, 3, 0};
  return encoded_prepare(table, arena, codes_encode, kWidest);
}

static void run(const remap_table_t *table, const void *in, void *out) {
  const codes_table_t *codes = table->encoded;
  for (uint32_t n = 0; n < codes->head.strips; ++n) {
    const codes_strip_t *strip = &codes->strip[n];
    copy_lines(LOOP_RAM->list.pattern, encoded_at(table, strip->pattern_at),
               (strip->patterns + 1u) / 2u * 2u * sizeof(codes_pattern_t));
    uint32_t *to = encoded_begin(table, strip->strip, (const uint8_t *)in + strip->first_base, out);
    remap_codes(to, encoded_at(table, strip->stream_at), LOOP_RAM);
  }
  encoded_black(table, out);
}

const remap_method_t method_KERNEL_CODES = {"codes", prepare, run};
