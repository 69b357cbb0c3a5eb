/* Full gather: every pair of pixels is a transfer of 4 bytes of its own. The lists are source
 * addresses. */
#include <stddef.h>

#include "../drivers/cp15.h"
#include "edma_pipes.h"

/* The channel controller binds, and serves the lower queue first: the pipes of the lower queues run
 * at their full speed, and the others take what is left. With these shares all end at nearly the
 * same time (measured). */
#define SHARES \
  { 7, 5, 3, 1 }

/* Offsets in the order in which the pipes take the pairs. */
static void fill(pipes_t *pipes, const remap_table_t *table) {
  const uint32_t row_pairs = table->width / 2u;
  uint32_t *next = pipes->lists[0].sources;
  for (uint32_t pipe = 0; pipe < PIPES; ++pipe) {
    pipes->first_entry[pipe] = (uint32_t)(next - pipes->lists[0].sources);
    const uint32_t end_row = pipe_row(pipes, table->height, pipe + 1u);
    for (uint32_t row = pipe_row(pipes, table->height, pipe); row < end_row; ++row)
      for (uint32_t piece = 0; piece < pipes->pieces.count; ++piece) {
        const uint32_t *from = table->lut + row * row_pairs + piece * pipes->pieces.step;
        for (uint32_t n = 0; n < pipes->pieces.pairs; ++n) *next++ = from[n];
      }
  }
}

static const char *prepare(remap_table_t *table, arena_t *arena) {
  const char *refusal = pipes_refuse(table);
  if (refusal != NULL) return refusal;
  pipes_t *pipes = arena_take(arena, sizeof *pipes, CACHE_LINE_BYTES);
  if (pipes == NULL) return "no memory";
  *pipes = (pipes_t){
      .pieces = remap_divide(table->width / 2u, PIPE_MOVES, 1), .entry_words = 1, .shares = SHARES};
  pipes->entries = pipes->pieces.count * pipes->pieces.pairs * table->height;
  pipes->lists[0].sources = arena_take(arena, 4u * pipes->entries, CACHE_LINE_BYTES);
  if (pipes->lists[0].sources == NULL) return "no memory";
  pipes_make_ring(pipes, pipes->pieces.pairs);
  fill(pipes, table);
  pipes_finish(pipes, table, arena);
  return NULL;
}

const remap_method_t method_KERNEL_GATHER = {"gather", prepare, pipes_run};
