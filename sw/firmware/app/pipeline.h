/* Frames from the camera to the display: interrupt handler and buffer hand-over. */
#ifndef FOVEA_FIRMWARE_PIPELINE_H
#define FOVEA_FIRMWARE_PIPELINE_H

#include <stdint.h>

#include "config.h"

/** Brings video clocks and the decoder up; what it says goes to the UART. A decoder that does not
 * answer is reported and otherwise ignored. Early, since the decoder needs time to lock. */
void pipeline_prepare(const config_t *config);

/** Waits for the decoder's lock (at most a second; a failure is reported and otherwise ignored), so
 * that black frames before it are not captured. Then starts the display in step with the camera,
 * capture and interrupts. `out_count` 0: captured frames are shown as they are, from `in_count` (at
 * least 5) buffers. Stops the program if a driver refuses. */
void pipeline_start(const config_t *config, uint32_t in_count, uint32_t out_count);

/** Next frame and a buffer for its result, or 0. Call with interrupts masked. */
int pipeline_take(const uint8_t **in, uint8_t **out, uint32_t *sequence);

/** The frame of the last pipeline_take() is done: shown as soon as the display's fields allow. */
void pipeline_done(void);

uint32_t pipeline_last_sequence(void);

/** Prints a reason, marks the failure and stops. */
void fail(const char *what, const char *why) __attribute__((noreturn));

#endif
