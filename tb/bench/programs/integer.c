// Integer code: a table-driven checksum, a sort, and a bitwise tree walk, all within the D-cache.
#include <stdint.h>

static uint32_t crc_table[256], values[512];
volatile uint32_t result;

static uint32_t checksum(const uint8_t *p, unsigned n, uint32_t c) {
  while (n--) c = crc_table[(c ^ *p++) & 255u] ^ c >> 8;
  return c;
}

static void sort(uint32_t *v, int n) {
  for (int gap = n / 2; gap > 0; gap /= 2)
    for (int i = gap; i < n; ++i) {
      const uint32_t x = v[i];
      int k = i;
      for (; k >= gap && v[k - gap] > x; k -= gap) v[k] = v[k - gap];
      v[k] = x;
    }
}

static unsigned depth(uint32_t v) {
  unsigned n = 0;
  while (v) {
    v = v & 1u ? v >> 3 : v >> 1;
    ++n;
  }
  return n;
}

void work(void) {
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t c = i;
    for (int k = 0; k < 8; ++k) c = c & 1u ? 0xEDB88320u ^ c >> 1 : c >> 1;
    crc_table[i] = c;
  }
  uint32_t seed = 1, sum = 0;
  for (int round = 0; round < ROUNDS; ++round) {
    for (int i = 0; i < 512; ++i) values[i] = seed = seed * 1664525u + 1013904223u;
    sum = checksum((const uint8_t *)values, sizeof values, sum);
    sort(values, 512);
    for (int i = 0; i < 512; ++i) sum += depth(values[i] ^ sum);
  }
  result = sum;
}
