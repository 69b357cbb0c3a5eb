/* The LDM/STM loop over strips of the picture. Rows of a strip read fewer lines of the source than
 * whole rows do, so that lines are still in the D-cache when the next row needs them. */
#include "method.h"
#include "remap.h"
#include "sw/remap/picture.h"

#define WIDEST 9u /* groups */

static const char *prepare(remap_table_t *table, arena_t *arena) {
  (void)arena;
  table->encoded_bytes = table->width / 2u * table->height * sizeof(uint32_t);
  return NULL;
}

static void run(const remap_table_t *table, const void *in, void *out) {
  const uint32_t pairs = table->width / 2u;
  const uint32_t groups = (pairs + REMAP_GROUP - 1u) / REMAP_GROUP;
  const uint32_t strips = remap_strip_count(groups, WIDEST);
  for (uint32_t n = 0; n < strips; ++n) {
    const remap_strip_t strip = remap_strip_of(groups, strips, n);
    const uint32_t first = strip.first * REMAP_GROUP;
    const uint32_t end = first + strip.groups * REMAP_GROUP;
    const uint32_t count = (end < pairs ? end : pairs) - first;
    const uint32_t *lut = table->lut + first;
    uint8_t *to = (uint8_t *)out + first * 4u;
    for (uint32_t v = 0; v < table->height; ++v, lut += pairs, to += table->pitch_bytes)
      remap_ldm((uint32_t *)to, in, lut, count);
  }
}

const remap_method_t method_KERNEL_STRIPS = {"strips", prepare, run};
