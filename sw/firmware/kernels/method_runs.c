/* Run-length gather: neighbouring pairs that are equally spaced at the source are one transfer. The
 * lists are four words of each transfer's parameter set, and a control record for each piece. */
#include <stddef.h>

#include "../drivers/cp15.h"
#include "edma_pipes.h"

/* The lower queues are served first; with these shares all end at nearly the same time (measured).
 */
#define SHARES \
  { 9, 8, 8, 7 }

/* Encodes the picture in pieces as pipes->pieces says, into memory from `start` to `end`: control
 * records first, then runs.
 * @return the end of what is used; 0 if there is not enough memory, or 1 if a piece has too many
 * runs */
static uintptr_t encode(pipes_t *pipes, const remap_table_t *table, uintptr_t start,
                        uintptr_t end) {
  const remap_pieces_t *pieces = &pipes->pieces;
  const uint32_t row_pairs = table->width / 2u;
  pipes->controls = table->height * pieces->count;
  const uint32_t control_bytes = pipes->controls * PIPE_CONTROL_WORDS * 4u;
  if (end - start < control_bytes) return 0;
  uint32_t *control = (uint32_t *)start;
  remap_run_t *runs = (remap_run_t *)(start + control_bytes);
  pipes->lists[0] = (pipes_lists_t){.sources = (uint32_t *)runs, .control = control};
  for (uint32_t pipe = 0; pipe < PIPES; ++pipe) {
    pipes->first_entry[pipe] = (uint32_t)(control - pipes->lists[0].control) / PIPE_CONTROL_WORDS;
    const uint32_t end_row = pipe_row(pipes, table->height, pipe + 1u);
    for (uint32_t row = pipe_row(pipes, table->height, pipe); row < end_row; ++row)
      for (uint32_t piece = 0; piece < pieces->count; ++piece) {
        if (end - (uintptr_t)runs < PIPE_MOVES * sizeof *runs) return 0;
        const uint32_t n = remap_encode_runs(table->lut + row * row_pairs + piece * pieces->step,
                                             pieces->pairs, pipe_result(pipe), PIPE_MOVES, runs);
        if (n == 0) return 1;
        pipe_make_control(control, pipe, n, (uint32_t)runs);
        control += PIPE_CONTROL_WORDS;
        runs += n;
      }
  }
  pipes->entries = (uint32_t)(runs - (remap_run_t *)pipes->lists[0].sources);
  return (uintptr_t)runs;
}

static const char *prepare(remap_table_t *table, arena_t *arena) {
  const char *refusal = pipes_refuse(table);
  if (refusal != NULL) return refusal;
  pipes_t *pipes = arena_take(arena, sizeof *pipes, CACHE_LINE_BYTES);
  uint8_t *start = pipes != NULL ? arena_take(arena, 0, CACHE_LINE_BYTES) : NULL;
  if (start == NULL) return "no memory";
  *pipes = (pipes_t){.entry_words = sizeof(remap_run_t) / 4u, .shares = SHARES};
  /* Longer pieces cost less, but may have more runs than there are sets. Pieces that have as many
   * pairs as there are sets always fit. */
  uintptr_t used;
  uint32_t fewest = 1;
  do {
    pipes->pieces = remap_divide(table->width / 2u, REMAP_PIECE_MAX, fewest);
    fewest = pipes->pieces.count + 1u;
    used = encode(pipes, table, (uintptr_t)start, arena->end);
  } while (used == 1);
  if (used == 0) return "no memory";
  (void)arena_take(arena, used - (uintptr_t)start, CACHE_LINE_BYTES);
  pipes_make_ring(pipes, 0);
  pipes_finish(pipes, table, arena);
  return NULL;
}

const remap_method_t method_KERNEL_RUNS = {"runs", prepare, pipes_run};
