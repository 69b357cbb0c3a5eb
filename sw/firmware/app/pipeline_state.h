/* What the files of the pipeline share (pipeline.c, and pipeline_turns.c of the programs for several cameras). All of
 * it is used by the interrupt handler; the main loop accesses it with IRQ masked. */
#ifndef FOVEA_FIRMWARE_PIPELINE_STATE_H
#define FOVEA_FIRMWARE_PIPELINE_STATE_H

#include <stdint.h>

#include "capture.h"
#include "config.h"
#include "output.h"
#include "state.h"
#ifdef TIME_DIVISION
#include "display_watch.h"
#include "field_watch.h"
#include "open_frame.h"
#include "turns.h"
#endif

typedef struct pipeline {
  capture_t capture;
  output_t output;
  uint32_t pitch_bytes;
  uint32_t field_ticks;
  int serial;
  int progressive; /* the camera: each of its fields is a frame */
  int passthrough;
  int capturing;       /* the current frame is written to memory */
  int capture_wanted;  /* capture starts with the next frame */
  int in_second_field; /* of the display, since second_field_start */
  uint32_t second_field_start;
  int window_on;
  uint32_t sources; /* number of frames that a remap may read */
  held_t held;      /* those frames; only the main loop uses this and what follows */
  int32_t taken_out;
  uint32_t taken_sequence;
#ifdef TIME_DIVISION
  turns_t turns;
  const config_t *config;
  uint32_t standard;     /* that a camera must send, as the decoder tells it */
  int complete;          /* the second field of the frame that is captured has ended */
  uint32_t quiet_fields; /* of the display, since the last field of a camera */
  uint8_t camera_of[CAPTURE_BUFFERS_MAX]; /* whose frame is in each buffer */
  uint32_t taken_camera;
  field_watch_t watch;
  open_frame_t open; /* only within the handler */
  display_watch_t display_watch;
#endif
#ifdef COMPOSED_VIEW
  int32_t kept[CAMERAS_MAX]; /* buffers of the newest frames; CAPTURE_NONE before the first one */
  const uint8_t *kept_frame[CAMERAS_MAX];
  int32_t replaced; /* the buffer whose place the last one has taken, until pipeline_done(); CAPTURE_NONE: none */
#endif
} pipeline_t;

extern pipeline_t pipe;

static inline uint8_t *pipeline_buffer(int32_t n) { return frame_in + (uint32_t)n * frame_stride; }

#endif
