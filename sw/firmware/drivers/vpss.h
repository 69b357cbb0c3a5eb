/* Clocks and interrupt routing of the video subsystem. */
#ifndef FOVEA_FIRMWARE_VPSS_H
#define FOVEA_FIRMWARE_VPSS_H

#include <stdint.h>

#include "../mmio.h"
#include "../regs.h"

/** Enables the clocks of capture and display, selects the encoder's clock, and routes VDINT0 to
 * VPSSINT0 and the encoder's field interrupt to VPSSINT8. */
void vpss_init(uint32_t vpss_clk_ctrl);

/** Routes VDINT2 to VPSSINT2, to which the public drivers route nothing. */
static inline void vpss_route_vdint2(void) {
  mmio_modify32(ISP5_INTSEL1, VPSS_INTSEL1_N2, ISP5_SOURCE_VDINT2 << 16);
}

#endif
