#include "watchdog.h"

#include "../mmio.h"
#include "../regs.h"

#define TCR_CONTINUOUS (2u << 6)
#define TGCR_WATCHDOG (2u << 2)
#define TGCR_RUN (TIMER2_TGCR_TIM12RS | TIMER2_TGCR_TIM34RS)
#define KEY_1 (0xA5C6u << 16)
#define KEY_2 (0xDA7Eu << 16)
/* Of RSTYPE; TI's headers for sister chips call it the maximum reset. That the watchdog's reset sets it, and not that
 * of a warm one, follows from what TI's boot loader does (model/decisions/0015-reset.md). */
#define RSTYPE_MAXIMUM (1u << 2)

void watchdog_start(uint32_t microseconds) {
  const uint64_t ticks = (uint64_t)microseconds * WATCHDOG_TICKS_PER_US;
  mmio_write32(TIMER2_TCR, 0);
  mmio_write32(TIMER2_TGCR, 0);
  mmio_write32(TIMER2_TGCR, TGCR_WATCHDOG | TGCR_RUN);
  mmio_write32(TIMER2_TIM12, 0);
  mmio_write32(TIMER2_TIM34, 0);
  mmio_write32(TIMER2_PRD12, (uint32_t)ticks);
  mmio_write32(TIMER2_PRD34, (uint32_t)(ticks >> 32));
  mmio_write32(TIMER2_TCR, TCR_CONTINUOUS);
  watchdog_serve();
}

void watchdog_serve(void) {
  mmio_write32(TIMER2_WDTCR, KEY_1 | TIMER2_WDTCR_WDEN);
  mmio_write32(TIMER2_WDTCR, KEY_2 | TIMER2_WDTCR_WDEN);
}

int watchdog_has_reset(void) { return (mmio_read32(PLL1_RSTYPE) & RSTYPE_MAXIMUM) != 0; }
