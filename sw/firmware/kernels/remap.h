/* Remap loops: out[n] = *(in + lut[n]) for whole 32-bit pixel pairs. */
#ifndef FOVEA_FIRMWARE_REMAP_H
#define FOVEA_FIRMWARE_REMAP_H

#include <stdint.h>

/** Copies `pairs` words to `out`; lut[n] is the byte offset of a source word from `in`. */
typedef void remap_loop_t(uint32_t *restrict out, const void *in, const uint32_t *restrict lut,
                          uint32_t pairs);

/** The paper's loop as compiled: load the entry, load the pair, store the pair. */
remap_loop_t remap_plain;

/** Eight pairs per iteration: the entries are loaded by LDM and the results stored by one STM of 32
 * bytes, which leaves the write buffer as one burst. Fastest if `out` is a multiple of 32; any word
 * address works. */
remap_loop_t remap_ldm;

#endif
