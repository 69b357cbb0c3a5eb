#include "turns.h"

void turns_init(turns_t *turns, uint32_t count) {
  *turns = (turns_t){.count = count, .length = count};
  for (uint32_t n = 0; n < count; ++n) turns->sequence[n] = (uint8_t)n;
}

static void note(turns_t *t, uint32_t camera, camera_event_t event) {
  if (t->event_count == TURNS_EVENTS) {
    ++t->lost_events;
    return;
  }
  const uint32_t at = (t->first_event + t->event_count++) % TURNS_EVENTS;
  t->events[at].camera = (uint8_t)camera;
  t->events[at].event = (uint8_t)event;
}

void turns_note(turns_t *t, camera_event_t event) { note(t, t->now, event); }

/* Each change of a camera's state is said once. */
static void say_of(turns_t *t, uint32_t camera, camera_event_t event) {
  if (t->state[camera] == event && event != CAMERA_LOST) return;
  t->state[camera] = (uint8_t)event;
  note(t, camera, event);
}

static void say(turns_t *t, camera_event_t event) { say_of(t, t->now, event); }

static void boundary(turns_t *t) {
  for (uint32_t n = 0; n < t->count; ++n)
    if (t->rest[n] != 0) --t->rest[n];
}

/* The next camera that does not rest; if all of them do, the next one. */
static uint32_t next(turns_t *t) {
  t->waited = 0;
  uint32_t at = (t->at + 1u) % t->length;
  for (uint32_t step = 1; step <= t->length; ++step) {
    const uint32_t place = (t->at + step) % t->length;
    if (t->rest[t->sequence[place]] != 0) continue;
    at = place;
    break;
  }
  t->at = at;
  return t->now = t->sequence[at];
}

void turns_choose(turns_t *t, const uint8_t *cameras, uint32_t count) {
  for (uint32_t n = 0; n < count; ++n) {
    t->sequence[n] = cameras[n];
    t->rest[cameras[n]] = 0;
  }
  t->length = count;
  t->at = count - 1u; /* the first one is next */
}

static uint32_t leave(turns_t *t, camera_event_t why) {
  say(t, why);
  t->rest[t->now] = TURNS_REST_FRAMES;
  return next(t);
}

uint32_t turns_captured(turns_t *turns) {
  boundary(turns);
  const uint32_t n = turns->now;
  turns->rest[n] = 0;
  const int left_out = turns->state[n] == CAMERA_IRREGULAR || turns->state[n] == CAMERA_OVERFLOW;
  if (!left_out || ++turns->regular[n] >= TURNS_REGULAR_FRAMES)
    say(turns, CAMERA_FINE);
  return next(turns);
}

uint32_t turns_irregular(turns_t *turns) {
  boundary(turns);
  ++turns->given_up;
  turns->regular[turns->now] = 0;
  say(turns, CAMERA_IRREGULAR);
  return next(turns);
}

void turns_overflow(turns_t *turns, uint32_t camera) {
  turns->regular[camera] = 0;
  say_of(turns, camera, CAMERA_OVERFLOW);
}

void turns_short(turns_t *turns, uint32_t camera) {
  ++turns->given_up;
  turns->regular[camera] = 0;
  say_of(turns, camera, CAMERA_IRREGULAR);
}

void turns_torn(turns_t *turns) {
  boundary(turns);
  ++turns->given_up;
  turns->waited = 0;
  say(turns, CAMERA_LOST);
}

uint32_t turns_not_ready(turns_t *turns, const signal_state_t *seen) {
  boundary(turns);
  ++turns->given_up;
  if (!seen->present) return leave(turns, CAMERA_NO_SIGNAL);
  if (seen->locked && !seen->right_standard) return leave(turns, CAMERA_WRONG_STANDARD);
  if (++turns->waited < TURNS_LOCK_FRAMES) return turns->now;
  return leave(turns, CAMERA_NO_LOCK);
}

uint32_t turns_no_frames(turns_t *turns, const signal_state_t *seen) {
  boundary(turns);
  ++turns->given_up;
  if (!seen->present) return leave(turns, CAMERA_NO_SIGNAL);
  if (seen->locked && !seen->right_standard) return leave(turns, CAMERA_WRONG_STANDARD);
  return leave(turns, CAMERA_NO_FRAMES);
}

int turns_event(turns_t *turns, uint32_t *camera, camera_event_t *event) {
  if (turns->event_count == 0) return 0;
  *camera = turns->events[turns->first_event].camera;
  *event = (camera_event_t)turns->events[turns->first_event].event;
  turns->first_event = (turns->first_event + 1u) % TURNS_EVENTS;
  --turns->event_count;
  return 1;
}

const char *camera_event_text(camera_event_t event) {
  switch (event) {
    case CAMERA_FINE:
      return "frames again";
    case CAMERA_NO_SIGNAL:
      return "no signal";
    case CAMERA_NO_LOCK:
      return "no lock";
    case CAMERA_WRONG_STANDARD:
      return "wrong standard";
    case CAMERA_NO_FRAMES:
      return "no frames";
    case CAMERA_LOST:
      return "lock lost, a frame is left out";
    case CAMERA_OVERFLOW:
      return "overflow, frames are left out";
    case CAMERA_IRREGULAR:
      return "irregular syncs, frames are left out";
    case CAMERA_CLOCK_OFF:
      return "clock more than 200 ppm off";
    case CAMERA_CLOCK_RIGHT:
      return "clock right again";
    case CAMERA_EVENTS:
      break;
  }
  return "unknown";
}
