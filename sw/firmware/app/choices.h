/* What a person chooses on the console: which cameras have turns, and the view of each. */
#ifndef FOVEA_FIRMWARE_CHOICES_H
#define FOVEA_FIRMWARE_CHOICES_H

#include "config.h"
#include "view.h"

/** Starts the console, with a line that says how to get help. */
void choices_start(const config_t *config, struct view *views);

/** Carries out what was typed since the last call. A new table takes its time; frames are corrected meanwhile. */
void choices_work(void);

#endif
