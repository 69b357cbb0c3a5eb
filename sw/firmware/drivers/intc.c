#include "intc.h"

#include "../mmio.h"
#include "../regs.h"

/* Registers come in pairs, for sources 0 to 31 and 32 to 63. */
static uint32_t bank(uint32_t source) { return source / 32u * 4u; }

void intc_init(void) {
  mmio_write32(AINTC_EINT0, 0);
  mmio_write32(AINTC_EINT1, 0);
  mmio_write32(AINTC_INTCTL, 0);
  mmio_write32(AINTC_EABASE, 0);
  mmio_write32(AINTC_FIQ0, 0xFFFFFFFFu);
  mmio_write32(AINTC_FIQ1, 0xFFFFFFFFu);
  mmio_write32(AINTC_IRQ0, 0xFFFFFFFFu);
  mmio_write32(AINTC_IRQ1, 0xFFFFFFFFu);
}

void intc_enable(uint32_t source, uint32_t priority) {
  const uint32_t shift = source % 8u * 4u;
  mmio_modify32(AINTC_INTPRI(source / 8u), 7u << shift, priority << shift);
  intc_acknowledge(source);
  mmio_modify32(AINTC_EINT0 + bank(source), 0, 1u << source % 32u);
}

void intc_disable(uint32_t source) {
  mmio_modify32(AINTC_EINT0 + bank(source), 1u << source % 32u, 0);
  intc_acknowledge(source);
}

uint32_t intc_pending(void) {
  const uint32_t entry = mmio_read32(AINTC_IRQENTRY);
  return entry == 0 ? INTC_NONE : (entry >> 2) - 1u;
}

void intc_acknowledge(uint32_t source) {
  mmio_write32(AINTC_IRQ0 + bank(source), 1u << source % 32u);
}
