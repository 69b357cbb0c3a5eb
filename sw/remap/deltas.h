/* 4-bit deltas: four bits name the distance of a pair's entry from the one before. README.md
 * describes the form. */
#ifndef FOVEA_REMAP_DELTAS_H
#define FOVEA_REMAP_DELTAS_H

#include "picture.h"

#ifdef __cplusplus
extern "C" {
#endif

#define DELTAS_MAX 16u

typedef struct deltas_strip {
  remap_strip_t strip;
  uint32_t deltas;           /* number of them */
  int32_t delta[DELTAS_MAX]; /* bytes; 0 behind the last one */
  uint32_t rows_at; /* offset in the table, a multiple of 32. Each row has its base (32 bits, byte
                       offset into the source modulo 2^32, from which the first delta counts), then
                       a word for each 8 pairs: their numbers of deltas, four bits each, the first
                       pair's lowest, the whole rotated left by two bits */
} deltas_strip_t;

typedef struct deltas_table {
  remap_head_t head;
  deltas_strip_t strip[];
} deltas_table_t;

/** See remap_encode(): gives a deltas_table_t. */
remap_encode_t deltas_encode;

extern const char kDeltasTooMany[]; /* more than 16 different deltas in a strip */

#ifdef __cplusplus
}
#endif

#endif
