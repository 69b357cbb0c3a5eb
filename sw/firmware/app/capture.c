#include "capture.h"

void capture_init(capture_t *capture, uint32_t buffer_count) {
  *capture = (capture_t){.buffer_count = buffer_count, .filling = 0, .ready = CAPTURE_NONE};
}

/* A buffer that is not in use, nor waits; of several, one that was not filled anew. */
static int32_t find_free(const capture_t *c) {
  int32_t found = CAPTURE_NONE;
  for (uint32_t n = 0; n < c->buffer_count; ++n) {
    if ((int32_t)n == c->filling || (int32_t)n == c->ready || (c->busy >> n & 1u) != 0) continue;
    if ((c->reused >> n & 1u) == 0) return (int32_t)n;
    if (found == CAPTURE_NONE) found = (int32_t)n;
  }
  return found;
}

int32_t capture_move_on(capture_t *c) {
  const int32_t next = find_free(c);
  if (next == CAPTURE_NONE || (c->reused >> next & 1u) != 0) return CAPTURE_NONE;
  return c->filling = next;
}

int32_t capture_take_reused(capture_t *c) {
  for (uint32_t n = 0; n < c->buffer_count; ++n)
    if ((int32_t)n != c->filling && (int32_t)n != c->ready && (c->busy >> n & 1u) == 0 &&
        (c->reused >> n & 1u) != 0) {
      c->busy |= 1u << n;
      return (int32_t)n;
    }
  return CAPTURE_NONE;
}

int32_t capture_frame_done(capture_t *c) {
  const uint32_t sequence = c->next_sequence++;
  if (c->ready != CAPTURE_NONE) {
    ++c->dropped;
    c->reused |= 1u << c->ready;
    c->ready = CAPTURE_NONE;
  }
  const int32_t next = find_free(c);
  if (next == CAPTURE_NONE) {
    ++c->dropped;
    c->reused |= 1u << c->filling;
    return CAPTURE_NONE;
  }
  c->ready = c->filling;
  c->ready_sequence = sequence;
  c->filling = next;
  return next;
}

void capture_single_done(capture_t *c) {
  c->ready = c->filling;
  c->ready_sequence = c->next_sequence++;
}

int32_t capture_take(capture_t *c, uint32_t *sequence) {
  const int32_t buffer = c->ready;
  if (buffer == CAPTURE_NONE) return CAPTURE_NONE;
  *sequence = c->ready_sequence;
  c->ready = CAPTURE_NONE;
  c->busy |= 1u << buffer;
  return buffer;
}

void capture_release(capture_t *c, int32_t buffer) { c->busy &= ~(1u << buffer); }

void held_add(held_t *h, int32_t buffer) { h->buffer[h->count++] = buffer; }

int32_t held_drop(held_t *h) {
  const int32_t oldest = h->buffer[0];
  --h->count;
  for (uint32_t i = 0; i < h->count; ++i) h->buffer[i] = h->buffer[i + 1];
  return oldest;
}

int32_t held_of_age(const held_t *h, uint32_t age) { return h->buffer[h->count - 1u - age]; }
