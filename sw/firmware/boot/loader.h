/* A boot loader in internal RAM (loader.S): how the program in SDRAM is started. */
#ifndef FOVEA_FIRMWARE_LOADER_H
#define FOVEA_FIRMWARE_LOADER_H

#include <stdint.h>

/** Registers at the program's first instruction; bit 0 of `entry` set means Thumb. */
struct start_state {
  uint32_t r0, r1, r2, sp, entry;
};
extern struct start_state start_state;

/** Prepares the board and fills in what is not yet in the state. */
void loader_main(struct start_state *state);

#endif
