/* Four cameras in one picture: for each frame that comes, the whole picture is composed anew. */
#include <stddef.h>

#include "../drivers/cp15.h"
#include "../drivers/gpio.h"
#include "../drivers/uart.h"
#include "../drivers/uart_queue.h"
#include "../kernels/engine_jobs.h"
#include "camera_events.h"
#include "composition.h"
#include "overlay.h"
#include "pipeline.h"
#include "pipeline_turns.h"
#include "program.h"
#include "progress.h"
#include "state.h"

static const config_t *config;

void program_print(const config_t *c) {
  uart_puts(", ");
  uart_put_uint(c->cameras);
  uart_puts(" cameras in one picture");
}

/* One for each camera; one that waits, one that is filled, and one for the frame that is judged meanwhile
 * (open_frame.h); and one whose place a newer frame has taken, until it is marked. */
uint32_t program_in_count(const config_t *c) {
  (void)c;
  return IN_COUNT;
}

void program_build(const config_t *used) {
  extern uint8_t __arena_start[], __arena_end[];
  arena_t arena = {(uintptr_t)__arena_start, (uintptr_t)__arena_end};
  config = used;
  composition_build(config, &arena);
}

void program_started(const config_t *c) {
  (void)c;
  uart_queue_start();
}

void program_work(void) {
  camera_events_say();
  progress_without_frames(pipeline_given_up());
  pipeline_mark_free();
}

/* The newest frame is in a buffer that held another one before. */
void program_frame(uint8_t *out, uint32_t sequence) {
  if (!pipeline_whole()) {
    progress_made();
    return;
  }
  const uint8_t *const *sources = pipeline_keep();
  const uint32_t bytes = config->height * config->pitch_bytes;
  for (uint32_t left = config->repeats; left-- != 0; progress_made()) {
    phase_mark(PHASE_REMAP_START, sequence);
    dcache_invalidate_range(sources[pipeline_camera()], bytes);
    const uint32_t before = composition_sum(sources);
    composition_run(sources, out);
    /* Larger frames that the core has read have driven the summed lines out of the cache by now. */
    for (uint32_t n = 0; (bytes < DCACHE_BYTES || composition_by_device()) && n < composition_sources(); ++n)
      if (sources[n] != NULL) dcache_invalidate_range(sources[n], bytes);
    if (composition_sum(sources) != before) ++fw_state.torn;
    overlay_frame(out, sequence);
    dcache_clean_range(out, bytes);
    write_buffer_drain();
    phase_mark(PHASE_REMAP_END, sequence);
    ++fw_state.remapped;
  }
  pipeline_done(!engine_jobs_failed());
}
