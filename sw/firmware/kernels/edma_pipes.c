#include "edma_pipes.h"

#include <stddef.h>

#include "../drivers/cp15.h"
#include "../regs.h"
#include "edma_wait.h"
#include "internal_ram.h"

/* Channels of a pipe. GATHER and LOAD are neighbours: a control record is written across both. */
enum { BOOT, CONTROL, GATHER, LOAD, STORE };
#define FIRST_CHANNEL 32u
#define CHANNELS_OF_PIPE 8u
/* Sets of the ring: what GATHER starts from in each piece, what follows the last piece, and then
 * the moves, of which the last ones are in use. */
enum { ENTRY, FINISH, FIRST_MOVE };

#define RESULT_BASE RAM_BANK1_BASE
#define SCRATCH_BASE (RESULT_BASE + PIPES * PIPE_PIECE_BYTES)
_Static_assert(SCRATCH_BASE + 4u * PIPES <= RAM_BANK1_END, "the pipes' memory is not in the bank");

static uint32_t channel(uint32_t pipe, uint32_t which) {
  return FIRST_CHANNEL + CHANNELS_OF_PIPE * pipe + which;
}

static uint32_t ring_set(uint32_t pipe, uint32_t n) { return EDMA_CHANNELS + PIPE_SETS * pipe + n; }

uint32_t pipe_set(uint32_t pipe, uint32_t n, uint32_t moves) {
  return ring_set(pipe, PIPE_SETS - moves + n);
}

uint32_t pipe_result(uint32_t pipe) { return RESULT_BASE + PIPE_PIECE_BYTES * pipe; }

const char *pipes_refuse(const remap_table_t *table) {
  return table->pitch_bytes > 0x7FFFu ? "a row is beyond an index of 16 bits" : NULL;
}

uint32_t pipe_row(const pipes_t *pipes, uint32_t height, uint32_t pipe) {
  uint32_t before = 0, all = 0;
  for (uint32_t n = 0; n < PIPES; ++n) {
    if (n < pipe) before += pipes->shares[n];
    all += pipes->shares[n];
  }
  return height * before / all;
}

/* The codes by which the pipes that have rows report their end. */
static edma_codes_t codes_of(const pipes_t *pipes, uint32_t height) {
  edma_codes_t codes = {channel(0, CONTROL), CHANNELS_OF_PIPE, 0};
  for (uint32_t pipe = 0; pipe < PIPES; ++pipe)
    if (pipe_row(pipes, height, pipe + 1u) > pipe_row(pipes, height, pipe))
      codes.mask |= 1u << pipe;
  return codes;
}

static void make_ring(edma_set_t *ring, uint32_t pipe, uint32_t moves) {
  const uint32_t gather = channel(pipe, GATHER);
  const uint32_t used = moves != 0 ? moves : PIPE_MOVES;
  /* A dummy set: moves nothing, reports at once, and is replaced by the first move. */
  ring[ENTRY] = (edma_set_t){.options = EDMA_CODE(gather) | EDMA_CHAIN,
                             .counts = EDMA_PAIR(4, 0),
                             .link = EDMA_LINK(pipe_set(pipe, 0, used)),
                             .frames = 1};
  /* Its read follows the last piece's through the same transfer controller, whose writes keep their
   * order: when it reports, the whole result has been written. */
  ring[FINISH] = (edma_set_t){.options = EDMA_CODE(channel(pipe, CONTROL)) | EDMA_INTERRUPT,
                              .source = pipe_result(pipe),
                              .counts = EDMA_PAIR(4, 1),
                              .destination = SCRATCH_BASE + 4u * pipe,
                              .link = EDMA_NO_LINK,
                              .frames = 1};
  for (uint32_t n = FIRST_MOVE; n < PIPE_SETS; ++n) {
    const int last = n + 1u == PIPE_SETS;
    ring[n] = (edma_set_t){
        .options = EDMA_AB_SYNC | EDMA_CHAIN |
                   (last ? EDMA_CODE(channel(pipe, STORE)) : EDMA_CODE(gather) | EDMA_EARLY),
        .counts = EDMA_PAIR(4, 1),
        .destination = pipe_result(pipe) + 4u * (n - (PIPE_SETS - used)),
        .link = EDMA_LINK(ring_set(pipe, last ? (uint32_t)ENTRY : n + 1u)),
        .frames = 1};
  }
}

