/* Waiting for completion codes of the EDMA, asleep. */
#ifndef FOVEA_FIRMWARE_EDMA_WAIT_H
#define FOVEA_FIRMWARE_EDMA_WAIT_H

#include <stdint.h>

/** Switches the EDMA on, and opens the interrupts of `count` codes `pitch` apart. */
void edma_wait_prepare(uint32_t first, uint32_t pitch, uint32_t count);

/** Sleeps until all of these codes have been reported, and clears them. Interrupts are handled
 * meanwhile. Errors of the EDMA, or no report for two seconds, are a line on the UART; the EDMA is
 * then started anew for the next frame. */
void edma_wait_all(uint32_t first, uint32_t pitch, uint32_t count);

#endif
