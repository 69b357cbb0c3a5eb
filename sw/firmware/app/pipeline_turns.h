/* What the pipeline does in the programs for several cameras alone: turns at the decoder, the watch over the fields,
 * and the check for lost data. For pipeline.c; what the programs call is in pipeline.h. */
#ifndef FOVEA_FIRMWARE_PIPELINE_TURNS_H
#define FOVEA_FIRMWARE_PIPELINE_TURNS_H

#include <stdint.h>

#include "config.h"

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

#endif
