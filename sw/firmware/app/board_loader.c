/* Boot loader of `fovea exec --board`: sets the clocks by the parameter page, starts DDR2 without output
 * on the UART, and starts a program that the host has put into SDRAM. The host fills in
 * `start_state`. */
#include "../boot/boot.h"
#include "../boot/loader.h"

struct start_state start_state __attribute__((section(".data")));

uint32_t loader_main(struct start_state *state) {
  (void)state;
  return boot_init((const param_page_t *)PARAM_PAGE_BASE);
}
