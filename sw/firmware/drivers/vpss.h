/* Clocks and interrupt routing of the video subsystem. */
#ifndef FOVEA_FIRMWARE_VPSS_H
#define FOVEA_FIRMWARE_VPSS_H

#include <stdint.h>

#include "../mmio.h"
#include "../regs.h"

/** Enables the clocks of capture and display, selects the encoder's clock, and routes VDINT0 to
 * VPSSINT0 and the encoder's field interrupt to VPSSINT8. */
void vpss_init(uint32_t vpss_clk_ctrl);

#endif
