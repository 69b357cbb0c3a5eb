/* Which input buffer is filled, waits or is worked on. Called from the interrupt handler and, with
 * interrupts masked, from the main loop. No hardware access: tested on the host. */
#ifndef FOVEA_FIRMWARE_CAPTURE_H
#define FOVEA_FIRMWARE_CAPTURE_H

#include <stdint.h>

#define CAPTURE_NONE (-1)
#define CAPTURE_BUFFERS_MAX 8u

typedef struct capture {
  uint32_t buffer_count;
  uint32_t next_sequence; /* number of the frame being captured */
  uint32_t dropped;
  int32_t filling;
  int32_t ready; /* complete, waiting for the main loop */
  uint32_t ready_sequence;
  uint32_t busy; /* bit n: buffer n is in use by remap or display */
} capture_t;

/** Starts with buffer 0 being filled. */
void capture_init(capture_t *capture, uint32_t buffer_count);

/** A frame is complete: it becomes `ready`. One that was still waiting is dropped and counted.
 * @return buffer for the next frame, CAPTURE_NONE if all are in use: the frame just completed is
 * then dropped too and its buffer filled again (only with fewer than three free buffers). */
int32_t capture_frame_done(capture_t *capture);

/** Serial flow, one buffer: the frame becomes `ready` and capture pauses until it is released. */
void capture_single_done(capture_t *capture);

/** Takes the waiting frame: its buffer counts as busy until capture_release(). */
int32_t capture_take(capture_t *capture, uint32_t *sequence);

void capture_release(capture_t *capture, int32_t buffer);

#endif
