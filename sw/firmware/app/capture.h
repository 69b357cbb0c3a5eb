/* Manages the input buffers: which one is being filled, which is complete, which are in use. Called
 * from the interrupt handler and, with interrupts masked, from the main loop. No hardware access,
 * so that it can be tested on the host. */
#ifndef FOVEA_FIRMWARE_CAPTURE_H
#define FOVEA_FIRMWARE_CAPTURE_H

#include <stdint.h>

#define CAPTURE_NONE (-1)
#define CAPTURE_BUFFERS_MAX 8u

typedef struct capture {
  uint32_t buffer_count;
  uint32_t next_sequence; /* number of the frame that is being captured */
  uint32_t dropped;
  int32_t filling;
  int32_t ready; /* complete and waiting for the main loop */
  uint32_t ready_sequence;
  uint32_t busy; /* bit n: buffer n is used by remap or display */
  uint32_t reused; /* bit n: buffer n is or was filled anew without having been taken, or after a frame of no use */
} capture_t;

/** Initial state: buffer 0 is being filled. */
void capture_init(capture_t *capture, uint32_t buffer_count);

/** To be called when a frame is complete: it becomes `ready`, and a frame that was still waiting is
 * dropped and counted. @return the buffer for the next frame; CAPTURE_NONE if all are in use. In
 * that case the completed frame is dropped too and its buffer is filled again (only with fewer than
 * three free buffers). */
int32_t capture_frame_done(capture_t *capture);

/** A frame was captured that is of no use: it is dropped and counted, and its buffer is filled again. */
static inline void capture_frame_useless(capture_t *capture) {
  ++capture->next_sequence;
  ++capture->dropped;
  capture->reused |= 1u << capture->filling;
}

/** Part of a frame was captured, which is not counted, and its buffer is filled again. */
static inline void capture_frame_broken(capture_t *capture) { capture->reused |= 1u << capture->filling; }

/** The next frame is to be filled into a buffer that is not `reused`, if one is free. @return that buffer, or
 * CAPTURE_NONE: it stays as it was */
int32_t capture_move_on(capture_t *capture);

/** A free buffer with the bit `reused`, which is busy from now on until capture_release(); CAPTURE_NONE if there is
 * none. */
int32_t capture_take_reused(capture_t *capture);

/** For the serial flow with one buffer: the frame becomes `ready`, and capture pauses until its
 * release. */
void capture_single_done(capture_t *capture);

/** Takes the waiting frame. Its buffer is in use until capture_release(). */
int32_t capture_take(capture_t *capture, uint32_t *sequence);

void capture_release(capture_t *capture, int32_t buffer);

/* Frames that were taken and are still read, in the order in which they were taken. */
typedef struct held {
  uint32_t count;
  int32_t buffer[CAPTURE_BUFFERS_MAX];
} held_t;

/** Adds the newest frame. There must be room: at most CAPTURE_BUFFERS_MAX are held. */
void held_add(held_t *held, int32_t buffer);

/** The oldest frame is no longer held. @return its buffer; at least one must be held */
int32_t held_drop(held_t *held);

/** Buffer of the frame that was taken `age` frames before the newest; `age` is less than `count`.
 */
int32_t held_of_age(const held_t *held, uint32_t age);

#endif
