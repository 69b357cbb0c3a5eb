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
  const uint32_t pitch = t->picture.pitch_bytes;
  return (divider_t){pitch, (uint32_t)(0x100000000u / pitch) + 1u};
}

/* The row of the entry that was looked at last: the next one is mostly in the same row, or beside
 * it. */
typedef struct walk {
  divider_t d;
  uint32_t row, start; /* start: entry of the row's first pair */
} walk_t;

/* Goes to the row of an entry. */
static inline void walk_to(walk_t *w, uint32_t entry) {
  const uint32_t pitch = w->d.pitch, column = entry - w->start;
  if (column < pitch) return;
  if (column - pitch < pitch) {
    ++w->row;
    w->start += pitch;
  } else if (column + pitch < pitch) {
    --w->row;
    w->start -= pitch;
  } else {
    w->row = row_of(w->d, entry);
    w->start = w->row * pitch;
  }
}

uint32_t tiles_count(const remap_picture_t *picture) {
  const uint32_t pairs = remap_groups(picture) * REMAP_GROUP;
  if (pairs < TILE_PAIRS || picture->rows <= TILE_ROWS) return 0;
  return (pairs + TILE_PAIRS - 1u) / TILE_PAIRS * ((picture->rows + TILE_ROWS - 1u) / TILE_ROWS);
}

/* A tile's place in the result, and the entry that those of its rows get that have no visible pair.
 */
typedef struct spot {
  remap_strip_t strip;
  uint32_t row, otherwise;
} spot_t;

static spot_t spot_of(const tile_table_t *t, uint32_t n) {
  const remap_picture_t *p = &t->picture;
  const uint32_t x = tile_first_pair(t, n / t->strip_tiles);
  const uint32_t y = tile_first_row(t, n % t->strip_tiles), black = p->source_rows * p->pitch_bytes;
  const uint32_t end = x + TILE_PAIRS < p->pairs ? x + TILE_PAIRS : p->pairs;
  const spot_t spot = {{x / REMAP_GROUP, TILE_PAIRS / REMAP_GROUP}, y, 0};
  for (uint32_t v = y; v < y + TILE_ROWS; ++v)
    for (uint32_t i = x; i < end; ++i)
      if (p->lut[v * p->pairs + i] != black)
        return (spot_t){spot.strip, y, p->lut[v * p->pairs + i]};
  return spot;
}

/* Rows that are read of each column of TILE_WINDOW_ALIGN bytes; none: first > last. */
#define COLUMNS_MAX 128u
typedef struct extent {
  uint32_t first[COLUMNS_MAX], last[COLUMNS_MAX];
} extent_t;

/* Marks the rows that a tile reads. Returns the number of its black pairs. */
static uint32_t find_extent(const tile_table_t *t, divider_t d, spot_t spot, extent_t *e) {
  uint32_t black = 0;
  for (uint32_t c = 0; c < t->picture.pitch_bytes / TILE_WINDOW_ALIGN; ++c) {
    e->first[c] = ~0u;
    e->last[c] = 0;
  }
  walk_t w = {d, 0, 0};
  uint32_t last_row = ~0u, last_column = ~0u;
  for (uint32_t v = spot.row; v < spot.row + TILE_ROWS; ++v) {
    uint32_t entry[TILE_PAIRS];
    black += remap_visible_row(&t->picture, v, spot.strip, spot.otherwise, entry);
    for (uint32_t i = 0; i < TILE_PAIRS; ++i) {
      walk_to(&w, entry[i]);
      const uint32_t c = (entry[i] - w.start) / TILE_WINDOW_ALIGN;
      if (w.row == last_row && c == last_column) continue;
      last_row = w.row;
      last_column = c;
      if (w.row < e->first[c]) e->first[c] = w.row;
      if (w.row > e->last[c]) e->last[c] = w.row;
    }
  }
  return black;
}

