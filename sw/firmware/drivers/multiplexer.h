/* The analogue multiplexer between the cameras and the decoder. */
#ifndef FOVEA_FIRMWARE_MULTIPLEXER_H
#define FOVEA_FIRMWARE_MULTIPLEXER_H

#include <stdint.h>

#include "../mmio.h"
#include "../regs.h"
#include "model/contract/multiplexer.h"

/** Leads another camera through. All select lines change in one write, so that no other camera is seen in between. */
static inline void multiplexer_select(uint32_t camera) {
  mmio_modify32(GPIO_OUT(MULTIPLEXER_BANK), MULTIPLEXER_PIN_MASK, MULTIPLEXER_WORD(camera));
}

/** Drives the select lines, with camera 0 led through. */
static inline void multiplexer_start(void) {
  multiplexer_select(0);
  mmio_modify32(GPIO_DIR(MULTIPLEXER_BANK), MULTIPLEXER_PIN_MASK, 0);
}

#endif
