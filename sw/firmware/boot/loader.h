/* A boot loader in internal RAM (loader.S): how it starts the program in SDRAM. */
#ifndef FOVEA_FIRMWARE_LOADER_H
#define FOVEA_FIRMWARE_LOADER_H

#include <stdint.h>

/** Registers at the program's first instruction; bit 0 of `entry` selects the Thumb state. */
struct start_state {
  uint32_t r0, r1, r2, sp, entry;
};
extern struct start_state start_state;

/** Prepares the board and sets the members of the state that are not set yet. @return 0; anything else stops the
 * loader */
uint32_t loader_main(struct start_state *state);

#endif