/* The smallest rectangle with all marked rows of columns `from` to `to` - 1. */
static tile_part_t rectangle(divider_t d, const extent_t *e, uint32_t from, uint32_t to) {
  uint32_t first = ~0u, last = 0;
  while (from < to && e->first[from] > e->last[from]) ++from;
  while (from < to && e->first[to - 1u] > e->last[to - 1u]) --to;
  if (from == to) return (tile_part_t){0, 0, 0};
  for (uint32_t c = from; c < to; ++c) {
    if (e->first[c] < first) first = e->first[c];
    if (e->last[c] > last && e->first[c] <= e->last[c]) last = e->last[c];
  }
  return (tile_part_t){first * d.pitch + from * TILE_WINDOW_ALIGN,
                       (to - from) * TILE_WINDOW_ALIGN | (last - first + 1u) << 16, 0};
}

static uint32_t part_bytes(tile_part_t p) { return (p.counts & 0xFFFFu) * (p.counts >> 16); }

/* Divides the marked rows into the two rectangles that have the fewest bytes. */
static void divide(divider_t d, const extent_t *e, uint32_t columns, tile_window_t *window) {
  const tile_part_t whole = rectangle(d, e, 0, columns);
  uint32_t best = ~0u;
  window->top = row_of(d, whole.source);
  window->left = whole.source - window->top * d.pitch;
  const uint32_t from = window->left / TILE_WINDOW_ALIGN;
  const uint32_t to = from + (whole.counts & 0xFFFFu) / TILE_WINDOW_ALIGN;
  for (uint32_t middle = from + 1u; middle <= to; ++middle) {
    const tile_part_t left = rectangle(d, e, from, middle), right = rectangle(d, e, middle, to);
    if (part_bytes(left) + part_bytes(right) >= best) continue;
    best = part_bytes(left) + part_bytes(right);
    window->part[0] = left;
    window->part[1] = right;
  }
}

