/* The frame as it is: one transfer of two dimensions for each transfer controller. */
#include <stddef.h>

#include "../drivers/cp15.h"
#include "../drivers/edma.h"
#include "edma_wait.h"
#include "method.h"

#define FIRST_CHANNEL 32u

static const edma_codes_t kCodes = {FIRST_CHANNEL, 1, (1u << EDMA_QUEUES) - 1u};

static const char *prepare(remap_table_t *table, arena_t *arena) {
  (void)arena;
  if (remap_two_sizes(table)) return REMAP_TWO_SIZES;
  if (table->height < EDMA_QUEUES) return "fewer than 4 rows";
  if (table->pitch_bytes > 0x7FFFu) return "a row is beyond an index of 16 bits";
  table->encoded_bytes = 0;
  edma_wait_prepare(kCodes);
  return NULL;
}

static void run(const remap_table_t *table, const void *in, void *out) {
  /* The core may still have lines of an earlier result, which it has drawn on. */
  dcache_invalidate_range(out, table->height * table->pitch_bytes);
  for (uint32_t n = 0; n < EDMA_QUEUES; ++n) {
    const uint32_t first = table->height * n / EDMA_QUEUES;
    const uint32_t rows = table->height * (n + 1u) / EDMA_QUEUES - first;
    const uint32_t offset = first * table->pitch_bytes, channel = FIRST_CHANNEL + n;
    const edma_set_t set = {.options = EDMA_AB_SYNC | EDMA_INTERRUPT | EDMA_CODE(channel),
                            .source = (uint32_t)in + offset,
                            .counts = EDMA_PAIR(table->width * 2u, rows),
                            .destination = (uint32_t)out + offset,
                            .array_steps = EDMA_PAIR(table->pitch_bytes, table->pitch_bytes),
                            .link = EDMA_NO_LINK,
                            .frames = 1};
    edma_map(channel, n);
    edma_write_set(channel, &set);
    edma_start(channel);
  }
  edma_wait_all(kCodes);
}

const remap_method_t method_KERNEL_COPY = {"copy", prepare, run};
