#include "tiles.h"

#include <stddef.h>

/* Columns and rows of table entries, without a division for each. */
typedef struct divider {
  uint32_t pitch, reciprocal; /* 2^32 / pitch, rounded up */
} divider_t;

/* The row of an entry below 2^32 / pitch. */
static uint32_t row_of(divider_t d, uint32_t entry) {
  return (uint32_t)((uint64_t)entry * d.reciprocal >> 32);
}

static divider_t divider(const tile_table_t *t) {
  return (divider_t){t->pitch_bytes, (uint32_t)(0x100000000u / t->pitch_bytes) + 1u};
}

/* Pairs of a row that the table has entries for; those up to the pitch repeat the last one. */
static uint32_t pairs_of(const tile_table_t *t) { return t->width / 2u; }

uint32_t tiles_count(uint32_t width, uint32_t height, uint32_t pitch_bytes) {
  const uint32_t pairs = pitch_bytes / 4u;
  if (width < 2u || pairs < TILE_PAIRS || height <= TILE_ROWS) return 0;
  return (pairs + TILE_PAIRS - 1u) / TILE_PAIRS * ((height + TILE_ROWS - 1u) / TILE_ROWS);
}

/* The smallest aligned window with all source pairs of a tile. Returns 0 if one of them is black.
 */
static int find_window(const tile_table_t *t, divider_t d, uint32_t x, uint32_t y,
                       tile_window_t *window) {
  const uint32_t pairs = pairs_of(t), black = t->height * t->pitch_bytes;
  const uint32_t end = x + TILE_PAIRS < pairs ? x + TILE_PAIRS : pairs;
  uint32_t left = ~0u, right = 0, top = ~0u, bottom = 0;
  if (x >= end) x = end - 1u; /* a strip of padding only */
  for (uint32_t v = y; v < y + TILE_ROWS; ++v) {
    const uint32_t *entry = t->lut + v * pairs;
    for (uint32_t i = x; i < end; ++i) {
      if (entry[i] >= black) return 0;
      const uint32_t row = row_of(d, entry[i]), column = entry[i] - row * d.pitch;
      if (column < left) left = column;
      if (column > right) right = column;
      if (row < top) top = row;
      if (row > bottom) bottom = row;
    }
  }
  left &= ~(TILE_WINDOW_ALIGN - 1u);
  right = (right + 4u + TILE_WINDOW_ALIGN - 1u) & ~(TILE_WINDOW_ALIGN - 1u);
  window->source = top * d.pitch + left;
  window->counts = (right - left) | (bottom - top + 1u) << 16;
  return 1;
}

const char *tiles_layout(tile_table_t *t, tile_window_t *windows) {
  const divider_t d = divider(t);
  t->tiles = tiles_count(t->width, t->height, t->pitch_bytes);
  if (t->tiles == 0) return "the picture is smaller than two tiles of 80 x 24 pixels";
  t->strip_tiles = (t->height + TILE_ROWS - 1u) / TILE_ROWS;
  t->strips = t->tiles / t->strip_tiles;
  uint32_t rows = 0;
  t->window_pitch = 0;
  for (uint32_t n = 0; n < t->tiles; ++n) {
    if (!find_window(t, d, tile_first_pair(t, n / t->strip_tiles),
                     tile_first_row(t, n % t->strip_tiles), &windows[n]))
      return "pairs outside the source";
    const uint32_t width = windows[n].counts & 0xFFFFu, height = windows[n].counts >> 16;
    if (width > t->window_pitch) t->window_pitch = width;
    if (height > rows) rows = height;
  }
  t->window_bytes = (t->window_pitch * rows + 63u) & ~63u;
  t->patterns_max = ~0u;
  for (uint32_t b = 0; b < TILE_BANKS; ++b) {
    const uint32_t room = t->bank[b].end - t->bank[b].start;
    if (t->window_bytes >= room) return "a tile's window does not fit into internal RAM";
    t->window_base[b] = t->bank[b].end - t->window_bytes;
    const uint32_t patterns = (room - t->window_bytes) / (uint32_t)sizeof(tile_pattern_t);
    if (patterns < t->patterns_max) t->patterns_max = patterns;
  }
  return NULL;
}

/* The patterns of a strip. */
typedef struct pattern_list {
  tile_pattern_t *pattern;
  uint32_t count, most;
  uint16_t *hash;
} pattern_list_t;

