/* What the pipeline does in the programs for several cameras alone: turns at the decoder, the watch over the fields,
 * and the check for lost data. First what pipeline.c calls, then what the programs do. */
#ifndef FOVEA_FIRMWARE_PIPELINE_TURNS_H
#define FOVEA_FIRMWARE_PIPELINE_TURNS_H

#include <stdint.h>

#include "config.h"
#include "display_watch.h"

/** Gives camera 0 its turn. Part of pipeline_start(), before the capture. */
void pipeline_turns_start(const config_t *config, uint32_t in_count);

/** VDINT0: the captured lines of a field are complete. */
void pipeline_turns_field_end(void);

/** VDINT1, at the start of a field. */
void pipeline_turns_field_start(void);

/** A field of the display begins. */
void pipeline_turns_display_field(void);

/** A source was corrected: its buffer is marked, if the page asks for that, and given back to the camera. Called with
 * interrupts open, or with none enabled that use the buffers. */
void pipeline_turns_release(int32_t buffer);

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

#endif
