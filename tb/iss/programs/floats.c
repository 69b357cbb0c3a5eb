// Soft float: arithmetic on edge values, and libm.
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "support.h"

static uint64_t raw(double v) { uint64_t u; memcpy(&u, &v, 8); return u; }
static uint32_t rawf(float v) { uint32_t u; memcpy(&u, &v, 4); return u; }

int main(void) {
  static const uint64_t edges[] = {
      0, 0x8000000000000000ull, 1, 0x000fffffffffffffull, 0x0010000000000000ull,
      0x3ff0000000000000ull, 0xbff0000000000000ull, 0x3ff0000000000001ull, 0x7fefffffffffffffull,
      0x7ff0000000000000ull, 0xfff0000000000000ull, 0x4009211fb54442d1ull, 0xc1dfffffffc00000ull};
  const unsigned n = sizeof edges / sizeof *edges;
  for (unsigned i = 0; i < n; ++i)
    for (unsigned k = 0; k < n; ++k) {
      volatile double a, b;
      memcpy((void *)&a, &edges[i], 8);
      memcpy((void *)&b, &edges[k], 8);
      const double s = a + b, d = a - b, p = a * b, q = a / b;
      uint64_t h = 0;
      const double all[4] = {s, d, p, q};
      for (int j = 0; j < 4; ++j) h = h * 31 + (isnan(all[j]) ? 77 : raw(all[j]));
      say("%u %u %08lx%08lx %d %d %d\n", i, k, (unsigned long)(h >> 32), (unsigned long)h, a < b,
          a == b, a > b);
    }
  volatile float f = 0.1f;
  for (int i = 0; i < 40; ++i) {
    const float g = sqrtf(f) * 3.7f - f / 1.3f;
    say("%08lx %ld %lu\n", (unsigned long)rawf(g), (long)(g * 1000), (unsigned long)(f * 1000));
    f = f * 1.37f + 0.01f;
  }
  for (int i = -20; i <= 20; ++i) {
    volatile double x = i * 0.37;
    say("%.15g %.15g %.15g %.15g %.15g\n", sin(x), atan(x), atan2(x, 1.5), sqrt(x * x + 2), exp(x));
    say("%.12e %.10g %ld\n", tan(x), pow(fabs(x) + 0.5, 1.7), lround(x * 100));
  }
  return 0;
}
