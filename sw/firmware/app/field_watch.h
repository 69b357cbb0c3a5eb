/* Watches the distances between the field starts of a camera: what missing or short lines, damaged timing codes and a
 * clock that is off do to a signal to which the decoder stays locked. No hardware access, so that it can be tested on
 * the host. Times are ticks of 24 MHz, from a counter that wraps. */
#ifndef FOVEA_FIRMWARE_FIELD_WATCH_H
#define FOVEA_FIRMWARE_FIELD_WATCH_H

#include <stdint.h>

#include "model/contract/param_page.h"

/* A field start may be as early or as late as this: 16 us, a quarter of a line. The interrupt's own latency is
 * within 5 us, as nothing masks interrupts for longer except the looks at the decoder, which follow it. */
#define FIELD_TOLERANCE_TICKS 384u
/* A clock that is further off is said to be: more than two sound crystals differ by (a choice). */
#define FIELD_DRIFT_PPM 200
/* It is right again when it is nearer by so much; the measurement is as uncertain as an interrupt's latency in a
 * second. */
#define FIELD_DRIFT_HYSTERESIS_PPM 20
/* Fields for a measurement of the clock: a second of them. */
#define FIELD_DRIFT_FIELDS 50u

typedef enum watch_event {
  WATCH_NOTHING = 0,
  WATCH_CLOCK_OFF,
  WATCH_CLOCK_RIGHT,
  WATCH_SUSPECT_SHORT /* the frame of the camera before, `suspect`, was too short */
} watch_event_t;

typedef struct field_watch {
  uint32_t nominal[2]; /* from a field's start to the next one: the ends of first and second fields */
  uint32_t last;       /* time of the last field start */
  uint32_t unknown;    /* so many of the next distances say nothing */
  uint32_t before;     /* camera of the last field start */
  int suspected;       /* the last distance was too long, to another camera */
  uint32_t suspect;    /* the camera before that one */
  int irregular;       /* a distance was wrong since the last field_watch_frame() */
  struct {
    int32_t ticks; /* sum of what regular distances were too long by */
    uint32_t fields;
    int32_t ppm;   /* of the last whole measurement: how much too slow its clock is */
    int off;       /* as was said last */
  } camera[PARAM_CAMERAS_MAX];
} field_watch_t;

void field_watch_init(field_watch_t *watch, int is_625);

/** The decoder goes on with another raster. The distance to its first field start says nothing, nor does the next one:
 * where lines of two rasters meet, a field start may be seen that is none. */
void field_watch_restart(field_watch_t *watch);

/** A frame begins: whether it is regular is counted from here. */
void field_watch_frame(field_watch_t *watch);

/** A field of a camera has ended, and the next one begins. Between two cameras a distance that is too long is the fault
 * of either: the frame of the one before lacked lines, so that its end came early, or the first field of the other one
 * began late. The next distance tells. One that is too short is the fault of the other camera.
 * @param second the field that has ended is the second one of its frame
 * @param now ticks
 * @return whether its clock is found to be off now, or to be right again, or the suspected camera to be guilty */
watch_event_t field_watch_field(field_watch_t *watch, uint32_t camera, int second, uint32_t now);

#endif
