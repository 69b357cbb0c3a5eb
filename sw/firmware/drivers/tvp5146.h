/* TVP5146 video decoder at I2C address 0x5D. */
#ifndef FOVEA_FIRMWARE_TVP5146_H
#define FOVEA_FIRMWARE_TVP5146_H

#include "i2c.h"

#define TVP5146_ADDRESS 0x5Du

/** Selects the standard (625/50 or 525/60) with embedded syncs, and enables the data and clock
 * outputs. `id` receives the two identification bytes, 0x5146 for this chip. */
__attribute__((warn_unused_result)) i2c_result_t tvp5146_start(int is_625, uint32_t *id);

/** Polls until the decoder has locked to the line and field syncs of the camera; before that, it
 * sends black. Polls at least once and calls `pause` between two polls. @return I2C_TIMEOUT if
 * there is no lock within `timeout_ticks` (24 MHz), or if the bus hangs */
__attribute__((warn_unused_result)) i2c_result_t tvp5146_wait_lock(uint32_t timeout_ticks,
                                                                   void (*pause)(void));

#endif
