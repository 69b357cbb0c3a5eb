/* The path of frames from camera to display: interrupt handler, and exchange of buffers. */
#ifndef FOVEA_FIRMWARE_PIPELINE_H
#define FOVEA_FIRMWARE_PIPELINE_H

#include <stdint.h>

#include "config.h"
#include "display_watch.h"

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

#ifdef TIME_DIVISION
/** The camera of the frame of the last pipeline_take(). */
uint32_t pipeline_camera(void);

#ifdef COMPOSED_VIEW
/** The frame of the last pipeline_take() takes the place of its camera's last one.
 * @return the newest frame of each camera, that one included; a null pointer if there was none yet. They stay until the
 * camera's next frame is kept. */
const uint8_t *const *pipeline_keep(void);
#endif

/** What is to be said of the display, oldest first; DISPLAY_NOTHING if there is nothing.
 * @param late_fields receives how many fields lacked data since the start */
display_event_t pipeline_display_event(uint32_t *late_fields);

/** What is to be said of a camera, oldest first. @return 0 if there is nothing more */
int pipeline_event(uint32_t *camera, const char **what);

/** Counts the frames, and the waits for one, that came to nothing, as a camera's signal was of no use. */
uint32_t pipeline_given_up(void);

/** Checks the frame of the last pipeline_take(), if the page asks for that (PARAM_CHECK_CAPTURE). If a part of it was
 * not captured, the frame is left out, and said; the output buffer stays free.
 * @return 1 if the frame is to be corrected; 0 if pipeline_done() must not be called for it */
int pipeline_whole(void);

/** Marks a buffer that the camera may get next and whose marks are gone, if the page asks for marks. */
void pipeline_mark_free(void);
#endif

#ifdef CONSOLE
/** Whether a captured frame waits for pipeline_take(). With interrupts masked. */
int pipeline_frame_waits(void);

/** The cameras that have turns from the next frame boundary on. */
void pipeline_choose(const uint8_t *cameras, uint32_t count);

/** How much too fast the camera's clock was in the last measurement; 0 before the first one. */
int32_t pipeline_clock_ppm(uint32_t camera);

/** What was last said of a camera. */
const char *pipeline_state(uint32_t camera);
#endif

/** Prints the reason of a failure, marks the phase and stops. */
void fail(const char *what, const char *why) __attribute__((noreturn));

#endif
