#include "loop_watch.h"

void loop_watch_init(loop_watch_t *w, uint32_t patience, uint32_t now) {
  *w = (loop_watch_t){.patience = patience, .last = now};
}

uint32_t loop_watch_progress(loop_watch_t *w, uint32_t now) {
  const uint32_t passed = now - w->last;
  const int was_stalled = w->stalled;
  w->last = now;
  w->stalled = 0;
  return was_stalled ? passed : 0;
}

int loop_watch_look(loop_watch_t *w, uint32_t now) {
  if (w->stalled || now - w->last <= w->patience) return 0;
  w->stalled = 1;
  return 1;
}
