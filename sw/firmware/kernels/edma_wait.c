#include "edma_wait.h"

#include "../drivers/cp15.h"
#include "../drivers/edma.h"
#include "../drivers/intc.h"
#include "../drivers/timer.h"
#include "../drivers/uart.h"
#include "../app/say.h" /* behind uart.h */
#include "../regs.h"

#define INTERRUPT_PRIORITY 4u
#define LONGEST_TICKS (2000u * TIMER_TICKS_PER_MS)

void edma_wait_prepare(edma_codes_t codes) {
  /* A frame that comes while a table is built in the background must find the interrupts open. */
  const uint32_t cpsr = irq_mask();
  edma_init();
  for (uint32_t n = 0; codes.mask >> n != 0; ++n)
    if (codes.mask >> n & 1u) edma_open_interrupt(codes.first + codes.pitch * n);
  intc_enable(IRQ_EDMA_CCINT0, INTERRUPT_PRIORITY);
  irq_restore(cpsr);
}

/* Clears the codes that have been reported, and returns those still missing. All are looked at each
 * time: the interrupt comes again only when no open code is pending. */
static uint32_t still_missing(edma_codes_t codes) {
  for (uint32_t n = 0; codes.mask >> n != 0; ++n) {
    const uint32_t code = codes.first + codes.pitch * n;
    if ((codes.mask >> n & 1u) == 0 || !edma_done(code)) continue;
    edma_clear(code);
    codes.mask &= ~(1u << n);
  }
  return codes.mask;
}

/* One string for the number: with a console it goes through a queue, which uart_put_hex() passes by. */
static void report(const char *what, uint32_t bits) {
  char text[] = "0x00000000\n";
  for (uint32_t n = 0; n < 8u; ++n) text[9u - n] = "0123456789abcdef"[bits >> 4u * n & 15u];
  uart_puts("EDMA: ");
  uart_puts(what);
  uart_puts(text);
}

void edma_wait_all(edma_codes_t codes) {
  const uint32_t start = timer_ticks();
  edma_codes_t missing = codes;
  for (;;) {
    /* Checked with interrupts masked: one that comes after the check still ends the sleep. */
    const uint32_t cpsr = irq_mask();
    const uint32_t before = missing.mask;
    missing.mask = still_missing(missing);
    const int late = timer_ticks() - start > LONGEST_TICKS;
    if (missing.mask != 0 && missing.mask == before && !late) wait_for_interrupt();
    irq_restore(cpsr);
    if (missing.mask == 0 || late) break;
  }
  const uint32_t errors = edma_errors();
  if (errors != 0) report("errors ", errors);
  if (missing.mask != 0) report("no report of ", missing.mask);
  if (errors != 0 || missing.mask != 0) edma_wait_prepare(codes);
}