void pipes_make_ring(pipes_t *pipes, uint32_t moves) {
  for (uint32_t pipe = 0; pipe < PIPES; ++pipe) make_ring(pipes->ring[pipe], pipe, moves);
}

/* The record covers the last three words of GATHER's set and the first five of LOAD's. */
void pipe_make_control(uint32_t *record, uint32_t pipe, uint32_t moves, uint32_t sources_address) {
  record[0] = EDMA_LINK(pipe_set(pipe, 0, moves));
  record[1] = 0;
  record[2] = 1; /* frames of the dummy set */
  record[3] = EDMA_STATIC | EDMA_AB_SYNC | EDMA_CHAIN | EDMA_CODE(channel(pipe, GATHER));
  record[PIPE_CONTROL_SOURCE] = sources_address;
  record[5] = EDMA_PAIR(sizeof(remap_run_t), moves);
  record[6] = EDMA_PARAM_SRC(pipe_set(pipe, 0, moves));
  record[7] = EDMA_PAIR(sizeof(remap_run_t), sizeof(edma_set_t));
}

/* Writes lists for a source frame from lists for another one; both may be the same memory. */
static void rebase(const pipes_t *pipes, pipes_lists_t *to, const pipes_lists_t *from,
                   uint32_t base) {
  const uint32_t distance = base - from->base;
  if (pipes->controls == 0) {
    for (uint32_t n = 0; n < pipes->entries; ++n) to->sources[n] = from->sources[n] + distance;
  } else {
    const remap_run_t *run = (const remap_run_t *)from->sources;
    remap_run_t *moved = (remap_run_t *)to->sources;
    for (uint32_t n = 0; n < pipes->entries; ++n) {
      remap_run_t r = run[n];
      r.source += distance;
      moved[n] = r;
    }
  }
  if (to != from) {
    const uint32_t lists = (uint32_t)to->sources - (uint32_t)from->sources;
    for (uint32_t n = 0; n < pipes->controls * PIPE_CONTROL_WORDS; ++n)
      to->control[n] =
          from->control[n] + (n % PIPE_CONTROL_WORDS == PIPE_CONTROL_SOURCE ? lists : 0u);
  }
  to->base = base;
  to->taken = 1;
  dcache_clean_all();
}

/* The lists for a source frame; some are changed if there are none. */
static const pipes_lists_t *lists_for(pipes_t *pipes, uint32_t base) {
  for (uint32_t n = 0; n < pipes->list_count; ++n)
    if (pipes->lists[n].taken && pipes->lists[n].base == base) return &pipes->lists[n];
  pipes_lists_t *lists = &pipes->lists[pipes->next];
  pipes->next = (pipes->next + 1u) % pipes->list_count;
  rebase(pipes, lists, lists->taken ? lists : &pipes->lists[0], base);
  return lists;
}

void pipes_finish(pipes_t *pipes, remap_table_t *table, arena_t *arena) {
  const uint32_t sources = pipes->entries * pipes->entry_words * 4u;
  const uint32_t control = pipes->controls * PIPE_CONTROL_WORDS * 4u;
  pipes->list_count = 1;
  while (!table->in_turn && pipes->list_count < IN_COUNT &&
         sources + control <= (arena->end - arena->next) / 2u) {
    pipes_lists_t *lists = &pipes->lists[pipes->list_count];
    *lists = (pipes_lists_t){.sources = arena_take(arena, sources, CACHE_LINE_BYTES)};
    if (lists->sources == NULL) break;
    if (control != 0) {
      lists->control = arena_take(arena, control, CACHE_LINE_BYTES);
      if (lists->control == NULL) break;
    }
    ++pipes->list_count;
  }
  table->encoded = pipes;
  table->encoded_bytes = sources + control + (uint32_t)sizeof pipes->ring;
  /* A list for each source frame, so that the first frames need not wait for it. The first lists
   * are those that the others are made from. */
  if (frame_stride != 0)
    for (uint32_t n = pipes->list_count; n-- > 0;)
      rebase(pipes, &pipes->lists[n], &pipes->lists[0], (uint32_t)frame_in + n * frame_stride);
  edma_wait_prepare(codes_of(pipes, table->height));
}

