/* Byte codes: a byte names the offsets of four pairs. README.md describes the form. */
#ifndef FOVEA_REMAP_CODES_H
#define FOVEA_REMAP_CODES_H

#include "picture.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CODES_PATTERNS_MAX 256u

/** Four pairs: byte offsets of their entries from the entry of the pair before them. */
typedef struct codes_pattern {
  int32_t offset[4];
} codes_pattern_t;

typedef struct codes_strip {
  remap_strip_t strip;
  uint32_t patterns;   /* number of them */
  uint32_t pattern_at; /* codes_pattern_t[patterns], offset in the table, a multiple of 32;
 followed by one of zeros if the number is odd */
  uint32_t stream_at;  /* the rows, offset in the table, a multiple of 32. Each row has 2 bytes, the
                          signed step of its base in words, then a code for each 4 pairs */
  uint32_t first_base; /* base that the first row's step is added to: byte offset into the source,
                          modulo 2^32. A row's first pattern counts from the row's base */
} codes_strip_t;

typedef struct codes_table {
  remap_head_t head;
  codes_strip_t strip[];
} codes_table_t;

/** See remap_encode(): gives a codes_table_t. */
remap_encode_t codes_encode;

extern const char kCodesTooMany[]; /* more than 256 patterns in a strip */
extern const char
    kCodesRowStep[]; /* the step between the bases of two rows has more than 16 bits */

#ifdef __cplusplus
}
#endif

#endif
