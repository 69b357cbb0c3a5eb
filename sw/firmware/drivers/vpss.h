/* Clocks and interrupt routing of the video subsystem. */
#ifndef FOVEA_FIRMWARE_VPSS_H
#define FOVEA_FIRMWARE_VPSS_H

#include <stdint.h>

/** Opens the gates of capture and display, picks the encoder's clock source, routes VDINT0 to
 * VPSSINT0 and the encoder's field interrupt to VPSSINT8. */
void vpss_init(uint32_t vpss_clk_ctrl);

#endif
