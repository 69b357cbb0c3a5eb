/* Which output buffer is shown, waits or is written. No hardware access: tested on the host.
 *
 * The display takes a new address at a field's start. The window is pointed at a new frame only
 * during a second field, so that both fields of every displayed frame come from one buffer. */
#ifndef FOVEA_FIRMWARE_OUTPUT_H
#define FOVEA_FIRMWARE_OUTPUT_H

#include <stdint.h>

#define OUTPUT_NONE (-1)
#define OUTPUT_BUFFERS_MAX 8u

typedef struct output {
  uint32_t buffer_count;
  uint32_t writing; /* bit n: taken by output_take() */
  int32_t shown;    /* being sent */
  int32_t pending;  /* address written, taken by the display at the next first field */
  uint32_t queued;
  int32_t queue[OUTPUT_BUFFERS_MAX];
  uint32_t queue_sequence[OUTPUT_BUFFERS_MAX];
} output_t;

void output_init(output_t *output, uint32_t buffer_count);

/** A buffer to write into, OUTPUT_NONE while all are in use. */
int32_t output_take(output_t *output);

/** A written buffer is complete: it will be shown after those queued before it. */
void output_queue(output_t *output, int32_t buffer, uint32_t sequence);

/** In a second field: the buffer to point the display at, OUTPUT_NONE if nothing is to change. */
int32_t output_next(output_t *output, uint32_t *sequence);

/** At the start of a first field: the pending buffer is now shown.
 * @return 1 if that changed what is shown; `*released` is then the buffer shown before. */
int output_first_field(output_t *output, int32_t *released);

#endif
