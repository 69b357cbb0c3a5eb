/* One view: its look-up table, the method that follows it, and the correction of a frame by it. */
#ifndef FOVEA_FIRMWARE_VIEW_H
#define FOVEA_FIRMWARE_VIEW_H

#include <stdint.h>

#include "../kernels/method.h"
#include "config.h"
#include "sw/lens/lens.h"

struct view {
  remap_table_t table;
  const remap_method_t *method;
};

/* Ticks for which builds of tables were suspended, for frames and for the decoder: no part of the times that are said.
 */
extern volatile uint32_t view_other_ticks;

/** To be called first. `config` is kept. */
void view_configure(const config_t *config);

/** The table of a view without its look-up table. */
remap_table_t view_table(uint32_t *entries, const lens_view_t *view);

/** Fills `entries` by `view`, with a message. Stops the program unless lens_init() accepts `view`.
 * @param marked whether the pins show the build; while one is done in the background they show frames */
void view_build_lut(const lens_view_t *view, uint32_t *entries, int marked);

/** Prepares the remap method of a view whose look-up table is there, with a message. */
void view_prepare_method(struct view *view, arena_t *arena);

/** Corrects one frame. Counts it in `fw_state`, and marks its start and end. */
void view_correct(const struct view *view, const uint8_t *in, uint8_t *out, uint32_t sequence);

#endif
