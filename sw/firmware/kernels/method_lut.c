/* The methods that read the look-up table itself. */
#include "method.h"
#include "remap.h"

static const char *prepare(remap_table_t *table, arena_t *arena) {
  (void)arena;
  table->encoded_bytes = table->width / 2u * table->height * sizeof(uint32_t);
  return NULL;
}

static void run(remap_loop_t *loop, const remap_table_t *table, const void *in, void *out) {
  const uint32_t pairs = table->width / 2u;
  if (table->pitch_bytes == table->width * 2u) {
    loop(out, in, table->lut, pairs * table->height);
    return;
  }
  for (uint32_t v = 0; v < table->height; ++v)
    loop((uint32_t *)((uint8_t *)out + v * table->pitch_bytes), in, table->lut + v * pairs, pairs);
}

static void run_plain(const remap_table_t *table, const void *in, void *out) {
  run(remap_plain, table, in, out);
}

static void run_ldm(const remap_table_t *table, const void *in, void *out) {
  run(remap_ldm, table, in, out);
}

const remap_method_t method_KERNEL_PLAIN = {"plain", prepare, run_plain};
const remap_method_t method_KERNEL_LDM = {"ldm", prepare, run_ldm};
