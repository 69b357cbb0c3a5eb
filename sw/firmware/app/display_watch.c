#include "display_watch.h"

display_event_t display_watch_field(display_watch_t *w, int late) {
  if (late) {
    ++w->late_fields;
    w->fine = 0;
    if (w->is_late) return DISPLAY_NOTHING;
    w->is_late = 1;
    return DISPLAY_LATE;
  }
  if (!w->is_late || ++w->fine < DISPLAY_FINE_FIELDS) return DISPLAY_NOTHING;
  w->is_late = 0;
  return DISPLAY_FINE;
}

const char *display_event_text(display_event_t event) {
  return event == DISPLAY_LATE ? "data come too late, parts of lines are black" : "data in time again";
}
