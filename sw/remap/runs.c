#include "runs.h"

#define PAIR_BYTES 4u

remap_pieces_t remap_divide(uint32_t pairs, uint32_t longest, uint32_t fewest) {
  uint32_t count = (pairs + longest - 1u) / longest;
  if (count < fewest) count = fewest;
  /* The last piece takes what the division leaves, and all have its length. */
  while (pairs - pairs / count * (count - 1u) > longest) ++count;
  const uint32_t step = pairs / count;
  return (remap_pieces_t){count, pairs - step * (count - 1u), step};
}

static uint32_t step_between(const uint32_t *sources, uint32_t from, uint32_t to) {
  return sources[to] - sources[from];
}

/* The index of a parameter set has 16 bits with sign. */
static int fits_index(uint32_t step) { return step + 0x8000u < 0x10000u; }

/* What begins at a pair: the longest run of single pairs, and the longest one of couples (0: none).
 */
typedef struct reach {
  uint16_t singles, couples; /* pairs */
} reach_t;

static reach_t reach_of(const uint32_t *sources, uint32_t pairs, uint32_t i,
                        const reach_t *behind) {
  reach_t r = {1, 0};
  if (i + 1u == pairs) return r;
  const uint32_t step = step_between(sources, i, i + 1u);
  if (!fits_index(step)) return r;
  const int goes_on = i + 2u < pairs && step_between(sources, i + 1u, i + 2u) == step;
  r.singles = goes_on ? (uint16_t)(behind[0].singles + 1u) : 2u;
  if (step != PAIR_BYTES) return r;
  r.couples = 2;
  if (i + 3u >= pairs || behind[1].couples == 0) return r;
  const uint32_t couple_step = step_between(sources, i, i + 2u);
  if (!fits_index(couple_step)) return r;
  const int couples_go_on =
      behind[1].couples >= 4u && step_between(sources, i + 2u, i + 4u) == couple_step;
  r.couples = couples_go_on ? (uint16_t)(behind[1].couples + 2u) : 4u;
  return r;
}

static remap_run_t run_at(const uint32_t *sources, uint32_t i, uint32_t destination, uint32_t bytes,
                          uint32_t arrays) {
  const uint32_t step =
      arrays > 1u ? step_between(sources, i, i + bytes / PAIR_BYTES) & 0xFFFFu : 0u;
  return (remap_run_t){sources[i], bytes | arrays << 16, destination + PAIR_BYTES * i,
                       step | bytes << 16};
}

uint32_t remap_encode_runs(const uint32_t *sources, uint32_t pairs, uint32_t destination,
                           uint32_t most, remap_run_t *runs) {
  reach_t reach[REMAP_PIECE_MAX + 1u];
  uint16_t rest[REMAP_PIECE_MAX + 1u]; /* runs from a pair to the end */
  struct {
    uint16_t pairs, bytes; /* of the run, and of its arrays */
  } run[REMAP_PIECE_MAX];  /* the one that begins at a pair */
  rest[pairs] = 0;
  for (uint32_t i = pairs; i-- > 0;) {
    reach[i] = reach_of(sources, pairs, i, &reach[i + 1u]);
    const uint32_t singles = i + reach[i].singles, couples = i + reach[i].couples;
    uint32_t end = singles;
    run[i].bytes = PAIR_BYTES;
    /* One pair alone leaves the next one to a couple or to a run with another step. */
    if (rest[i + 1u] < rest[end]) end = i + 1u;
    if (couples != i && rest[couples] < rest[end]) {
      end = couples;
      run[i].bytes = 2u * PAIR_BYTES;
    }
    run[i].pairs = (uint16_t)(end - i);
    rest[i] = (uint16_t)(rest[end] + 1u);
  }
  if (rest[0] > most) return 0;
  for (uint32_t i = 0, n = 0; i < pairs; i += run[i].pairs)
    runs[n++] =
        run_at(sources, i, destination, run[i].bytes, run[i].pairs * PAIR_BYTES / run[i].bytes);
  return rest[0];
}