/* Writes the sets of a pipe's channels and triggers the first one. */
static void start_pipe(const pipes_t *pipes, uint32_t pipe, const remap_table_t *table,
                       const pipes_lists_t *lists, uint32_t out) {
  const remap_pieces_t *pieces = &pipes->pieces;
  const uint32_t first_row = pipe_row(pipes, table->height, pipe);
  const uint32_t rows = pipe_row(pipes, table->height, pipe + 1u) - first_row;
  const uint32_t feeder = channel(pipe, pipes->controls != 0 ? CONTROL : LOAD);
  for (uint32_t which = BOOT; which <= STORE; ++which) edma_map(channel(pipe, which), pipe);

  const edma_set_t boot = {.options = EDMA_CODE(feeder) | EDMA_CHAIN,
                           .source = (uint32_t)pipes->ring[pipe],
                           .counts = EDMA_PAIR(sizeof pipes->ring[pipe], 1),
                           .destination = EDMA_PARAM_OPT(ring_set(pipe, 0)),
                           .link = EDMA_NO_LINK,
                           .frames = 1};
  edma_write_set(channel(pipe, BOOT), &boot);
  edma_write_set(channel(pipe, GATHER), &pipes->ring[pipe][ENTRY]);

  edma_set_t load = {.link = EDMA_NO_LINK,
                     .frames = 1}; /* with control records nothing else counts */
  if (pipes->controls != 0) {
    const uint32_t record = PIPE_CONTROL_WORDS * 4u;
    const edma_set_t control = {
        .options = EDMA_AB_SYNC | EDMA_CODE(channel(pipe, LOAD)) | EDMA_CHAIN | EDMA_CHAIN_EACH,
        .source = (uint32_t)lists->control + record * pipes->first_entry[pipe],
        .counts = EDMA_PAIR(record, 1),
        .destination = EDMA_PARAM_LINK_BCNTRLD(channel(pipe, GATHER)),
        .link = EDMA_LINK(ring_set(pipe, FINISH)),
        .frame_steps = EDMA_PAIR(record, 0),
        .frames = rows * pieces->count};
    edma_write_set(channel(pipe, CONTROL), &control);
  } else {
    load = (edma_set_t){
        .options = EDMA_AB_SYNC | EDMA_CODE(channel(pipe, GATHER)) | EDMA_CHAIN | EDMA_CHAIN_EACH,
        .source = (uint32_t)lists->sources + 4u * pipes->first_entry[pipe],
        .counts = EDMA_PAIR(4, pieces->pairs),
        .destination = EDMA_PARAM_SRC(pipe_set(pipe, 0, pieces->pairs)),
        .array_steps = EDMA_PAIR(4, sizeof(edma_set_t)),
        .link = EDMA_LINK(ring_set(pipe, FINISH)),
        .frame_steps = EDMA_PAIR(4u * pieces->pairs, 0),
        .frames = rows * pieces->count};
  }
  edma_write_set(channel(pipe, LOAD), &load);

  const uint32_t piece_step = 4u * pieces->step;
  const edma_set_t store = {
      .options = EDMA_CODE(feeder) | EDMA_CHAIN | EDMA_CHAIN_EACH | EDMA_EARLY,
      .source = pipe_result(pipe),
      .counts = EDMA_PAIR(4u * pieces->pairs, pieces->count),
      .destination = out + table->pitch_bytes * first_row,
      .array_steps = EDMA_PAIR(0, piece_step),
      .link = EDMA_PAIR(EDMA_NO_LINK, pieces->count),
      .frame_steps = EDMA_PAIR(0, table->pitch_bytes - piece_step * (pieces->count - 1u)),
      .frames = rows};
  edma_write_set(channel(pipe, STORE), &store);
  edma_start(channel(pipe, BOOT));
}

void pipes_run(const remap_table_t *table, const void *in, void *out) {
  pipes_t *const pipes = (pipes_t *)(uintptr_t)table->encoded; /* its lists follow the frames */
  const pipes_lists_t *lists = lists_for(pipes, (uint32_t)in);
  /* The core may still have lines of an earlier result, which it has drawn on. */
  dcache_invalidate_range(out, table->height * table->pitch_bytes);
  const edma_codes_t codes = codes_of(pipes, table->height);
  for (uint32_t pipe = 0; pipe < PIPES; ++pipe)
    if (codes.mask >> pipe & 1u) start_pipe(pipes, pipe, table, lists, (uint32_t)out);
  edma_wait_all(codes);
}
