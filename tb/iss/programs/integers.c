// Division, 64-bit arithmetic, CRC, sorting, string functions, setjmp, printf formats.
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static uint32_t seed = 12345;
static uint32_t next(void) { return seed = seed * 1664525u + 1013904223u; }

static uint32_t crc32(const uint8_t *p, unsigned n) {
  uint32_t c = ~0u;
  while (n--) {
    c ^= *p++;
    for (int k = 0; k < 8; ++k) c = c >> 1 ^ (c & 1 ? 0xEDB88320u : 0);
  }
  return ~c;
}
static int up(const void *a, const void *b) {
  const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return (x > y) - (x < y);
}
static uint8_t from[700], to[700];
static int32_t numbers[500];
static jmp_buf env;
static int depth(int n) {
  if (n == 0) longjmp(env, 42);
  return depth(n - 1) + n;
}

int main(void) {
  for (int i = 0; i < 60; ++i) {
    const uint32_t a = next(), b = next() >> (i % 31);
    const int32_t sa = (int32_t)a, sb = (int32_t)b | 1;
    const uint64_t wa = (uint64_t)a << 32 | next(), wb = ((uint64_t)b << (i % 20)) | 1;
    const int64_t la = (int64_t)wa, lb = -(int64_t)wb;
    say("%lu %lu %ld %ld\n", (unsigned long)(a / (b | 1)), (unsigned long)(a % (b | 1)),
        (long)(sa / sb), (long)(sa % sb));
    const uint64_t r[6] = {wa / wb, wa % wb, (uint64_t)(la / lb), (uint64_t)(la % lb), wa * wb,
                           (uint64_t)(la >> (i + 1)) + (wa << i)};
    for (int k = 0; k < 6; ++k) say("%08lx%08lx ", (unsigned long)(r[k] >> 32), (unsigned long)r[k]);
    say("\n");
  }
  for (unsigned i = 0; i < sizeof from; ++i) from[i] = (uint8_t)next() ^ (uint8_t)(next() >> 24);
  for (unsigned off = 0; off < 8; ++off)
    for (unsigned len = 0; len < 80; len += 7) {
      memset(to, 0x55, sizeof to);
      memcpy(to + off, from + (7 - off), len);
      memmove(to + 100 + off, to + 96, len);
      say("%08lx %d\n", (unsigned long)crc32(to, sizeof to), memcmp(to, from, len) > 0);
    }
  for (int i = 0; i < 500; ++i) numbers[i] = (int32_t)next();
  qsort(numbers, 500, sizeof *numbers, up);
  for (int i = 0; i < 500; i += 9) say("%ld ", (long)numbers[i]);
  const int back = setjmp(env);
  if (back == 0) depth(20);
  say("\nsetjmp %d\n", back);
  say("[%5d|%-5d|%05d|%x|%#o|%c|%10.3s|%s]\n", -42, 42, 42, 0xBEEF, 8, 'q', "string", "end");
  say("%s %ld\n", strstr("one two three", "two"), strtol("-7fff", 0, 16));
  const int16_t h[4] = {-3, 1000, 32767, -32768};
  int32_t acc = 0;
  int64_t wide = 1;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) {
      acc += h[i] * h[k];
      wide += (int64_t)h[i] * h[k] * 65537;
    }
  say("%ld %08lx%08lx %d\n", (long)acc, (unsigned long)(wide >> 32), (unsigned long)wide,
      __builtin_clz(0x00012345));
  return 0;
}
