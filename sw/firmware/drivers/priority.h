/* Priorities of the memory masters on the crossbar. */
#ifndef FOVEA_FIRMWARE_PRIORITY_H
#define FOVEA_FIRMWARE_PRIORITY_H

#include <stdint.h>

#include "model/contract/param_page.h"

/** Writes the chip's registers for all masters whose priority is not PRIORITY_OF_RESET. The VPSS
 * must be on; the EDMA is switched on if its queues are changed. Queue n is that of transfer
 * controller n, as after reset. */
void priority_set(const uint8_t priority[PRIORITY_COUNT]);

#endif
