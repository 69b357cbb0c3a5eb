/* Time division: whose turn it is at the decoder. No hardware access, so that it can be tested on the host. Called at
 * each frame boundary of the raster that the decoder sends. */
#ifndef FOVEA_FIRMWARE_TURNS_H
#define FOVEA_FIRMWARE_TURNS_H

#include <stdint.h>

#include "model/contract/param_page.h"

/* A camera for whose lock so many frames were waited is left out for a while. */
#define TURNS_LOCK_FRAMES 50u
/* A camera that was left out gets its turn again after so many frame boundaries. */
#define TURNS_REST_FRAMES 25u
/* A camera whose syncs were irregular, or whose frames lacked parts, gives frames again when so many in its turns were
 * regular. */
#define TURNS_REGULAR_FRAMES 25u
#define TURNS_EVENTS 16u
#define TURNS_SEQUENCE_MAX 16u

/* What the decoder says of the selected camera. */
typedef struct signal_state {
  int present;        /* there is a signal on the input */
  int locked;         /* line and field lock */
  int lost;           /* the lock was lost since this was last cleared */
  int right_standard; /* of the signal, if it is locked */
} signal_state_t;

typedef enum camera_event {
  CAMERA_FINE = 0,       /* it is back */
  CAMERA_NO_SIGNAL,      /* nothing on the input */
  CAMERA_NO_LOCK,        /* no lock within TURNS_LOCK_FRAMES */
  CAMERA_WRONG_STANDARD,
  CAMERA_NO_FRAMES,      /* no frame boundary came */
  CAMERA_LOST,           /* the lock was lost while a frame was captured; the frame is not used */
  CAMERA_OVERFLOW,       /* parts of its frames were not written to memory */
  CAMERA_IRREGULAR,      /* fields of a wrong length: missing or short lines, or damaged timing codes */
  CAMERA_CLOCK_OFF,      /* its clock; frames are used all the same */
  CAMERA_CLOCK_RIGHT,
  CAMERA_EVENTS
} camera_event_t;

typedef struct turns {
  uint32_t count;  /* cameras */
  uint32_t now;    /* the one whose turn it is */
  uint8_t sequence[TURNS_SEQUENCE_MAX]; /* of the cameras in turn; at the start all of them */
  uint32_t length, at;                  /* of the sequence; place in it of the camera whose turn it is */
  uint32_t given_up; /* frames, or waits for one, that came to nothing, as the signal was of no use */
  uint32_t waited; /* frame boundaries for its lock */
  uint8_t state[PARAM_CAMERAS_MAX]; /* camera_event_t that was said of it last; CAMERA_FINE at the start */
  uint8_t regular[PARAM_CAMERAS_MAX]; /* frames since the last one that was left out */
  uint8_t rest[PARAM_CAMERAS_MAX];  /* frame boundaries until it gets a turn again */
  struct {
    uint8_t camera, event;
  } events[TURNS_EVENTS];
  uint32_t first_event, event_count;
  uint32_t lost_events; /* that found no room */
} turns_t;

void turns_init(turns_t *turns, uint32_t count);

/** A frame of the present camera was captured, and the lock held all the time: the next camera has its turn. With a
 * single camera that gives frames, it keeps its turn. @return the camera whose turn it is */
uint32_t turns_captured(turns_t *turns);

/** The cameras that have turns from the next change on, 1 to TURNS_SEQUENCE_MAX of them. */
void turns_choose(turns_t *turns, const uint8_t *cameras, uint32_t count);

/** The frame that was captured is of no use, as its fields had a wrong length. The next camera has its turn, and this
 * one another one as usual. @return the camera whose turn it is now */
uint32_t turns_irregular(turns_t *turns);

/** A frame of this camera, which was captured before, is of no use, as a part of it is missing in memory. */
void turns_overflow(turns_t *turns, uint32_t camera);

/** The same, as its last field lacked lines. */
void turns_short(turns_t *turns, uint32_t camera);

/** Something is to be said of the present camera that does not change its state. */
void turns_note(turns_t *turns, camera_event_t event);

/** The frame that was captured is of no use, as the lock was lost. The camera keeps its turn. */
void turns_torn(turns_t *turns);

/** No frame could be captured, as the present camera was not ready. @return the camera whose turn it is now */
uint32_t turns_not_ready(turns_t *turns, const signal_state_t *seen);

/** No frame boundary came for several frames. @return the camera whose turn it is now */
uint32_t turns_no_frames(turns_t *turns, const signal_state_t *seen);

/** The oldest event that was not taken yet. @return 0 if there is none */
int turns_event(turns_t *turns, uint32_t *camera, camera_event_t *event);

const char *camera_event_text(camera_event_t event);

/** Whether a frame of the camera can be captured. */
static inline int signal_ready(const signal_state_t *s) {
  return s->present && s->locked && s->right_standard;
}

#endif
