/* A minimal program: boots like the others, prints a greeting on the UART and sleeps. */
#include "../boot/boot.h"
#include "../drivers/gpio.h"
#include "../drivers/uart.h"

int main(void) {
  uart_puts("Fovea: hello from DDR2\n");
  uart_drain();
  phase_mark(PHASE_IDLE, 0);
  stop();
}
