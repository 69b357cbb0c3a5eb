/* Boot loader of `fovea exec --board`: clocks by the switches and DDR2, without a word on the UART, and
 * on to a program that the host has put into SDRAM. The host fills in `start_state`. */
#include "../boot/boot.h"
#include "../boot/loader.h"

struct start_state start_state __attribute__((section(".data")));

void loader_main(struct start_state *state) {
  (void)state;
  boot_init();
}
