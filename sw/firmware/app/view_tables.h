/* The tables of the views, and building a new one while frames are corrected. Where a table is built nothing in use is
 * touched: there is memory for one table more than there are views. */
#ifndef FOVEA_FIRMWARE_VIEW_TABLES_H
#define FOVEA_FIRMWARE_VIEW_TABLES_H

#include <stdint.h>

#include "../kernels/method.h"
#include "config.h"
#include "sw/lens/lens.h"

struct view { /* what the remaps use in turn */
  remap_table_t table;
  const remap_method_t *method;
};

/** Builds the tables of the views at the start, one after the other, with messages. Stops the program if the memory
 * does not suffice. */
void view_tables_build(struct view *views, const config_t *config);

/** Builds the table of view `k` anew. Meanwhile frames are corrected by the interrupt handler's tail (boot/start.S):
 * the build is suspended for as long. From one frame to the next the new table takes the place of the old one.
 * @return 0 if there is no memory for a further table: nothing has changed then */
int view_tables_rebuild(struct view *views, uint32_t k, const lens_view_t *view);

/** Whether a table is being built in the background. */
int view_tables_busy(void);

/** For the tail of the interrupt handler, with interrupts masked: is a build suspended for which a frame waits? */
int background_frame_due(void);

/* What the program provides. */

/** Fills `entries` by `view`, which lens_init() accepts. */
void build_lut(const lens_view_t *view, uint32_t *entries);
/** Corrects the frame that waits, if there is one, and has what it needs. To be called with interrupts masked, and returns
 * with them masked; they are open meanwhile. @return 0 if there was nothing to do */
int correct_next_frame(void);
/** Prepares the remap method of a view whose look-up table is there. */
void prepare_method(struct view *view, arena_t *arena);

#endif
