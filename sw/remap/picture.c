#include "picture.h"

const char kRemapNoMemory[] = "not enough memory for its table";

void *remap_take(remap_memory_t *memory, size_t bytes, size_t alignment) {
  const size_t start = (memory->used + alignment - 1) & ~(alignment - 1);
  if (start > memory->bytes || bytes > memory->bytes - start) return NULL;
  memory->used = start + bytes;
  return memory->base + start;
}

uint32_t remap_visible_row(const remap_picture_t *picture, uint32_t row, remap_strip_t strip,
                           uint32_t otherwise, uint32_t *entries) {
  const uint32_t black = picture->source_rows * picture->pitch_bytes;
  const uint32_t first = strip.first * REMAP_GROUP;
  const uint32_t all = strip.groups * REMAP_GROUP;
  const uint32_t present = picture->pairs - first < all ? picture->pairs - first : all;
  const uint32_t *lut = picture->lut + row * picture->pairs + first;
  uint32_t leading = 0;
  while (leading < present && lut[leading] == black) ++leading;
  uint32_t last = leading < present ? lut[leading] : otherwise;
  for (uint32_t i = 0; i < leading; ++i) entries[i] = last;
  uint32_t count = leading;
  for (uint32_t i = leading; i < present; ++i) {
    const uint32_t entry = lut[i];
    if (entry != black)
      last = entry;
    else
      ++count;
    entries[i] = last;
  }
  for (uint32_t i = present; i < all; ++i) entries[i] = last;
  return count;
}

uint32_t remap_first_visible(const remap_picture_t *picture, remap_strip_t strip) {
  const uint32_t black = picture->source_rows * picture->pitch_bytes;
  const uint32_t first = strip.first * REMAP_GROUP;
  const uint32_t end = first + strip.groups * REMAP_GROUP;
  const uint32_t present = end < picture->pairs ? end : picture->pairs;
  for (uint32_t v = 0; v < picture->rows; ++v)
    for (uint32_t i = first; i < present; ++i)
      if (picture->lut[v * picture->pairs + i] != black)
        return picture->lut[v * picture->pairs + i];
  return 4u;
}

const remap_black_run_t *remap_list_black(const remap_picture_t *picture, uint32_t count,
                                          remap_memory_t *memory) {
  const uint32_t black = picture->source_rows * picture->pitch_bytes;
  const uint32_t pitch = picture->pitch_bytes / 4u;
  remap_black_run_t *const list = remap_take(memory, sizeof *list, sizeof *list);
  if (list == NULL) return NULL;
  remap_black_run_t *run = list;
  uint32_t end = 0; /* of the run before, in words */
  for (uint32_t v = 0; v < picture->rows && count != 0; ++v) {
    const uint32_t *lut = picture->lut + v * picture->pairs;
    for (uint32_t i = 0; i < picture->pairs && count != 0; ++i) {
      if (lut[i] != black) continue;
      const uint32_t start = i;
      while (i < picture->pairs && lut[i] == black) ++i;
      uint32_t skip = v * pitch + start - end, words = i - start;
      count -= words;
      end = v * pitch + i;
      while (words != 0) {
        const uint32_t step = skip > UINT16_MAX ? UINT16_MAX : skip;
        skip -= step;
        *run = (remap_black_run_t){(uint16_t)step, (uint16_t)(skip != 0 ? 0 : words)};
        if (skip == 0) words = 0;
        if (remap_take(memory, sizeof *run, sizeof *run) == NULL) return NULL;
        ++run;
      }
    }
  }
  *run = (remap_black_run_t){0, 0};
  return list;
}

const remap_head_t *remap_encode(const remap_picture_t *picture, uint32_t widest,
                                 remap_memory_t *memory, size_t form_bytes,
                                 remap_encode_strip_t *encode, const char **refusal) {
  const uint32_t groups = remap_groups(picture);
  const uint32_t count = remap_strip_count(groups, widest);
  remap_head_t *head = remap_take(memory, sizeof *head + count * form_bytes, 32);
  *refusal = head == NULL ? kRemapNoMemory : NULL;
  if (head == NULL) return NULL;
  uint8_t *form = (uint8_t *)(head + 1);
  uint32_t black_pairs = 0;
  for (uint32_t n = 0; n < count && *refusal == NULL; ++n, form += form_bytes) {
    *(remap_strip_t *)form = remap_strip_of(groups, count, n);
    *refusal = encode(picture, memory, form, &black_pairs);
  }
  if (*refusal != NULL) return NULL;
  const remap_black_run_t *black = remap_list_black(picture, black_pairs, memory);
  if (black == NULL) {
    *refusal = kRemapNoMemory;
    return NULL;
  }
  head->rows = picture->rows;
  head->strips = count;
  head->black_at = (uint32_t)((const uint8_t *)black - memory->base);
  head->bytes = (uint32_t)memory->used;
  return head;
}
