#include "exception.h"

#include "../drivers/gpio.h"
#include "../drivers/uart.h"
#include "boot.h"

void fatal_exception(uint32_t kind, uint32_t pc) {
  static const char *const kNames[] = {"undefined instruction", "software interrupt",
                                       "prefetch abort",        "data abort",
                                       "fast interrupt",        "interrupt without a handler"};
  uint32_t fsr, far;
  __asm__ volatile("mrc p15, 0, %0, c5, c0, 0" : "=r"(fsr));
  __asm__ volatile("mrc p15, 0, %0, c6, c0, 0" : "=r"(far));
  phase_mark(PHASE_FAILED, 0);
  uart_puts("fatal: ");
  uart_puts(kNames[kind]);
  uart_puts(" at ");
  uart_put_hex(pc);
  if (kind == 3) {
    uart_puts(", status ");
    uart_put_hex(fsr);
    uart_puts(", address ");
    uart_put_hex(far);
  }
  uart_puts("\n");
  uart_drain();
  stop();
}
