/* The look-up table in the form that the staged remap reads: tiles, whose part of the source is
 * copied into fast memory before they are computed. Portable C11 without library calls; README.md
 * explains the form. */
#ifndef FOVEA_REMAP_TILES_H
#define FOVEA_REMAP_TILES_H

#include <stdint.h>

#include "picture.h"

#ifdef __cplusplus
extern "C" {
#endif

#define TILE_PAIRS 40u      /* width of a tile, in pairs of 4 bytes */
#define TILE_ROWS 24u       /* height */
#define TILE_GROUP_PAIRS 4u /* pairs that one code stands for */
#define TILE_ROW_BYTES (4u * TILE_PAIRS)
#define TILE_ROW_CODES (TILE_PAIRS / TILE_GROUP_PAIRS)
#define TILE_WINDOW_ALIGN                                                                 \
  32u                 /* of a window's first column and width, bytes; divides every pitch \
                       */
#define TILE_BANKS 2u /* tile n is computed in bank n % 2 of the fast memory */

/** What a code stands for: byte offsets of four pairs in the window from the last pair before them.
 */
typedef struct tile_pattern {
  int32_t step[TILE_GROUP_PAIRS];
} tile_pattern_t;

/** A rectangle of the source, and where it goes. */
typedef struct tile_part {
  uint32_t source; /* byte offset of its first pair in the source */
  uint32_t counts; /* bytes of a row | rows << 16; 0: nothing to copy */
  uint32_t place; /* address for the first pair in the fast memory, as the one who copies sees it */
} tile_part_t;

/** The part of the source that a tile is computed from: two rectangles, one beside the other, each
 * with as many rows as its columns need. Together they are a fifth smaller than one rectangle. */
#define TILE_PARTS 2u
typedef struct tile_window {
  uint32_t left, top; /* byte in the row, and row, of the rectangle around both */
  tile_part_t part[TILE_PARTS];
} tile_window_t;

/** All that the core reads for a tile, apart from the patterns and the source: 576 bytes. */
typedef struct tile_stream {
  /* Addresses in the fast memory, for two rows at a time: the pattern of the first four pairs of
   * the upper row; the places from which the steps of the upper and of the lower row count; the
   * pattern of the upper row's second four pairs; then for eight pairs at a time two patterns of
   * the lower row and the next two of the upper one. */
  uint16_t code[TILE_ROWS * (TILE_ROW_CODES + 1u)];
  uint32_t destination; /* byte offset of the tile's first pair in the result */
  /* Of the tile after the next one, which is computed in the same bank. */
  tile_part_t next[TILE_PARTS];
  uint32_t next_patterns; /* 1: it is the first tile of its strip in this bank */
  uint32_t unused[3];
  uint32_t number; /* 1 for the first tile: never 0 */
} tile_stream_t;

/** Place for patterns and window in a bank of the fast memory. Addresses fit into 16 bits. */
typedef struct tile_bank {
  uint32_t start, end; /* multiples of 64 */
} tile_bank_t;

typedef struct tile_table {
  remap_picture_t picture;
  tile_bank_t bank[TILE_BANKS];
  uint32_t place_offset; /* from an address in a bank to the one that `tile_part_t.place` holds */
  /* Derived by tiles_layout(): */
  uint32_t strips, strip_tiles; /* strips of one tile's width; tiles of each, from top to bottom */
  uint32_t tiles;
  uint32_t window_pitch; /* bytes from one row of a window to the next, in all windows */
  uint32_t window_bytes; /* of the largest window */
  uint32_t patterns_max; /* patterns that fit into a bank beside the largest window */
  uint32_t window_base[TILE_BANKS];
  uint32_t black; /* number of black pairs */
  /* Derived by tiles_encode(): */
  uint32_t patterns; /* of the strip that has most */
} tile_table_t;

/** Memory that tiles_encode() needs while it runs. */
#define TILE_HASH_SIZE 1024u
typedef struct tile_work {
  uint16_t hash[TILE_HASH_SIZE]; /* 1 + number of a pattern; 0: free */
} tile_work_t;

/** Number of tiles of a picture; 0 if it is smaller than two tiles, one above the other. */
uint32_t tiles_count(const remap_picture_t *picture);

/** Finds the windows of all tiles and the layout of the banks.
 * @param windows tiles_count() of them
 * @return a null pointer, or the reason why the staged remap cannot use this table */
const char *tiles_layout(tile_table_t *table, tile_window_t *windows);

/** Derives patterns and streams, and completes the windows by the places of their parts.
 * @param patterns table->strips times table->patterns_max of them: each strip's list begins at a
 * multiple of patterns_max
 * @param streams one for each tile
 * @return a null pointer, or the reason why the staged remap cannot use this table */
const char *tiles_encode(tile_table_t *table, tile_window_t *windows, tile_pattern_t *patterns,
                         tile_stream_t *streams, tile_work_t *work);

/** First pair (from the left) of a strip, first row of a tile of a strip. The last ones begin
 * earlier than the others' distance says, if the picture is no multiple of a tile: they overlap
 * their neighbours. */
static inline uint32_t tile_first_pair(const tile_table_t *table, uint32_t strip) {
  const uint32_t last = remap_groups(&table->picture) * REMAP_GROUP - TILE_PAIRS;
  return strip * TILE_PAIRS < last ? strip * TILE_PAIRS : last;
}
static inline uint32_t tile_first_row(const tile_table_t *table, uint32_t tile) {
  const uint32_t last = table->picture.rows - TILE_ROWS;
  return tile * TILE_ROWS < last ? tile * TILE_ROWS : last;
}

#ifdef __cplusplus
}
#endif
#endif
