#ifndef FOVEA_FIRMWARE_PSC_H
#define FOVEA_FIRMWARE_PSC_H

#include <stdint.h>

/** Changes the state of a module (PSC_ENABLE, PSC_SYNC_RESET) and waits until MDSTAT shows it. */
void psc_transition(uint32_t module, uint32_t state);

#endif
