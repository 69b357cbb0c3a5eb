/* When to say that the display lacked data. No hardware access, so that it can be tested on the host. */
#ifndef FOVEA_FIRMWARE_DISPLAY_WATCH_H
#define FOVEA_FIRMWARE_DISPLAY_WATCH_H

#include <stdint.h>

/* After so many fields without late data, a second of them, the display is said to be fine again. */
#define DISPLAY_FINE_FIELDS 50u

/* As many changes may wait until the main loop says them. */
#define DISPLAY_UNSAID_MAX 3u

typedef enum display_event { DISPLAY_NOTHING = 0, DISPLAY_LATE, DISPLAY_FINE } display_event_t;

typedef struct display_watch {
  uint32_t late_fields; /* since the start */
  uint32_t fine;        /* fields since the last late one */
  int is_late;          /* after the last change */
  uint32_t unsaid;      /* changes that display_watch_take() has not given yet */
} display_watch_t;

/** A field has been displayed. @param late some of its data came too late, and were black */
void display_watch_field(display_watch_t *watch, int late);

/** What is to be said, oldest first: each change once, of more than three untold ones the last two or three. */
display_event_t display_watch_take(display_watch_t *watch);

const char *display_event_text(display_event_t event);

#endif
