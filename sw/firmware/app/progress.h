/* The watchdog of the programs for several cameras: served only when the program gets on (loop_watch.h). That it stalls
 * is said before the watchdog bites, and what follows is said too: that it goes on, or after the reset, why it starts
 * again. */
#ifndef FOVEA_FIRMWARE_PROGRESS_H
#define FOVEA_FIRMWARE_PROGRESS_H

#include <stdint.h>

/** Says whether the watchdog has reset the chip, and starts it with this period in us; with 0 it stays off, and no
 * stall is said. */
void progress_start(uint32_t watchdog_us);

/** The program has got on: the watchdog is served. Not for interrupt handlers. */
void progress_made(void);

/** The program has got on if this number, of frames that came to nothing, is another one than before. */
void progress_without_frames(uint32_t given_up);

/** For the interrupt handler, in each field of the display: says where the program is if it has not got on for half of
 * the watchdog's period. */
void progress_look(void);

#endif
