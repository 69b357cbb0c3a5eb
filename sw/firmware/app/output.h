/* Manages the output buffers: which one is displayed, which wait, which are being written. No
 * hardware access, so that it can be tested on the host.
 *
 * The display latches a new address at the start of a field. The window address is changed only
 * during a second field, so that both fields of every displayed frame come from one buffer. */
#ifndef FOVEA_FIRMWARE_OUTPUT_H
#define FOVEA_FIRMWARE_OUTPUT_H

#include <stdint.h>

#define OUTPUT_NONE (-1)
#define OUTPUT_BUFFERS_MAX 8u

typedef struct output {
  uint32_t buffer_count;
  uint32_t writing; /* bit n: buffer n was taken by output_take() */
  int32_t shown;    /* being displayed */
  int32_t pending;  /* address written; displayed from the next first field on */
  uint32_t queued;
  int32_t queue[OUTPUT_BUFFERS_MAX];
  uint32_t queue_sequence[OUTPUT_BUFFERS_MAX];
} output_t;

void output_init(output_t *output, uint32_t buffer_count);

/** A buffer to write to, or OUTPUT_NONE while all are in use. */
int32_t output_take(output_t *output);

/** A buffer of output_take() is not displayed after all. */
void output_give_back(output_t *output, int32_t buffer);

/** A written buffer is complete; it will be displayed after those that were queued before. */
void output_queue(output_t *output, int32_t buffer, uint32_t sequence);

/** During a second field: the buffer to display next, or OUTPUT_NONE if nothing changes. */
int32_t output_next(output_t *output, uint32_t *sequence);

/** At the start of a first field: the pending buffer is now displayed. @return 1 if the displayed
 * buffer has changed; `*released` is then the previous one. */
int output_first_field(output_t *output, int32_t *released);

#endif
