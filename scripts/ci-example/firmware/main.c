/* A firmware whose time matters: it smooths a line of samples and checks the result. */
#include <stdint.h>

#define SAMPLES 1024u
#define TAPS 8u

static uint16_t line[SAMPLES + TAPS];
static uint16_t smooth[SAMPLES];

static void fill(void) {
  uint32_t seed = 1;
  for (uint32_t i = 0; i < SAMPLES + TAPS; ++i) {
    seed = seed * 1664525u + 1013904223u;
    line[i] = (uint16_t)(seed >> 20);
  }
}

/* The mean of eight samples. SLOW adds the sum up anew for each sample, as a careless change might. */
__attribute__((noinline)) static void filter(void) {
#ifdef SLOW
  for (uint32_t i = 0; i < SAMPLES; ++i) {
    uint32_t sum = 0;
    for (uint32_t k = 0; k < TAPS; ++k) sum += line[i + k];
    smooth[i] = (uint16_t)(sum / TAPS);
  }
#else
  uint32_t sum = 0;
  for (uint32_t k = 0; k < TAPS; ++k) sum += line[k];
  for (uint32_t i = 0; i < SAMPLES; ++i) {
    smooth[i] = (uint16_t)(sum / TAPS);
    sum += (uint32_t)line[i + TAPS] - line[i];
  }
#endif
}

__attribute__((noinline)) static uint32_t checksum(void) {
  uint32_t sum = 0;
  for (uint32_t i = 0; i < SAMPLES; ++i) sum = sum * 31u + smooth[i];
  return sum;
}

int main(void) {
  fill();
  filter();
  return checksum() == EXPECTED_SUM ? 0 : 1;
}
