/* What the loops of the encoded tables keep in the internal RAM: a look-up there costs neither a
 * line of the D-cache nor a use of the core's data port. Filled for each strip by run(). */
#ifndef FOVEA_FIRMWARE_LOOP_RAM_H
#define FOVEA_FIRMWARE_LOOP_RAM_H

/* Offsets from `list`, for the assembly. */
#define LOOP_BASE -16
#define LOOP_ROWS -12
#define LOOP_GAP -8
#define LOOP_GROUPS -4 /* once the loop runs: address of its entry into the unrolled row */

#ifndef __ASSEMBLER__
#include <stdint.h>

#include "internal_ram.h"
#include "sw/remap/codes.h"
#include "sw/remap/deltas.h"

typedef struct loop_ram {
  const void *base; /* of the source; codes: of the row above */
  uint32_t rows;    /* left; at least 1 */
  uint32_t
      gap; /* bytes from the end of a row of the strip to the start of the next, in the result */
  uint32_t groups; /* in a row, 1 to REMAP_GROUPS_MAX */
  union {
    codes_pattern_t pattern[CODES_PATTERNS_MAX];
    int32_t delta[DELTAS_MAX];
  } list;
} loop_ram_t;

#define LOOP_RAM ((loop_ram_t *)RAM_WORK_BASE)

/** Corrects one strip. The loops are unrolled for a row of REMAP_GROUPS_MAX groups and entered
 * where as many are left as the strip has. All groups are stored whole, so that a row may be
 * written up to the end of its pitch.
 * @param out the strip's first pair of the result, a multiple of 32
 * @param rows the strip's rows, in the form that the loop reads
 * @param ram prepared; changed by the loop */
typedef void remap_strip_loop_t(uint32_t *out, const void *rows, loop_ram_t *ram);

remap_strip_loop_t remap_codes;   /* sw/remap/codes.h; list.pattern */
remap_strip_loop_t remap_offsets; /* sw/remap/offsets.h */
remap_strip_loop_t remap_deltas;  /* sw/remap/deltas.h; list.delta */

/** Copies `bytes` bytes, a multiple of 32, both addresses multiples of 4. */
void copy_lines(void *to, const void *from, uint32_t bytes);

/** Writes the black runs of a table. */
void remap_black(uint32_t *out, const remap_black_run_t *runs);
#endif

#endif