/* The number of a pattern in the list, where it is put if it is new; `most` if the list is full. */
static uint32_t find_pattern(pattern_list_t *list, const int32_t step[TILE_GROUP_PAIRS]) {
  const uint32_t key = (uint32_t)step[0] + 5u * (uint32_t)step[1] + 17u * (uint32_t)step[2] +
                       257u * (uint32_t)step[3];
  uint32_t slot = key * 0x9E3779B1u >> 22;
  for (; list->hash[slot] != 0; slot = (slot + 1u) % TILE_HASH_SIZE) {
    const uint32_t n = list->hash[slot] - 1u;
    const int32_t *known = list->pattern[n].step;
    if (known[0] == step[0] && known[1] == step[1] && known[2] == step[2] && known[3] == step[3])
      return n;
  }
  if (list->count == list->most) return list->most;
  for (uint32_t i = 0; i < TILE_GROUP_PAIRS; ++i) list->pattern[list->count].step[i] = step[i];
  list->hash[slot] = (uint16_t)(list->count + 1u);
  return list->count++;
}

/* Encodes a tile. Returns 0 if the list of patterns is full. */
static int encode_tile(const tile_table_t *t, divider_t d, uint32_t n, const tile_window_t *window,
                       pattern_list_t *list, uint16_t *code) {
  const uint32_t bank = n % TILE_BANKS, pairs = pairs_of(t);
  const uint32_t x = tile_first_pair(t, n / t->strip_tiles);
  const uint32_t y = tile_first_row(t, n % t->strip_tiles);
  /* An entry's address in the window is origin + entry - row * shorter. */
  const uint32_t shorter = d.pitch - t->window_pitch;
  const uint32_t origin =
      t->window_base[bank] - window->source + row_of(d, window->source) * shorter;
  for (uint32_t v = y; v < y + TILE_ROWS; ++v) {
    const uint32_t *entry = t->lut + v * pairs;
    uint32_t last = 0;
    for (uint32_t g = 0; g < TILE_ROW_CODES; ++g) {
      uint32_t place[TILE_GROUP_PAIRS];
      for (uint32_t k = 0; k < TILE_GROUP_PAIRS; ++k) {
        const uint32_t i = x + g * TILE_GROUP_PAIRS + k;
        const uint32_t e = entry[i < pairs ? i : pairs - 1u];
        place[k] = origin + e - row_of(d, e) * shorter;
      }
      /* The commonest step before the first pair of a row makes its pattern one that others have.
       */
      if (g == 0) last = place[0] - 4u;
      int32_t step[TILE_GROUP_PAIRS];
      for (uint32_t k = 0; k < TILE_GROUP_PAIRS; ++k) step[k] = (int32_t)(place[k] - last);
      const uint32_t number = find_pattern(list, step);
      if (number == list->most) return 0;
      *code++ = (uint16_t)(t->bank[bank].start + number * sizeof(tile_pattern_t));
      if (g == 0) *code++ = (uint16_t)last;
      last = place[TILE_GROUP_PAIRS - 1u];
    }
  }
  return 1;
}

const char *tiles_encode(tile_table_t *t, const tile_window_t *windows, tile_pattern_t *patterns,
                         tile_stream_t *streams, tile_work_t *work) {
  const divider_t d = divider(t);
  const uint32_t most =
      t->patterns_max < TILE_HASH_SIZE / 2u ? t->patterns_max : TILE_HASH_SIZE / 2u;
  t->patterns = 0;
  for (uint32_t strip = 0; strip < t->strips; ++strip) {
    pattern_list_t list = {patterns + strip * t->patterns_max, 0, most, work->hash};
    for (uint32_t i = 0; i < TILE_HASH_SIZE; ++i) work->hash[i] = 0;
    for (uint32_t k = 0; k < t->strip_tiles; ++k) {
      const uint32_t n = strip * t->strip_tiles + k;
      tile_stream_t *stream = &streams[n];
      if (!encode_tile(t, d, n, &windows[n], &list, stream->code))
        return "a strip has more patterns than fit into internal RAM beside the windows";
      stream->destination = tile_first_row(t, k) * d.pitch + 4u * tile_first_pair(t, strip);
      const uint32_t next = n + TILE_BANKS;
      stream->next = (tile_window_t){0, 0};
      if (next < t->tiles) {
        stream->next = windows[next];
        if (next % t->strip_tiles < TILE_BANKS) stream->next.source |= 1u;
      }
      stream->number = n + 1u;
    }
    if (list.count > t->patterns) t->patterns = list.count;
  }
  return NULL;
}
