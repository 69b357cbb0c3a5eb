/* The remap engine: a hypothetical block (rtl/README.md) that corrects a frame by itself. Only on a chip
 * that has it: elsewhere each access is a bus error, so nothing is called unless the parameter page says
 * PARAM_ENGINE. */
#ifndef FOVEA_FIRMWARE_ENGINE_H
#define FOVEA_FIRMWARE_ENGINE_H

#include <stdint.h>

#include "sw/remap/engine_map.h"

/** Takes the engine over: nothing under way, no events, all events interrupt, jobs are taken.
 * @return 0 if what is there is no such engine */
int engine_init(void);

#define ENGINE_QUEUE 4u /* jobs that can wait, besides the one under way (QueueDepth in rtl/README.md) */

/** Hands a job over; the interrupt comes at its end. */
void engine_submit(const remap_engine_job_t *job, uint32_t tag);

/** Events (fields of ENGINE_EVENTS) that have come; they are cleared. None is set when this returns, so that the next
 * one is a new edge of the interrupt. */
uint32_t engine_take_events(void);

/** Number of jobs that have ended, modulo 65536. */
uint32_t engine_ended(void);

#endif
