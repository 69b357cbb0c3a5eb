/* 16-bit entries: for each row of a strip a base, for each pair its offset from it. README.md
 * describes the form. */
#ifndef FOVEA_REMAP_OFFSETS_H
#define FOVEA_REMAP_OFFSETS_H

#include "picture.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct offsets_strip {
  remap_strip_t strip;
  uint32_t
      rows_at; /* offset in the table, a multiple of 32. Each row has its base (32 bits, byte offset
                  into the source), then 16 bits for each pair: byte offset from the base */
} offsets_strip_t;

typedef struct offsets_table {
  remap_head_t head;
  offsets_strip_t strip[];
} offsets_table_t;

/** See remap_encode(): gives a offsets_table_t. */
remap_encode_t offsets_encode;

extern const char kOffsetsSpan[]; /* the entries of a row of a strip differ by 64 KiB or more */

#ifdef __cplusplus
}
#endif

#endif
