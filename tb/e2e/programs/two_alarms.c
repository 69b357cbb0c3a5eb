/* Both halves of TIMER0 raise interrupts with periods that differ by a clock of the timer, while the core loads from
 * the SDRAM and stores there through the write buffer: each rises in every position of an access, and both at once. It
 * starts in internal RAM by foreign_start.S.
 */
#include <stdint.h>

#include "sw/firmware/drivers/cp15.h"

#define AINTC 0x01C48000u
#define TIMER0 0x01C21400u
#define WORK 0x80100000u

static volatile uint32_t *reg(uint32_t address) { return (volatile uint32_t *)(uintptr_t)address; }

volatile uint32_t aborts;

/* Acknowledges what has come. */
void irq_handler(void) { *reg(AINTC + 0x0c) = 3; }

int main(void) {
  mmu_enable();
  *reg(AINTC + 0x1c) = 3;        /* EINT1: sources 32 and 33 */
  *reg(TIMER0 + 0x20) = 0;       /* TCR: off */
  *reg(TIMER0 + 0x24) = 0;
  *reg(TIMER0 + 0x10) = 0;
  *reg(TIMER0 + 0x14) = 0;
  *reg(TIMER0 + 0x18) = PERIOD;  /* PRD12, PRD34 */
  *reg(TIMER0 + 0x1c) = PERIOD + 1;
  *reg(TIMER0 + 0x24) = 7;       /* TGCR: unchained, both out of reset */
  *reg(TIMER0 + 0x20) = 0x00800080u; /* TCR: both go on and on */
#ifndef MASKED /* then the line of the first interrupt stays as it is */
  __asm__ volatile("msr cpsr_c, #0x53"); /* IRQ open */
#endif
  for (;;)
    for (uint32_t at = WORK; at < WORK + 0x100000; at += 36) {
      const uint32_t x = *reg(at);
      *reg(at + 4) = x;
      *reg(at + 68) = x;
      *reg(at + 0x8000) = x;
    }
}
