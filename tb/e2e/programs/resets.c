/* Lets the watchdog reset the chip again and again, each time after a longer time and in the middle of other
 * work, and shows at each boot what the reset has left: one line on UART0 with the number of the boot, RSTYPE, a
 * variable with an initial value, and what was counted in SDRAM. It starts in internal RAM by foreign_start.S.
 */
#include <stdint.h>

#include "sw/firmware/boot/boot.h"
#include "sw/firmware/drivers/cp15.h"
#include "sw/firmware/drivers/gpio.h"
#include "sw/firmware/drivers/psc.h"
#include "sw/firmware/drivers/uart.h"
#include "sw/firmware/mmio.h"
#include "sw/firmware/regs.h"

#define BOOTS 24u
#define WATCHDOG 0x01C21C00u
#define SYSTEM_PINMUX3 0x01C4000Cu
#define PLLC1_RSTYPE 0x01C408E4u
#define MAGIC 0xB007B007u

/* In internal RAM where no segment lies: kept by a reset. */
struct kept {
  uint32_t magic, boots;
};
#define KEPT ((volatile struct kept *)0x00003F00u)
/* The same in SDRAM, behind everything else; not cached. */
#define KEPT_SDRAM ((volatile struct kept *)0x80F00000u)
#define WORK 0x80100000u

volatile uint32_t aborts;
static volatile uint32_t initialised = 5; /* the boot loader brings it again */

void irq_handler(void) {}

static void show(const char *name, uint32_t value) {
  uart_puts(name);
  uart_put_uint(value);
}

static void watchdog_start(uint32_t ticks) {
  mmio_write32(WATCHDOG + 0x20u, 0);
  mmio_write32(WATCHDOG + 0x24u, 0xBu); /* watchdog, out of reset */
  mmio_write32(WATCHDOG + 0x18u, ticks);
  mmio_write32(WATCHDOG + 0x1Cu, 0);
  mmio_write32(WATCHDOG + 0x20u, 2u << 6);
  mmio_write32(WATCHDOG + 0x28u, 0xA5C64000u);
  mmio_write32(WATCHDOG + 0x28u, 0xDA7E4000u);
}

/* Each kind of work never ends by itself. */
static void work(uint32_t kind) {
  volatile uint32_t *const cached = (volatile uint32_t *)WORK;
  volatile uint32_t *const uncached = (volatile uint32_t *)0x80F10000u;
  for (uint32_t n = 0;; ++n) {
    switch (kind) {
      case 0: /* line fills and write-backs */
        cached[(n * 67u) & 0xFFFFu] += n;
        break;
      case 1: /* single writes and reads */
        uncached[n & 0xFFu] = n;
        (void)uncached[(n * 5u) & 0xFFu];
        break;
      case 2: /* register accesses, many in one instruction */
        __asm__ volatile("ldmia %0, {r4-r7}\n\tstmia %0, {r4-r7}"
                         : : "r"(GPIO_OUT(PHASE_BANK)) : "r4", "r5", "r6", "r7", "memory");
        break;
      case 3: /* nothing wakes it but the reset */
        wait_for_interrupt();
        break;
      case 4: /* locked pairs of accesses */
        __asm__ volatile("swp r4, %0, [%1]" : : "r"(n), "r"(uncached) : "r4", "memory");
        break;
      case 5: /* bytes on their way out of UART0, the next ones waiting */
        uart_putc('.');
        break;
      case 6: /* power transitions and a PLL that locks again */
        psc_transition(LPSC_GPIO, n & 1u ? PSC_ENABLE : PSC_SYNC_RESET);
        mmio_write32(0x01C40C00u + 0x110u, 0x60u + (n & 3u));
        break;
      default: /* the SDRAM's controller is switched off, and asked nevertheless */
        psc_transition(LPSC_DDR, PSC_SYNC_RESET);
        (void)uncached[0];
        break;
    }
  }
}

int main(void) {
  const uint32_t boots = KEPT->magic == MAGIC ? KEPT->boots : 0;
  const uint32_t in_sdram = KEPT_SDRAM->magic == MAGIC ? KEPT_SDRAM->boots : 0;
  show("boot ", boots);
  show(": rstype ", mmio_read32(PLLC1_RSTYPE));
  show(", initialised ", initialised);
  show(", sdram ", in_sdram);
  uart_puts(boots < BOOTS ? "\n" : "\nfinished\n");
  uart_drain();
  KEPT->magic = KEPT_SDRAM->magic = MAGIC;
  KEPT->boots = boots + 1;
  KEPT_SDRAM->boots = in_sdram + 1;
  initialised = 9;
  mmu_enable();
  psc_transition(LPSC_GPIO, PSC_ENABLE);
  phase_pins_init();
  if (boots == BOOTS)
    for (;;) wait_for_interrupt();
  watchdog_start(2000u + 131u * boots + boots * boots);
  work(boots & 7u);
  return 0;
}
