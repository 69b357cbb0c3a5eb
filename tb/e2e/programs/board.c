/* A program linked with newlib that also uses the chip: semihosting for text, UART0 and TIMER0
 * directly. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define REG(address) (*(volatile uint32_t *)(address))
#define UART0 0x01C20000u
#define TIMER0 0x01C21400u
#define PLLC2 0x01C40C00u

static void put(const char *text) {
  for (; *text; ++text) {
    while ((REG(UART0 + 0x14) & 0x20) == 0) {
    }
    REG(UART0) = (uint8_t)*text;
  }
  while ((REG(UART0 + 0x14) & 0x40) == 0) {
  }
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "uart") == 0) {
    put("ping\n");
    for (;;) {
    }
  }
  if (argc > 1 && strcmp(argv[1], "loop") == 0)
    for (volatile unsigned n = 0;; ++n) {
    }
  printf("main: %d arguments, %s %s\n", argc - 1, argv[1], argv[2]);
  REG(TIMER0 + 0x24) = 0x15; /* unchained, lower half out of reset */
  REG(TIMER0 + 0x18) = 0xFFFFFFFFu;
  REG(TIMER0 + 0x20) = 0x80; /* continuously */
  const uint32_t before = REG(TIMER0 + 0x10);
  put("pong");
  const uint32_t clocks = REG(TIMER0 + 0x10) - before;
  printf("\nuart: 4 bytes in %u us\n", (unsigned)(clocks / 24));
  printf("PLLM of PLLC2: 0x%x\n", (unsigned)REG(PLLC2 + 0x110));
  return 7;
}
