/* A guest that fails deliberately: it jumps to an address without memory while the vectors are at
 * 0xFFFF0000, where there is no memory either, so the abort can never be handled. */
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
