/* The tables of the views, and building a new one while frames are corrected. Where a table is built nothing in use is
 * touched: there is memory for one table more than there are views. */
#ifndef FOVEA_FIRMWARE_VIEW_TABLES_H
#define FOVEA_FIRMWARE_VIEW_TABLES_H

#include <stdint.h>

#include "view.h"

/** Builds the tables of the views at the start, one after the other, with messages. Stops the program if the memory
 * does not suffice. After view_configure(). */
void view_tables_build(struct view *views, const config_t *config);

/** Builds the table of view `k` anew. Meanwhile frames are corrected by the interrupt handler's tail (boot/start.S):
 * the build is suspended for as long. From one frame to the next the new table takes the place of the old one.
 * @return 0 if there is no memory for a further table: nothing has changed then */
int view_tables_rebuild(struct view *views, uint32_t k, const lens_view_t *view);

/** For the tail of the interrupt handler, with interrupts masked: is a build suspended for which a frame waits? */
int background_frame_due(void);

#endif
