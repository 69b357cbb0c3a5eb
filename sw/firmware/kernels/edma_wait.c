#include "edma_wait.h"

#include "../drivers/cp15.h"
#include "../drivers/edma.h"
#include "../drivers/intc.h"
#include "../drivers/timer.h"
#include "../drivers/uart.h"
#include "../regs.h"

#define INTERRUPT_PRIORITY 4u
#define LONGEST_TICKS (2000u * TIMER_TICKS_PER_MS)

void edma_wait_prepare(uint32_t first, uint32_t pitch, uint32_t count) {
  edma_init();
  for (uint32_t n = 0; n < count; ++n) edma_open_interrupt(first + pitch * n);
  intc_enable(IRQ_EDMA_CCINT0, INTERRUPT_PRIORITY);
}

/* Clears the codes that have been reported, and returns those still missing. All are looked at each time:
 * the interrupt comes again only when no open code is pending. */
static uint32_t still_missing(uint32_t missing, uint32_t first, uint32_t pitch) {
  for (uint32_t n = 0; missing >> n != 0; ++n) {
    const uint32_t code = first + pitch * n;
    if ((missing >> n & 1u) == 0 || !edma_done(code)) continue;
    edma_clear(code);
    missing &= ~(1u << n);
  }
  return missing;
}

static void report(const char *what, uint32_t number) {
  uart_puts("EDMA: ");
  uart_puts(what);
  uart_put_hex(number);
  uart_puts("\n");
}

void edma_wait_all(uint32_t first, uint32_t pitch, uint32_t count) {
  const uint32_t start = timer_ticks();
  uint32_t missing = (1u << count) - 1u;
  for (;;) {
    /* Checked with interrupts masked: one that comes after the check still ends the sleep. */
    const uint32_t cpsr = irq_mask();
    const uint32_t before = missing;
    missing = still_missing(missing, first, pitch);
    const int late = timer_ticks() - start > LONGEST_TICKS;
    if (missing != 0 && missing == before && !late) wait_for_interrupt();
    irq_restore(cpsr);
    if (missing == 0 || late) break;
  }
  const uint32_t errors = edma_errors();
  if (errors != 0) report("errors ", errors);
  if (missing != 0) report("no report of ", missing);
  if (errors != 0 || missing != 0) edma_wait_prepare(first, pitch, count);
}
