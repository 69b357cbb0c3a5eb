// The remap loop: copies pixel pairs through a table from one picture to another that is never
// read.
#include <stdint.h>

enum { kWidth = 360, kHeight = 144, kPairs = kWidth * kHeight / 2 };
static uint32_t in[kPairs], out[kPairs], lut[kPairs];

static __attribute__((noinline)) void remap(uint32_t *restrict to, const void *from,
                                            const uint32_t *restrict entry, uint32_t pairs) {
  const char *base = from;
  const uint32_t *end = entry + pairs;
  while (entry != end) *to++ = *(const uint32_t *)(base + *entry++);
}

void work(void) {
  for (unsigned k = 0; k < kPairs; ++k) {
    const unsigned x = k % (kWidth / 2), y = k / (kWidth / 2);
    const unsigned sx = x - x / 16 + y / 24, sy = (y * 15 + x / 12) / 16;
    lut[k] = 4 * ((sy % kHeight) * (kWidth / 2) + sx % (kWidth / 2));
    in[k] = k;
  }
  for (int round = 0; round < ROUNDS; ++round) remap(out, in, lut, kPairs);
}
