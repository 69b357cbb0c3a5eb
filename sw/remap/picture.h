/* What the encoders of remap tables share: the look-up table as they read it, its division into
 * strips, and black pairs. Portable C11 without a library; README.md describes the forms of the
 * tables. */
#ifndef FOVEA_REMAP_PICTURE_H
#define FOVEA_REMAP_PICTURE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define REMAP_GROUP 8u /* pairs that are stored at once: 32 bytes */
#define REMAP_GROUPS_MAX \
  15u /* groups in a row of a strip, at most: what the loops are unrolled for */

/** A look-up table as sw/lens builds it. */
typedef struct remap_picture {
  uint32_t pairs, rows; /* of the result; pairs * 4 <= pitch_bytes */
  uint32_t pitch_bytes; /* of source and result; a multiple of 32 */
  const uint32_t *lut;  /* pairs * rows byte offsets into the source, row by row */
  uint32_t source_rows; /* the entry source_rows * pitch_bytes stands for black */
} remap_picture_t;

/** Groups of 8 pairs in a row. The last group may have fewer; it ends within the pitch. */
static inline uint32_t remap_groups(const remap_picture_t *picture) {
  return (picture->pairs + REMAP_GROUP - 1u) / REMAP_GROUP;
}

/** A strip is the same range of groups in all rows. */
typedef struct remap_strip {
  uint32_t first, groups;
} remap_strip_t;

/** Number of strips of at most `widest` groups. */
static inline uint32_t remap_strip_count(uint32_t groups, uint32_t widest) {
  return (groups + widest - 1u) / widest;
}

/** Strip n of `count`: their widths differ by one group at most. */
static inline remap_strip_t remap_strip_of(uint32_t groups, uint32_t count, uint32_t n) {
  const uint32_t first = n * groups / count;
  return (remap_strip_t){first, (n + 1u) * groups / count - first};
}

/** Copies one row of a strip to `entries`, groups * 8 of them, so that none is black: a black pair,
 * and a pair behind the end of the row, gets the entry of the visible pair before it in this row of
 * the strip, or else of the first visible one behind it; a row without any gets `otherwise`.
 * @return the number of black pairs, without those behind the end of the row */
uint32_t remap_visible_row(const remap_picture_t *picture, uint32_t row, remap_strip_t strip,
                           uint32_t otherwise, uint32_t *entries);

/** The first entry of a strip that is not black; 4 if there is none. */
uint32_t remap_first_visible(const remap_picture_t *picture, remap_strip_t strip);

/** Memory that an encoder fills from the beginning. Addresses are offsets from `base`, which is a
 * multiple of 32, so that a table works wherever it lies. */
typedef struct remap_memory {
  uint8_t *base;
  size_t used, bytes;
} remap_memory_t;

/** The next `bytes` bytes at a multiple of `alignment` (a power of two), not cleared. Returns a
 * null pointer if there is not enough left. */
void *remap_take(remap_memory_t *memory, size_t bytes, size_t alignment);

/** A run of black pairs: so many words behind the end of the run before, or behind the start of the
 * result; then so many black words. A list ends with {0, 0}. */
typedef struct remap_black_run {
  uint16_t skip, words;
} remap_black_run_t;

/** Lists the black pairs of a picture that has so many of them.
 * @return the list, or a null pointer if the memory is full */
const remap_black_run_t *remap_list_black(const remap_picture_t *picture, uint32_t count,
                                          remap_memory_t *memory);

/** What every table begins with. */
typedef struct remap_head {
  uint32_t bytes; /* of the whole table */
  uint32_t rows;
  uint32_t strips;
  uint32_t black_at; /* remap_black_run_t[], offset in the table */
} remap_head_t;

/** Encodes one strip: fills `form`, the strip's part of the table, behind its remap_strip_t, and
 * takes memory for the rest. Adds the number of black pairs to `black`.
 * @return a null pointer, or the reason why the strip cannot be encoded */
typedef const char *remap_encode_strip_t(const remap_picture_t *picture, remap_memory_t *memory,
                                         void *form, uint32_t *black);

/** Encodes a picture in strips of at most `widest` groups, from 1 to REMAP_GROUPS_MAX. The table is
 * a remap_head_t, then `form_bytes` bytes for each strip, which begin with its remap_strip_t, then
 * what `encode` takes, then the black runs.
 * @param memory where the table begins: at its base, nothing used
 * @param refusal is set to the reason if the picture cannot be encoded
 * @return the table, or a null pointer */
const remap_head_t *remap_encode(const remap_picture_t *picture, uint32_t widest,
                                 remap_memory_t *memory, size_t form_bytes,
                                 remap_encode_strip_t *encode, const char **refusal);

/** An encoder of a certain form. */
typedef const remap_head_t *remap_encode_t(const remap_picture_t *picture, uint32_t widest,
                                           remap_memory_t *memory, const char **refusal);

extern const char kRemapNoMemory[]; /* the refusal of an encoder whose memory is full */

#ifdef __cplusplus
}
#endif

#endif
