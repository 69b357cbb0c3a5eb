/* setjmp, malloc, sorting, recursion, and code that is executed on the stack. */
#include <math.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static jmp_buf back;
static int depth(int n) {
  volatile char room[64];
  memset((char *)room, n, sizeof room);
  if (n == 300) longjmp(back, 77);
  return depth(n + 1) + room[n % 64];
}

static int by_value(const void *a, const void *b) {
  const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return x < y ? -1 : x > y;
}

int main(void) {
  uint32_t seed = 12345, sum = 0;
  char *kept[64] = {0};
  unsigned i, k;
  double e = 0, term = 1;
  const int from = setjmp(back);
  if (from == 0) depth(1);
  printf("back with %d\n", from);

  for (i = 0; i < 3000; ++i) {
    seed = seed * 1664525u + 1013904223u;
    k = seed >> 26;
    if (kept[k] && (seed & 0x100)) {
      for (unsigned j = 0; kept[k][j]; ++j) sum += (unsigned char)kept[k][j];
      free(kept[k]);
      kept[k] = NULL;
    } else {
      const unsigned n = 1 + (seed >> 10 & 0x3FF);
      kept[k] = realloc(kept[k], n + 1);
      if (!kept[k]) return 9;
      memset(kept[k], 'a' + (int)(i % 26), n);
      kept[k][n] = 0;
    }
  }
  printf("allocated, sum %lu\n", (unsigned long)sum);
  uint32_t *numbers = malloc(5000 * sizeof *numbers);
  for (i = 0; i < 5000; ++i) numbers[i] = seed = seed * 1664525u + 1013904223u;
  qsort(numbers, 5000, sizeof *numbers, by_value);
  for (i = 1; i < 5000; ++i)
    if (numbers[i - 1] > numbers[i]) return 8;
  printf("sorted, from %lu to %lu\n", (unsigned long)numbers[0], (unsigned long)numbers[4999]);
  for (i = 1; i < 20; ++i) e += term, term /= i;
  printf("e = %.12f, sqrt 2 = %.12f, 2^0.5 = %.12f\n", e, sqrt(2.0), pow(2.0, 0.5));
  /* More than the whole memory is refused, not granted. */
  void *volatile much = malloc(0x70000000u);
  printf("too much: %s\n", much ? "granted" : "refused");
  return (int)(sum & 0x7F);
}
