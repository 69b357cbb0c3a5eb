#include "output.h"

void output_init(output_t *output, uint32_t buffer_count) {
  *output = (output_t){.buffer_count = buffer_count, .shown = OUTPUT_NONE, .pending = OUTPUT_NONE};
}

static int is_queued(const output_t *o, int32_t buffer) {
  for (uint32_t i = 0; i < o->queued; ++i)
    if (o->queue[i] == buffer) return 1;
  return 0;
}

int32_t output_take(output_t *o) {
  for (uint32_t n = 0; n < o->buffer_count; ++n) {
    const int32_t buffer = (int32_t)n;
    if (buffer == o->shown || buffer == o->pending || (o->writing >> n & 1u) != 0 ||
        is_queued(o, buffer))
      continue;
    o->writing |= 1u << n;
    return buffer;
  }
  return OUTPUT_NONE;
}

void output_give_back(output_t *o, int32_t buffer) { o->writing &= ~(1u << buffer); }

void output_queue(output_t *o, int32_t buffer, uint32_t sequence) {
  output_give_back(o, buffer);
  o->queue[o->queued] = buffer;
  o->queue_sequence[o->queued] = sequence;
  ++o->queued;
}

int32_t output_next(output_t *o, uint32_t *sequence) {
  if (o->pending != OUTPUT_NONE || o->queued == 0) return OUTPUT_NONE;
  o->pending = o->queue[0];
  *sequence = o->queue_sequence[0];
  --o->queued;
  for (uint32_t i = 0; i < o->queued; ++i) {
    o->queue[i] = o->queue[i + 1];
    o->queue_sequence[i] = o->queue_sequence[i + 1];
  }
  return o->pending;
}

int output_first_field(output_t *o, int32_t *released) {
  if (o->pending == OUTPUT_NONE) return 0;
  *released = o->shown;
  o->shown = o->pending;
  o->pending = OUTPUT_NONE;
  return 1;
}
