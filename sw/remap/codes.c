#include "codes.h"

const char kCodesTooMany[] = "more than 256 patterns of four pairs in a strip";
const char kCodesRowStep[] = "a row begins more than 128 KiB away from the row above";

/* A row's base is so far before its first entry: one pair, the step that is met most often. */
#define FIRST_STEP 4u

enum { SLOT_BITS = 10, SLOTS = 1 << SLOT_BITS };

/* The patterns of one strip, and where to find them: open addressing, at most a quarter full. */
typedef struct patterns {
  codes_pattern_t *list;
  uint32_t count;
  uint16_t slot[SLOTS]; /* number of the pattern + 1; 0: free */
} patterns_t;

/* The code of a pattern, which is appended if it is new; CODES_PATTERNS_MAX if there is no room. */
static uint32_t code_of(patterns_t *patterns, int32_t a, int32_t b, int32_t c, int32_t d) {
  uint32_t hash = (uint32_t)a * 0x9E3779B1u + (uint32_t)b;
  hash = hash * 0x9E3779B1u + (uint32_t)c;
  hash = (hash * 0x9E3779B1u + (uint32_t)d) * 0x9E3779B1u;
  for (uint32_t n = hash >> (32 - SLOT_BITS);; n = (n + 1u) % SLOTS) {
    const uint32_t code = patterns->slot[n];
    if (code == 0) {
      if (patterns->count == CODES_PATTERNS_MAX) return CODES_PATTERNS_MAX;
      patterns->list[patterns->count] = (codes_pattern_t){{a, b, c, d}};
      patterns->slot[n] = (uint16_t)++patterns->count;
      return patterns->count - 1u;
    }
    const codes_pattern_t *p = &patterns->list[code - 1u];
    if (p->offset[0] == a && p->offset[1] == b && p->offset[2] == c && p->offset[3] == d)
      return code - 1u;
  }
}

/* The codes of one row. @return 0 if there are too many patterns */
static int encode_row(patterns_t *patterns, const uint32_t *entries, uint32_t groups, uint32_t base,
                      uint8_t *codes) {
  for (uint32_t i = 0; i < groups * 2u; ++i, entries += 4) {
    const uint32_t code =
        code_of(patterns, (int32_t)(entries[0] - base), (int32_t)(entries[1] - base),
                (int32_t)(entries[2] - base), (int32_t)(entries[3] - base));
    if (code == CODES_PATTERNS_MAX) return 0;
    codes[i] = (uint8_t)code;
    base = entries[3];
  }
  return 1;
}

static const char *encode_strip(const remap_picture_t *picture, remap_memory_t *memory, void *form,
                                uint32_t *black) {
  codes_strip_t *const strip = form;
  uint32_t entries[REMAP_GROUPS_MAX * REMAP_GROUP];
  codes_pattern_t list[CODES_PATTERNS_MAX];
  patterns_t patterns = {.list = list, .count = 0, .slot = {0}};
  const uint32_t row_bytes = 2u + 2u * strip->strip.groups;
  /* The loop reads one byte behind the last row. */
  uint8_t *row = remap_take(memory, picture->rows * row_bytes + 1u, 32);
  if (row == NULL) return kRemapNoMemory;
  strip->stream_at = (uint32_t)(row - memory->base);
  /* Rows without a visible pair above the first one that has some have the base of that one. */
  uint32_t base = remap_first_visible(picture, strip->strip) - FIRST_STEP;
  strip->first_base = base;
  for (uint32_t v = 0; v < picture->rows; ++v, row += row_bytes) {
    *black += remap_visible_row(picture, v, strip->strip, base + FIRST_STEP, entries);
    const uint32_t start = entries[0] - FIRST_STEP;
    const int32_t step = (int32_t)(start - base) / 4;
    if (step != (int16_t)step) return kCodesRowStep;
    row[0] = (uint8_t)step;
    row[1] = (uint8_t)((uint32_t)step >> 8);
    base = start;
    if (!encode_row(&patterns, entries, strip->strip.groups, base, row + 2)) return kCodesTooMany;
  }
  *row = 0;
  strip->patterns = patterns.count;
  codes_pattern_t *to = remap_take(memory, (patterns.count + 1u) / 2u * 2u * sizeof *to, 32);
  if (to == NULL) return kRemapNoMemory;
  strip->pattern_at = (uint32_t)((uint8_t *)to - memory->base);
  for (uint32_t i = 0; i < patterns.count; ++i) to[i] = list[i];
  if (patterns.count % 2u != 0) to[patterns.count] = (codes_pattern_t){{0, 0, 0, 0}};
  return NULL;
}

const remap_head_t *codes_encode(const remap_picture_t *picture, uint32_t widest,
                                 remap_memory_t *memory, const char **refusal) {
  return remap_encode(picture, widest, memory, sizeof(codes_strip_t), encode_strip, refusal);
}
