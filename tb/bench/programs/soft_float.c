// The arithmetic of a look-up table: radius, angle and polynomial of each entry in double
// precision.
#include <math.h>
#include <stdint.h>

static uint32_t table[64 * 48];

void work(void) {
  for (int round = 0; round < ROUNDS; ++round)
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const double dx = (x - 31.5) * 0.031, dy = (y - 23.5) * 0.031 + round * 1e-6;
        const double r = sqrt(dx * dx + dy * dy);
        const double theta = atan(r);
        const double t2 = theta * theta;
        const double k = theta * (1.0 + t2 * (-0.021 + t2 * 0.0043)) / (r > 1e-9 ? r : 1e-9);
        const int u = (int)(dx * k * 512.0 + 320.0), v = (int)(dy * k * 512.0 + 240.0);
        table[y * 64 + x] ^= (uint32_t)(v * 640 + u);
      }
}
