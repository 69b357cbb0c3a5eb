/* Shows the phases of a look-up table until the watchdog resets the chip; then it stays in the first phase. It starts
 * in internal RAM by foreign_start.S.
 */
#include <stdint.h>

#include "sw/firmware/drivers/gpio.h"
#include "sw/firmware/drivers/psc.h"
#include "sw/firmware/mmio.h"
#include "sw/firmware/regs.h"

#define WATCHDOG 0x01C21C00u
/* In internal RAM where no segment lies: kept by a reset. */
#define KEPT ((volatile uint32_t *)0x00003F00u)
#define MAGIC 0xB007B007u

volatile uint32_t aborts;

void irq_handler(void) {}

int main(void) {
  psc_transition(LPSC_GPIO, PSC_ENABLE);
  phase_pins_init();
  phase_mark(PHASE_BOOT, 0);
  if (*KEPT == MAGIC)
    for (;;) {
    }
  *KEPT = MAGIC;
  phase_mark(PHASE_LUT, 0);
  mmio_write32(WATCHDOG + 0x20u, 0);
  mmio_write32(WATCHDOG + 0x24u, 0xBu); /* watchdog, out of reset */
  mmio_write32(WATCHDOG + 0x18u, 24000);
  mmio_write32(WATCHDOG + 0x1Cu, 0);
  mmio_write32(WATCHDOG + 0x20u, 2u << 6);
  mmio_write32(WATCHDOG + 0x28u, 0xA5C64000u);
  mmio_write32(WATCHDOG + 0x28u, 0xDA7E4000u);
  for (;;) {
  }
}
