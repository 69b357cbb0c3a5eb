/* A captured frame that is complete, while it is not known yet whether it is of use. It is neither waiting nor filled
 * anew meanwhile. No hardware access, so that it can be tested on the host. */
#ifndef FOVEA_FIRMWARE_OPEN_FRAME_H
#define FOVEA_FIRMWARE_OPEN_FRAME_H

#include <stdint.h>

#include "capture.h"

typedef struct open_frame {
  int32_t buffer; /* CAPTURE_NONE: there is none */
  uint32_t sequence;
} open_frame_t;

/** In place of capture_frame_done(): the complete frame is the open one. There must be none. @return the buffer for the
 * next frame; CAPTURE_NONE if there is none: the complete frame is dropped, and its buffer filled again */
int32_t open_frame_begin(open_frame_t *open, capture_t *capture);

/** The open frame is of use: it becomes `ready`, and a frame that was still waiting is dropped and counted. */
void open_frame_good(open_frame_t *open, capture_t *capture);

/** The open frame is of no use: it is dropped and counted. */
void open_frame_useless(open_frame_t *open, capture_t *capture);

#endif
