/* Remap tables for a DMA controller: a row is divided into pieces of equal length, and the pairs of
 * a piece into runs, each of which one transfer of two dimensions moves. Portable C11 without a
 * library. */
#ifndef FOVEA_REMAP_RUNS_H
#define FOVEA_REMAP_RUNS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Equal pieces of a row: `count` pieces of `pairs` pairs each, whose starts are `step` pairs
 * apart. Together they are the row; the last ones may overlap. */
typedef struct remap_pieces {
  uint32_t count, pairs, step;
} remap_pieces_t;

/** Divides a row of `pairs` pairs into as few pieces of at most `longest` pairs as possible, but
 * into at least `fewest`. All three are at least 1, and `fewest` is at most `pairs`. */
remap_pieces_t remap_divide(uint32_t pairs, uint32_t longest, uint32_t fewest);

/** One transfer: `arrays` arrays of `bytes` bytes (4 or 8), which lie one behind the other at the
 * destination, and whose starts are `step` bytes apart at the source. The members are the words
 * SRC, A_B_CNT, DST and SRC_DST_BIDX of the EDMA3's parameter set (SPRUH82C). */
typedef struct remap_run {
  uint32_t source;
  uint32_t counts; /* bytes | arrays << 16 */
  uint32_t destination;
  uint32_t steps; /* (step & 0xFFFF) | bytes << 16; the step is signed */
} remap_run_t;

#define REMAP_PIECE_MAX 256u /* pairs of a piece that can be encoded in runs */

/** Encodes a piece in runs of pairs that are equally spaced at the source, or of couples of
 * neighbouring pairs that are. Each run goes on as long as it can or has one pair; among those
 * divisions it is one with the fewest runs.
 * @param sources the pairs' addresses, or offsets from any base
 * @param pairs number of pairs, 1 to REMAP_PIECE_MAX
 * @param destination where the first pair goes
 * @param runs receives them in the order of the destination
 * @return their number; 0 if they are more than `most`: nothing is written then */
uint32_t remap_encode_runs(const uint32_t *sources, uint32_t pairs, uint32_t destination,
                           uint32_t most, remap_run_t *runs);

#ifdef __cplusplus
}
#endif

#endif
