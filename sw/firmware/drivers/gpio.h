/* DIP switches on pins 0 to 15, phase marks on pins 64 to 75. */
#ifndef FOVEA_FIRMWARE_GPIO_H
#define FOVEA_FIRMWARE_GPIO_H

#include <stdint.h>

#include "../mmio.h"
#include "../regs.h"
#include "model/contract/phases.h"
#include "model/contract/switches.h"

static inline void phase_pins_init(void) { mmio_modify32(GPIO_DIR(PHASE_BANK), PHASE_PIN_MASK, 0); }

/** Marks a phase for external tools; `sequence` is the number of the frame. */
static inline void phase_mark(enum phase phase, uint32_t sequence) {
  mmio_write32(GPIO_OUT(PHASE_BANK), PHASE_WORD(phase, sequence));
}

/** The switches, with switch n in bit n. */
static inline uint32_t dip_read(void) { return mmio_read32(GPIO_IN(0u)) & ((1u << SWITCH_COUNT) - 1u); }

#endif
