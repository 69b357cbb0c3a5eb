/* Whether the main loop gets on. Progress is a frame that was finished or left out, a table that was built, or a camera
 * that is known to give none. No hardware access, so that it can be tested on the host. Times are ticks of 24 MHz, from
 * a counter that wraps. */
#ifndef FOVEA_FIRMWARE_LOOP_WATCH_H
#define FOVEA_FIRMWARE_LOOP_WATCH_H

#include <stdint.h>

typedef struct loop_watch {
  uint32_t patience; /* ticks without progress after which the loop is said to stall */
  uint32_t last;     /* time of the last progress */
  int stalled;       /* as was said last */
} loop_watch_t;

void loop_watch_init(loop_watch_t *watch, uint32_t patience, uint32_t now);

/** The loop has got on. @return the ticks since it did so before, if it was said to stall; otherwise 0 */
uint32_t loop_watch_progress(loop_watch_t *watch, uint32_t now);

/** For an interrupt handler, now and then. @return 1 if the loop is to be said to stall: once until it gets on */
int loop_watch_look(loop_watch_t *watch, uint32_t now);

#endif
