/* Every remap method of the firmware that needs the core alone, against the look-up table itself:
 * random small pictures of all widths, with pitches beyond the row and with black pairs. The
 * internal RAM holds other words before each run, so that a method that relies on an earlier run is
 * found.
 *
 * remap_methods ROUNDS: prints for each method how many pictures were equal and how many it
 * refused; exit status 1 after the first difference, or if a method refused more than a tenth. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sw/firmware/kernels/internal_ram.h"
#include "sw/firmware/kernels/method.h"
#include "sw/lens/lens.h"

#define PITCH_MAX 1536u
#define ROWS_MAX 24u
#define GUARD 0xA5A5A5A5u

static uint32_t source[PITCH_MAX / 4 * ROWS_MAX + 8] __attribute__((aligned(32)));
static uint32_t result[8 + PITCH_MAX / 4 * ROWS_MAX + 8] __attribute__((aligned(32)));
static uint32_t lut[PITCH_MAX / 4 * ROWS_MAX];
static uint8_t tables[128 * 1024] __attribute__((aligned(32)));

static uint32_t state = 1;
static uint32_t random_below(uint32_t n) {
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state % n;
}

static const remap_method_t *const kMethods[] = {
    &method_KERNEL_PLAIN,   &method_KERNEL_LDM,    &method_KERNEL_STRIPS,
    &method_KERNEL_OFFSETS, &method_KERNEL_DELTAS, &method_KERNEL_CODES};
enum { METHODS = sizeof kMethods / sizeof *kMethods };

/* A table like those of lenses: rows that go on by few different steps. */
static void make_picture(remap_table_t *table) {
  const uint32_t pairs = 2u + 2u * random_below(random_below(4) == 0 ? 180 : 40);
  const uint32_t rows = 1u + random_below(ROWS_MAX);
  uint32_t pitch = (pairs * 4u + 31u) / 32u * 32u;
  if (pitch < PITCH_MAX && random_below(2)) pitch += 32u;
  const uint32_t black = rows * pitch;
  const uint32_t wildness = random_below(4); /* how often a row jumps, in 1/8 */
  const uint32_t rim = random_below(3);      /* 0: none; 1: scattered; 2: around the picture */
  for (uint32_t v = 0; v < rows; ++v) {
    uint32_t m = random_below(rows), c = random_below(pairs);
    for (uint32_t i = 0; i < pairs; ++i) {
      if (random_below(8) < wildness) m = random_below(rows) ? m : random_below(rows);
      if (random_below(2)) c = c + 1 < pairs ? c + 1 : c;
      const uint32_t edge = v % 11u;
      const int is_black =
          rim == 1 ? random_below(9) == 0 : rim == 2 && (i < edge || i + 2u * edge >= pairs);
      lut[v * pairs + i] = is_black ? black : m * pitch + c * 4u;
    }
  }
  for (uint32_t i = 0; i < black / 4u; ++i) source[i] = random_below(0xFFFFFFFFu);
  source[black / 4u] = LENS_BLACK_WORD;
  *table = (remap_table_t){.width = 2u * pairs,
                           .height = rows,
                           .source_width = 2u * pairs,
                           .source_height = rows,
                           .pitch_bytes = pitch,
                           .lut = lut};
}

static int right(const remap_table_t *table, const char *name, int whole_groups) {
  const uint32_t pairs = table->width / 2u, words = table->pitch_bytes / 4u;
  const uint32_t written = whole_groups ? (pairs + 7u) / 8u * 8u : pairs;
  const uint32_t *out = result + 8;
  for (uint32_t v = 0; v < table->height; ++v)
    for (uint32_t i = 0; i < words; ++i) {
      const uint32_t word = out[v * words + i];
      const uint32_t expected = i < pairs ? source[lut[v * pairs + i] / 4u] : GUARD;
      if (word == expected || (i >= pairs && i < written)) continue;
      printf("%s, %u pairs x %u, pitch %u: row %u, word %u: %08x, expected %08x\n", name,
             (unsigned)pairs, (unsigned)table->height, (unsigned)table->pitch_bytes, (unsigned)v,
             (unsigned)i, (unsigned)word, (unsigned)expected);
      return 0;
    }
  for (uint32_t i = 0; i < 8; ++i)
    if (result[i] != GUARD || out[table->height * words + i] != GUARD) {
      printf("%s: written outside the result\n", name);
      return 0;
    }
  return 1;
}

int main(int argc, char **argv) {
  const unsigned rounds = argc > 1 ? (unsigned)atoi(argv[1]) : 100;
  unsigned equal[METHODS] = {0}, refused[METHODS] = {0};
  for (unsigned round = 0; round < rounds; ++round) {
    remap_table_t picture;
    make_picture(&picture);
    for (unsigned k = 0; k < METHODS; ++k) {
      remap_table_t table = picture;
      arena_t arena = {(uintptr_t)tables + 4u * random_below(8), (uintptr_t)tables + sizeof tables};
      if (kMethods[k]->prepare(&table, &arena) != NULL) {
        ++refused[k];
        continue;
      }
      for (volatile uint32_t *word = (volatile uint32_t *)RAM_WORK_BASE;
           (uintptr_t)word < RAM_WORK_END; ++word)
        *word = random_below(0xFFFFFFFFu);
      memset(result, GUARD & 0xFF, sizeof result);
      kMethods[k]->run(&table, source, result + 8);
      if (!right(&table, kMethods[k]->name, table.encoded != NULL)) return 1;
      ++equal[k];
    }
  }
  int enough = 1;
  for (unsigned k = 0; k < METHODS; ++k) {
    printf("%-18s %u equal, %u refused\n", kMethods[k]->name, equal[k], refused[k]);
    enough &= equal[k] > 0 && refused[k] * 10u <= rounds;
  }
  return !enough;
}
