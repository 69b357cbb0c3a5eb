#include "display_watch.h"

/* Changes alternate, so their number and the last one say all of them. */
static void change(display_watch_t *w, int is_late) {
  w->is_late = is_late;
  if (++w->unsaid > DISPLAY_UNSAID_MAX) w->unsaid -= 2u;
}

void display_watch_field(display_watch_t *w, int late) {
  if (late) {
    ++w->late_fields;
    w->fine = 0;
    if (!w->is_late) change(w, 1);
    return;
  }
  if (w->is_late && ++w->fine >= DISPLAY_FINE_FIELDS) change(w, 0);
}

display_event_t display_watch_take(display_watch_t *w) {
  if (w->unsaid == 0) return DISPLAY_NOTHING;
  const int last = --w->unsaid % 2u == 0; /* the same as the last one */
  return (w->is_late != 0) == last ? DISPLAY_LATE : DISPLAY_FINE;
}

const char *display_event_text(display_event_t event) {
  return event == DISPLAY_LATE ? "data come too late, parts of lines are black" : "data in time again";
}
