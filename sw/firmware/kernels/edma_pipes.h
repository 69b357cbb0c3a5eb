/* Four pipes, one for each transfer controller of the EDMA, through which the rows of a picture are
 * corrected without the core: each takes a part of the rows, piece by piece. The pieces are encoded
 * as lists in SDRAM; README.md, "Remap by the EDMA", describes them and the channels. */
#ifndef FOVEA_FIRMWARE_EDMA_PIPES_H
#define FOVEA_FIRMWARE_EDMA_PIPES_H

#include <stdint.h>

#include "../app/state.h"
#include "../drivers/edma.h"
#include "method.h"
#include "sw/remap/runs.h"

#define PIPES EDMA_QUEUES
#define PIPE_SETS 48u               /* a quarter of the sets that belong to no channel */
#define PIPE_MOVES (PIPE_SETS - 2u) /* transfers of a piece, at most */
#define PIPE_PIECE_BYTES 1024u      /* internal RAM for the result of a piece */

/** One set of lists: for one source frame, since they contain addresses. */
typedef struct pipes_lists {
  uint32_t *sources; /* pipes_t::entries groups of pipes_t::entry_words words; the first one of each
                        group is a source address */
  uint32_t *control; /* pipes_t::controls records of PIPE_CONTROL_WORDS words; null pointer: none */
  uint32_t base;     /* address of the source frame; 0: the lists contain offsets so far */
  int taken;         /* `base` is a frame's */
} pipes_lists_t;

#define PIPE_CONTROL_WORDS 8u
#define PIPE_CONTROL_SOURCE 4u /* the one that holds an address of `sources` */

/** In `encoded` of a remap_table_t. */
typedef struct pipes {
  edma_set_t ring[PIPES][PIPE_SETS]; /* as they are loaded for each frame; first, to be aligned */
  remap_pieces_t pieces;
  uint8_t shares[PIPES]; /* parts of the rows */
  uint32_t entries, entry_words, controls;
  uint32_t first_entry[PIPES]; /* where the pipe's part of the sources begins; without control */
  uint32_t list_count;         /* of `lists` in use */
  uint32_t next;               /* the lists that are changed next if no frame's are right */
  pipes_lists_t lists[IN_COUNT];
} pipes_t;

/** The first row of a pipe; that of pipe PIPES is the height. A pipe may have no rows. */
uint32_t pipe_row(const pipes_t *pipes, uint32_t height, uint32_t pipe);

/** A picture that no pipe method takes, or a null pointer. */
const char *pipes_refuse(const remap_table_t *table);

/** The number of the parameter set that a piece's move n of `moves` is loaded into. */
uint32_t pipe_set(uint32_t pipe, uint32_t n, uint32_t moves);

/** Where the EDMA finds the result of the pipe's piece. */
uint32_t pipe_result(uint32_t pipe);

/** Fills `ring` except for the words that the lists bring. `moves`: transfers of each piece, or 0
 * if the lists say that. */
void pipes_make_ring(pipes_t *pipes, uint32_t moves);

/** One record of `control`: how the moves of a piece get into their sets. */
void pipe_make_control(uint32_t *record, uint32_t pipe, uint32_t moves, uint32_t sources_address);

/** Takes memory for as many further lists as there may be source frames, but not more than half of
 * what is left, and none if other tables need it; switches the EDMA on. The first lists must be
 * complete. */
void pipes_finish(pipes_t *pipes, remap_table_t *table, arena_t *arena);

/** The `run` of both methods. */
void pipes_run(const remap_table_t *table, const void *in, void *out);

#endif
