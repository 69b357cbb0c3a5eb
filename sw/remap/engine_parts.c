#include "engine_parts.h"

/* Rows of which both edges go on as they began, and none is more than twice as long as another: a part along the left
 * edge and one along the right edge cover them. */
typedef struct band {
  uint32_t top, rows;
  uint32_t pairs;        /* of the shortest row */
  int straight[2];       /* left edge, right edge: the same pair in all rows */
  int parallel;          /* all rows are equally long */
} band_t;

static uint32_t edge_of(const engine_span_t *span, int right) { return right ? span->end : span->first; }

static int step_of(const engine_span_t *spans, uint32_t row, int right) {
  return (int)edge_of(&spans[row + 2u], right) - (int)edge_of(&spans[row], right);
}

/* Whether row `row` goes on as rows `top` and top + 1, or top + 2 and top + 3, began. */
static int goes_on(const engine_span_t *spans, uint32_t top, uint32_t row, int right) {
  return row < top + 3u || step_of(spans, row - 2u, right) == step_of(spans, top, right);
}

static band_t band_from(const engine_span_t *spans, uint32_t rows, uint32_t top) {
  band_t band = {.top = top, .straight = {1, 1}, .parallel = 1};
  uint32_t shortest = ~0u, longest = 0;
  for (uint32_t row = top; row < rows; ++row) {
    const uint32_t pairs = (uint32_t)spans[row].end - spans[row].first;
    const uint32_t low = pairs < shortest ? pairs : shortest, high = pairs > longest ? pairs : longest;
    if (pairs == 0 || high > 2u * low) break;
    if (!goes_on(spans, top, row, 0) || !goes_on(spans, top, row, 1)) break;
    shortest = low;
    longest = high;
    ++band.rows;
    for (int right = 0; right < 2; ++right)
      if (edge_of(&spans[row], right) != edge_of(&spans[top], right)) band.straight[right] = 0;
  }
  band.pairs = shortest;
  band.parallel = shortest == longest;
  return band;
}

/* The parts along one edge: one if it is straight, otherwise one of the even and one of the odd rows. */
static int along(const engine_span_t *spans, const band_t *band, int right,
                 int (*part)(void *context, const engine_part_t *part), void *context) {
  const uint32_t every = band->straight[right] || band->rows == 1u ? 1u : 2u;
  for (uint32_t n = 0; n < every; ++n) {
    const uint32_t top = band->top + n, rows = (band->rows - n + every - 1u) / every;
    const uint32_t left = right ? spans[top].end - band->pairs : spans[top].first;
    const engine_part_t one = {.pairs = (uint16_t)band->pairs,
                               .rows = (uint16_t)rows,
                               .top = (uint16_t)top,
                               .every = (uint16_t)every,
                               .left = (uint16_t)left,
                               .slant = (int16_t)(every == 1u || rows == 1u ? 0 : step_of(spans, top, right))};
    const int result = part(context, &one);
    if (result != 0) return result;
  }
  return 0;
}

int engine_parts_cover(const engine_span_t *spans, uint32_t rows,
                       int (*part)(void *context, const engine_part_t *part), void *context) {
  for (uint32_t top = 0; top < rows;) {
    if (spans[top].first == spans[top].end) {
      ++top;
      continue;
    }
    const band_t band = band_from(spans, rows, top);
    int result = along(spans, &band, 0, part, context);
    if (result == 0 && !band.parallel) result = along(spans, &band, 1, part, context);
    if (result != 0) return result;
    top += band.rows;
  }
  return 0;
}
