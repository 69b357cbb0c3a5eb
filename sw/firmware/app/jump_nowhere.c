/* A guest that fails on purpose: jumps to an address where nothing is, with the vectors switched to
 * 0xFFFF0000, where nothing is either. The abort can therefore never be handled. */
#include <stdint.h>

#include "../drivers/uart.h"

int main(void) {
  uart_puts("Fovea: jumping to 0x70000000\n");
  uart_drain();
  uint32_t control;
  __asm__ volatile("mrc p15, 0, %0, c1, c0, 0" : "=r"(control));
  control |= 0x2000u; /* V: high vectors */
  __asm__ volatile("mcr p15, 0, %0, c1, c0, 0" : : "r"(control));
  ((void (*)(void))0x70000000u)();
  return 0;
}
