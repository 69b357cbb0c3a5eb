/* A program for the board: times a loop with TIMER0, which counts at 24 MHz. */
#include <stdint.h>
#include <stdio.h>

#define TIMER0(offset) (*(volatile uint32_t *)(0x01C21400u + (offset)))

int main(void) {
  TIMER0(0x18) = 0xFFFFFFFFu; /* PRD12: count as far as it goes */
  TIMER0(0x24) = 0x5;         /* TGCR: two timers of 32 bits, the first one out of reset */
  TIMER0(0x20) = 2u << 6;     /* TCR: the first one counts on and on */
  const uint32_t start = TIMER0(0x10);
  volatile uint32_t sum = 0;
  for (uint32_t i = 0; i < 1000; ++i) sum += i * i;
  const uint32_t ticks = TIMER0(0x10) - start;
  printf("sum %lu in %lu ticks\n", (unsigned long)sum, (unsigned long)ticks);
  return sum == 332833500u ? 0 : 1;
}
