/* Cameras in turn, each with a table of its own, and a console (choices.h). */

#include "../drivers/cp15.h"
#include "../drivers/uart.h"
#include "../kernels/engine_jobs.h"
#include "camera_events.h"
#include "choices.h"
#include "pipeline.h"
#include "pipeline_turns.h"
#include "program.h"
#include "progress.h"
#include "say.h"
#include "state.h"
#include "view_tables.h"

static uint32_t repeats;
static struct view views[TABLES_MAX];

void program_print(const config_t *config) {
  uart_puts(", ");
  uart_put_uint(config->cameras);
  uart_puts(" cameras in turn");
}

/* One that waits, one that is filled, and one for the frame that is judged meanwhile (open_frame.h). The last one is
 * also what the next frame is filled into after a frame of no use, if frames are checked. */
uint32_t program_in_count(const config_t *config) { return config->sources + 3u; }

void program_build(const config_t *config) {
  repeats = config->repeats;
  view_configure(config);
  view_tables_build(views, config);
}

void program_started(const config_t *config) { choices_start(config, views); }

void program_work(void) {
  camera_events_say();
  progress_without_frames(pipeline_given_up());
  pipeline_mark_free();
  choices_work();
}

void program_frame(uint8_t *out, uint32_t sequence) {
  if (!pipeline_whole()) {
    progress_made();
    return;
  }
  for (uint32_t left = repeats; left-- != 0; progress_made())
    view_correct(&views[pipeline_camera()], pipeline_source(0), out, sequence);
  pipeline_done(!engine_jobs_failed());
}

int correct_next_frame(void) {
  uint8_t *out;
  uint32_t sequence;
  if (!pipeline_take(&out, &sequence)) return 0;
  const uint32_t cpsr = irq_mask();
  irq_unmask();
  program_frame(out, sequence);
  irq_restore(cpsr);
  return 1;
}
