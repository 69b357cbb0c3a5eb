#include "timer.h"

#include "../mmio.h"
#include "../regs.h"

#define TCR_ENAMODE12_CONTINUOUS (2u << 6)
#define TCR_ENAMODE34 (3u << 22)
#define TCR_ENAMODE34_ONCE (1u << 22)
#define TGCR_DUAL_UNCHAINED (1u << 2)
#define TGCR_TIM12RS (1u << 0)
#define TGCR_TIM34RS (1u << 1)

void timer_start(void) {
  mmio_write32(TIMER0_TCR, 0);
  mmio_write32(TIMER0_TGCR, 0);
  mmio_write32(TIMER0_TIM12, 0);
  mmio_write32(TIMER0_PRD12, 0xFFFFFFFFu);
  mmio_write32(TIMER0_TGCR, TGCR_DUAL_UNCHAINED | TGCR_TIM12RS);
  mmio_write32(TIMER0_TCR, TCR_ENAMODE12_CONTINUOUS);
}

uint32_t timer_ticks(void) { return mmio_read32(TIMER0_TIM12); }

void timer_alarm(uint32_t ticks) {
  mmio_modify32(TIMER0_TCR, TCR_ENAMODE34, 0);
  mmio_write32(TIMER0_TIM34, 0);
  mmio_write32(TIMER0_PRD34, ticks);
  mmio_modify32(TIMER0_TGCR, 0, TGCR_TIM34RS);
  mmio_modify32(TIMER0_TCR, 0, TCR_ENAMODE34_ONCE);
}