const char *tiles_layout(tile_table_t *t, tile_window_t *windows) {
  const divider_t d = divider(t);
  t->tiles = tiles_count(&t->picture);
  if (t->tiles == 0) return "the picture is smaller than two tiles of 80 x 24 pixels";
  t->strip_tiles = (t->picture.rows + TILE_ROWS - 1u) / TILE_ROWS;
  t->strips = t->tiles / t->strip_tiles;
  if (t->picture.pitch_bytes / TILE_WINDOW_ALIGN > COLUMNS_MAX) return "the picture is too wide";
  uint32_t rows = 0;
  t->window_pitch = t->black = 0;
  for (uint32_t n = 0; n < t->tiles; ++n) {
    extent_t extent;
    t->black += find_extent(t, d, spot_of(t, n), &extent);
    divide(d, &extent, t->picture.pitch_bytes / TILE_WINDOW_ALIGN, &windows[n]);
    for (uint32_t p = 0; p < TILE_PARTS; ++p) {
      const tile_part_t *part = &windows[n].part[p];
      const uint32_t row = row_of(d, part->source), column = part->source - row * d.pitch;
      if (part->counts == 0) continue;
      const uint32_t right = column + (part->counts & 0xFFFFu) - windows[n].left;
      const uint32_t bottom = row + (part->counts >> 16) - windows[n].top;
      if (right > t->window_pitch) t->window_pitch = right;
      if (bottom > rows) rows = bottom;
    }
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

typedef struct row_code {
  uint16_t base, pattern[TILE_ROW_CODES]; /* addresses */
} row_code_t;

/* Encodes a row of a tile. `origin` is the address of row 0, byte 0 of the source in the window,
 * each row being `shorter` bytes shorter than in the source. Returns 0 if the list of patterns is
 * full. */
static int encode_row(const tile_table_t *t, divider_t d, spot_t spot, uint32_t v, uint32_t origin,
                      uint32_t patterns_base, pattern_list_t *list, row_code_t *code) {
  const uint32_t shorter = d.pitch - t->window_pitch;
  walk_t w = {d, 0, 0};
  uint32_t entry[TILE_PAIRS], last = 0;
  (void)remap_visible_row(&t->picture, v, spot.strip, spot.otherwise, entry);
  for (uint32_t g = 0; g < TILE_ROW_CODES; ++g) {
    uint32_t place[TILE_GROUP_PAIRS];
    for (uint32_t k = 0; k < TILE_GROUP_PAIRS; ++k) {
      const uint32_t e = entry[g * TILE_GROUP_PAIRS + k];
      walk_to(&w, e);
      place[k] = origin + e - w.row * shorter;
    }
    /* The commonest step before the first pair of a row makes its pattern one that others have. */
    if (g == 0) code->base = (uint16_t)(last = place[0] - 4u);
    int32_t step[TILE_GROUP_PAIRS];
    for (uint32_t k = 0; k < TILE_GROUP_PAIRS; ++k) step[k] = (int32_t)(place[k] - last);
    const uint32_t number = find_pattern(list, step);
    if (number == list->most) return 0;
    code->pattern[g] = (uint16_t)(patterns_base + number * sizeof(tile_pattern_t));
    last = place[TILE_GROUP_PAIRS - 1u];
  }
  return 1;
}

/* Encodes a tile, two rows at a time. Returns 0 if the list of patterns is full. */
static int encode_tile(const tile_table_t *t, divider_t d, uint32_t n, const tile_window_t *window,
                       pattern_list_t *list, uint16_t *out) {
  const uint32_t bank = n % TILE_BANKS;
  const spot_t spot = spot_of(t, n);
  const uint32_t origin = t->window_base[bank] - window->top * t->window_pitch - window->left;
  for (uint32_t v = spot.row; v < spot.row + TILE_ROWS; v += 2u) {
    row_code_t row[2];
    for (uint32_t i = 0; i < 2u; ++i)
      if (!encode_row(t, d, spot, v + i, origin, t->bank[bank].start, list, &row[i])) return 0;
    *out++ = row[0].pattern[0];
    *out++ = row[0].base;
    *out++ = row[1].base;
    *out++ = row[0].pattern[1];
    for (uint32_t g = 0; g < TILE_ROW_CODES; g += 2u)
      for (uint32_t i = g == 0 ? 1u : 0; i < 2u; ++i) {
        *out++ = row[i].pattern[g];
        *out++ = row[i].pattern[g + 1u];
      }
  }
  return 1;
}

/* Where the parts of a tile's window go. */
static void place_parts(const tile_table_t *t, divider_t d, uint32_t n, tile_window_t *window) {
  for (uint32_t p = 0; p < TILE_PARTS; ++p) {
    tile_part_t *part = &window->part[p];
    const uint32_t row = row_of(d, part->source), column = part->source - row * d.pitch;
    part->place = t->place_offset + t->window_base[n % TILE_BANKS] +
                  (row - window->top) * t->window_pitch + column - window->left;
  }
}

const char *tiles_encode(tile_table_t *t, tile_window_t *windows, tile_pattern_t *patterns,
                         tile_stream_t *streams, tile_work_t *work) {
  const divider_t d = divider(t);
  const uint32_t most =
      t->patterns_max < TILE_HASH_SIZE / 2u ? t->patterns_max : TILE_HASH_SIZE / 2u;
  t->patterns = 0;
  for (uint32_t n = 0; n < t->tiles; ++n) place_parts(t, d, n, &windows[n]);
  for (uint32_t strip = 0; strip < t->strips; ++strip) {
    pattern_list_t list = {patterns + strip * t->patterns_max, 0, most, work->hash};
    for (uint32_t i = 0; i < TILE_HASH_SIZE; ++i) work->hash[i] = 0;
    for (uint32_t k = 0; k < t->strip_tiles; ++k) {
      const uint32_t n = strip * t->strip_tiles + k, next = n + TILE_BANKS;
      tile_stream_t *stream = &streams[n];
      if (!encode_tile(t, d, n, &windows[n], &list, stream->code))
        return "a strip has more patterns than fit into internal RAM beside the windows";
      stream->destination = tile_first_row(t, k) * d.pitch + 4u * tile_first_pair(t, strip);
      for (uint32_t p = 0; p < TILE_PARTS; ++p)
        stream->next[p] = next < t->tiles ? windows[next].part[p] : (tile_part_t){0, 0, 0};
      stream->next_patterns = next % t->strip_tiles < TILE_BANKS;
      stream->number = n + 1u;
    }
    if (list.count > t->patterns) t->patterns = list.count;
  }
  return NULL;
}
