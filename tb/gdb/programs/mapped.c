/* MMU and caches on, with 0x40000000 mapped to 0x01000000, so that virtual and physical differ. */
#include <stdint.h>
#include <stdio.h>

enum { kSection = 1u << 20, kWindow = 0x40000000u, kBehind = 0x01000000u };

static uint32_t table[4096] __attribute__((aligned(16384)));
static volatile uint32_t *const window = (volatile uint32_t *)kWindow;

__attribute__((noipa)) int constant(void) { return 5; }
__attribute__((noipa)) void stop_here(void) {}

static void mmu_on(void) {
  for (uint32_t mb = 0; mb < 128; ++mb) table[mb] = mb * kSection | 0xC1E; /* cached, buffered */
  table[kWindow / kSection] = kBehind | 0xC12;                             /* neither */
  __asm__ volatile(
      "mcr p15, 0, %0, c2, c0, 0\n\t"
      "mcr p15, 0, %1, c3, c0, 0\n\t"
      "mrc p15, 0, r3, c1, c0, 0\n\t"
      "orr r3, r3, #0x1000\n\t"
      "orr r3, r3, #5\n\t"
      "mcr p15, 0, r3, c1, c0, 0"
      :
      : "r"(table), "r"(0xFFFFFFFFu)
      : "r3", "memory");
}

int main(void) {
  mmu_on();
  window[4] = 0x12345678;
  const int first = constant();
  stop_here();
  const int second = constant();
  window[12] = window[8];
  printf("first %d second %d window %lu\n", first, second, (unsigned long)window[8]);
  return 0;
}
