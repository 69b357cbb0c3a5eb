/* Interrupt controller: sources 0 to 63. */
#ifndef FOVEA_FIRMWARE_INTC_H
#define FOVEA_FIRMWARE_INTC_H

#include <stdint.h>

#define INTC_NONE 64u

/** Sets 4-byte entries at base 0, disables all sources and clears all pending ones. */
void intc_init(void);

/** Enables a source with priority 2 (highest IRQ) to 7. */
void intc_enable(uint32_t source, uint32_t priority);

/** Disables a source and clears its pending status. */
void intc_disable(uint32_t source);

/** The number of the most urgent pending source; INTC_NONE if there is none (spurious interrupt).
 */
uint32_t intc_pending(void);

/** Clears the pending status of a source. To be called before the interrupt is handled: an edge
 * that arrives while the handler runs is then latched again and not lost. */
void intc_acknowledge(uint32_t source);

#endif
