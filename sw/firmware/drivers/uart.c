/* Linked into internal RAM with the boot code, so it must not call code in DDR2 (not even for
 * divisions). */
#include "uart.h"

#include "../mmio.h"
#include "../regs.h"

void uart_init(uint32_t divisor) {
  mmio_write32(UART0_PWREMU_MGMT, 0);
  mmio_write32(UART0_DLL, divisor & 0xFFu);
  mmio_write32(UART0_DLH, divisor >> 8);
  mmio_write32(UART0_FCR, 7); /* FIFOs enabled and cleared */
  mmio_write32(UART0_FCR, 1);
  mmio_write32(UART0_IER, 0);
  mmio_write32(UART0_LCR, 3); /* 8N1 */
  mmio_write32(UART0_MCR, 0);
  mmio_write32(UART0_PWREMU_MGMT, 0x6001u); /* transmitter and receiver enabled; bit 15 is reserved */
}

void uart_putc(char c) {
  while ((mmio_read32(UART0_LSR) & LSR_THRE) == 0) {
  }
  mmio_write32(UART0_THR, (uint8_t)c);
}

void uart_puts(const char *text) {
  for (; *text != '\0'; ++text) {
    if (*text == '\n') uart_putc('\r');
    uart_putc(*text);
  }
}

void uart_put_hex(uint32_t value) {
  uart_puts("0x");
  for (int shift = 28; shift >= 0; shift -= 4) {
    const uint32_t digit = (value >> shift) & 15u;
    uart_putc((char)(digit < 10 ? '0' + digit : 'a' + digit - 10));
  }
}

void uart_put_uint(uint32_t value) {
  static const uint32_t kPowers[] = {1000000000, 100000000, 10000000, 1000000, 100000,
                                     10000,      1000,      100,      10,      1};
  int started = 0;
  for (unsigned i = 0; i < sizeof kPowers / sizeof *kPowers; ++i) {
    char digit = '0';
    while (value >= kPowers[i]) {
      value -= kPowers[i];
      ++digit;
    }
    if (digit != '0' || started || kPowers[i] == 1) {
      started = 1;
      uart_putc(digit);
    }
  }
}

void uart_drain(void) {
  while ((mmio_read32(UART0_LSR) & LSR_TEMT) == 0) {
  }
}
