/* Interrupt controller: sources 0 to 63. */
#ifndef FOVEA_FIRMWARE_INTC_H
#define FOVEA_FIRMWARE_INTC_H

#include <stdint.h>

#define INTC_NONE 64u

/** Entry size 4 at base 0, everything masked, pending sources dropped. */
void intc_init(void);

/** Enables a source with priority 2 (highest IRQ) to 7. */
void intc_enable(uint32_t source, uint32_t priority);

/** Disables a source and drops its pending mark. */
void intc_disable(uint32_t source);

/** Number of the most urgent pending source, INTC_NONE if there is none (spurious). */
uint32_t intc_pending(void);

/** Drops the pending mark of a source. Before serving it: an edge that comes while the
 * handler runs is then latched again and not lost. */
void intc_acknowledge(uint32_t source);

#endif
