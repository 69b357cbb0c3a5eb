#include "open_frame.h"

int32_t open_frame_begin(open_frame_t *o, capture_t *c) {
  /* capture_frame_done() drops the frame that waits: it is out of its reach meanwhile. */
  uint32_t sequence = 0;
  const int32_t waiting = capture_take(c, &sequence);
  const int32_t next = capture_frame_done(c);
  if (next != CAPTURE_NONE) o->buffer = capture_take(c, &o->sequence);
  if (waiting != CAPTURE_NONE) {
    capture_release(c, waiting);
    c->ready = waiting;
    c->ready_sequence = sequence;
  }
  return next;
}

static void drop(capture_t *c, int32_t buffer) {
  ++c->dropped;
  c->reused |= 1u << buffer;
}

void open_frame_good(open_frame_t *o, capture_t *c) {
  if (c->ready != CAPTURE_NONE) drop(c, c->ready);
  capture_release(c, o->buffer);
  c->ready = o->buffer;
  c->ready_sequence = o->sequence;
  o->buffer = CAPTURE_NONE;
}

void open_frame_useless(open_frame_t *o, capture_t *c) {
  drop(c, o->buffer);
  capture_release(c, o->buffer);
  o->buffer = CAPTURE_NONE;
}
