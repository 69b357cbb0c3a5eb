/* DIP switches on pins 0 to 15, phase marks on pins 64 to 75. */
#ifndef FOVEA_FIRMWARE_GPIO_H
#define FOVEA_FIRMWARE_GPIO_H

#include <stdint.h>

#include "../mmio.h"
#include "../regs.h"

enum phase {
  PHASE_BOOT = 1,
  PHASE_LUT = 2,
  PHASE_IDLE = 3,
  PHASE_REMAP_START = 4,
  PHASE_REMAP_END = 5,
  PHASE_FLIP = 6, /* written immediately before the OSD address registers */
  PHASE_FAILED = 7
};

#define PHASE_BANK 2u
#define PHASE_PIN_MASK 0xFFFu /* bits 3:0 phase, bits 11:4 frame number mod 256 */

static inline void phase_pins_init(void) { mmio_modify32(GPIO_DIR(PHASE_BANK), PHASE_PIN_MASK, 0); }

/** Marks a phase for external tools; `sequence` is the number of the frame. */
static inline void phase_mark(enum phase phase, uint32_t sequence) {
  mmio_write32(GPIO_OUT(PHASE_BANK), (uint32_t)phase | (sequence & 0xFFu) << 4);
}

/** The 16 switches, with switch n in bit n. */
static inline uint32_t dip_read(void) { return mmio_read32(GPIO_IN(0u)) & 0xFFFFu; }

#endif
