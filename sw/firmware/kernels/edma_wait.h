/* Waiting for completion codes of the EDMA, asleep. */
#ifndef FOVEA_FIRMWARE_EDMA_WAIT_H
#define FOVEA_FIRMWARE_EDMA_WAIT_H

#include <stdint.h>

/** Completion codes `first` + n * `pitch`, for each bit n of `mask`. */
typedef struct edma_codes {
  uint32_t first, pitch, mask;
} edma_codes_t;

/** Switches the EDMA on, and opens the interrupts of these codes. */
void edma_wait_prepare(edma_codes_t codes);

/** Sleeps until all of these codes have been reported, and clears them. Interrupts are handled
 * meanwhile. Errors of the EDMA, or no report for two seconds, are a line on the UART; the EDMA is
 * then started anew for the next frame. */
void edma_wait_all(edma_codes_t codes);

#endif
