/* What the correcting programs do in their own way; main.c is the same for all of them. Each one links one
 * of program_single.c, program_turns.c and program_composed.c. */
#ifndef FOVEA_FIRMWARE_PROGRAM_H
#define FOVEA_FIRMWARE_PROGRAM_H

#include "config.h"

/** Prints what the line with the settings says of this program alone; begins with ", " unless it is empty. */
void program_print(const config_t *config);

/** Number of input buffers, at most IN_COUNT. */
uint32_t program_in_count(const config_t *config);

/** Builds the look-up tables, with messages. Stops the program if that cannot be. `config` is kept. */
void program_build(const config_t *config);

/** Called once, when capture and display run. */
void program_started(const config_t *config);

/** What the main loop does besides frames. Called with interrupts open, before it looks for a frame. */
void program_work(void);

/** Corrects the frame of the last pipeline_take() into `out`, as often as the page says, and ends with
 * pipeline_done(). */
void program_frame(uint8_t *out, uint32_t sequence);

#ifdef CONSOLE
/** For view_tables.c, while a table is built: corrects the frame that waits, if there is one, and has what it needs. To
 * be called with interrupts masked, and returns with them masked; they are open meanwhile.
 * @return 0 if there was nothing to do */
int correct_next_frame(void);
#endif

#endif
