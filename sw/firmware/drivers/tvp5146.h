/* TVP5146 video decoder at I2C address 0x5D. */
#ifndef FOVEA_FIRMWARE_TVP5146_H
#define FOVEA_FIRMWARE_TVP5146_H

#include "i2c.h"

#define TVP5146_ADDRESS 0x5Du

/** Selects the standard (625/50 or 525/60), embedded syncs, and turns data and clock on.
 * `id`: the two identification bytes, 0x5146 for this chip. */
__attribute__((warn_unused_result)) i2c_result_t tvp5146_start(int is_625, uint32_t *id);

/** Polls until the decoder follows the camera's line and field syncs; until then it sends black.
 * Looks at least once; `pause` is called between two looks.
 * @return I2C_TIMEOUT: no lock within `timeout_ticks` (24 MHz), or the bus hangs. */
__attribute__((warn_unused_result)) i2c_result_t tvp5146_wait_lock(uint32_t timeout_ticks,
                                                                   void (*pause)(void));

#endif
