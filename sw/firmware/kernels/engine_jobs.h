/* Jobs of the remap engine, several of them in its queue, and what is done when one fails. */
#ifndef FOVEA_FIRMWARE_ENGINE_JOBS_H
#define FOVEA_FIRMWARE_ENGINE_JOBS_H

#include "sw/remap/engine_map.h"

/** Takes the engine over; nothing may be under way. @return 0 if the chip's engine is another one */
int engine_jobs_open(void);

/** Puts a job into the queue; sleeps while the queue is full. Behind a failure nothing is submitted any more until
 * engine_jobs_wait(). */
void engine_jobs_add(const remap_engine_job_t *job);

/** Sleeps until all jobs have ended. If one has not ended as it should, or none ends for two seconds, that is a line
 * on the UART, the others are dropped, and the engine is started anew. */
void engine_jobs_wait(void);

/** Whether a job has failed since this was last called: what it should have made is not complete. */
int engine_jobs_failed(void);

#endif
