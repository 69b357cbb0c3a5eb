/* The path of frames from camera to display: interrupt handler, and exchange of buffers. */
#ifndef FOVEA_FIRMWARE_PIPELINE_H
#define FOVEA_FIRMWARE_PIPELINE_H

#include <stdint.h>

#include "config.h"

/** Starts video clocks and decoder, with messages on the UART. A decoder that does not answer is
 * reported and otherwise ignored. To be called early, since the decoder needs time to lock. */
void pipeline_prepare(const config_t *config);

/** Waits for the decoder's lock, so that its black frames are not captured (at most a second; a
 * failure is reported and otherwise ignored). Then starts the display in step with the camera,
 * capture and interrupts. If `out_count` is 0, captured frames are displayed unchanged from
 * `in_count` (at least 5) buffers. Stops the program if a driver reports an error. */
void pipeline_start(const config_t *config, uint32_t in_count, uint32_t out_count);

/** Takes the next frame as the newest source and provides a buffer for its result. The first frames
 * are only kept, until there are as many sources as the configuration says. @return 0 if there is
 * no frame to correct. Call with interrupts masked. */
int pipeline_take(uint8_t **out, uint32_t *sequence);

/** The source that was taken `age` frames before the one of the last pipeline_take(); `age` is less
 * than the number of sources. Valid until pipeline_done(). */
const uint8_t *pipeline_source(uint32_t age);

/** Ends the remap of the frame of the last pipeline_take(). If it is good it is displayed from the next possible
 * field on; otherwise what is displayed stays. The oldest source is given back to the camera. */
void pipeline_done(int good);

uint32_t pipeline_last_sequence(void);

#endif
