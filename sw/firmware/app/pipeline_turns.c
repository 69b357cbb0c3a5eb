#include "pipeline_turns.h"

#include "../drivers/cp15.h"
#include "../drivers/display.h"
#include "../drivers/isif.h"
#include "../drivers/timer.h"
#include "../drivers/tvp5146.h"
#include "../drivers/tvp5146_inputs.h"
#include "../drivers/uart.h"
#include "capture_check.h"
#include "fail.h"
#include "pipeline_state.h"
#include "turns.h"
#ifdef CONSOLE
#include "../drivers/multiplexer.h"
#include "view.h"
#endif
#ifdef COMPOSED_VIEW
#include "composition.h"
#endif

/* While no field of a camera begins for so many fields of the display, its signal is of no use. */
#define QUIET_FIELDS 6u

/* The marks of capture_check.h, in memory. The buffer must not be one that the capture fills. */
static void mark_buffer(int32_t n) {
  const config_t *c = pipe.config;
  capture_check_mark(pipeline_buffer(n), c->width * 2u, c->pitch_bytes, c->height);
  dcache_clean_range(pipeline_buffer(n), c->height * c->pitch_bytes);
  write_buffer_drain();
  const uint32_t cpsr = irq_mask();
  pipe.capture.reused &= ~(1u << n);
  irq_restore(cpsr);
}

static signal_state_t look(void) {
  tvp5146_state_t seen = {0};
  if (tvp5146_look(&seen) != I2C_OK) return (signal_state_t){0};
  return (signal_state_t){.present = seen.signal,
                          .locked = seen.locked,
                          .lost = seen.lost,
                          .right_standard = seen.standard == pipe.standard};
}

/* The ISIF counts a frame with its second field. */
void pipeline_turns_field_end(void) {
  if (!pipe.capturing || !isif_second_field()) return;
  if (pipe.complete) capture_frame_useless(&pipe.capture); /* the one before, in the same buffer */
  pipe.complete = 1;
}

/* Field starts at wrong distances, and a clock that is off, while the decoder stays locked. */
static void watch_field(uint32_t now) {
  const watch_event_t seen =
      field_watch_field(&pipe.watch, pipe.turns.now, isif_second_field(), now);
  if (seen == WATCH_SUSPECT_SHORT)
    turns_short(&pipe.turns, pipe.watch.suspect);
  else if (seen != WATCH_NOTHING)
    turns_note(&pipe.turns, seen == WATCH_CLOCK_OFF ? CAMERA_CLOCK_OFF : CAMERA_CLOCK_RIGHT);
}

/* The end of a frame is found by counting lines, so it does not come early if the second field lacked some. What the
 * decoder has counted tells. It is asked as long as the frame's camera is selected, and answers when the next frame is
 * on its way, for which there is no time to lose. Without an answer the frame is taken for whole. A count that is too
 * high is the fault of another camera, which was too early when the input changed from it. */
static void keep_line_count(void) {
  i2c_result_t ignored = tvp5146_keep_line_count();
  (void)ignored;
}

static void judge_frame(void) {
  if (pipe.open.buffer == CAPTURE_NONE) return;
  int32_t more = 0;
  i2c_result_t ignored = tvp5146_line_count(pipe.config->is_625 ? 625u : 525u, &more);
  (void)ignored;
  if (more < 0) {
    turns_short(&pipe.turns, pipe.camera_of[pipe.open.buffer]);
    open_frame_useless(&pipe.open, &pipe.capture);
  } else {
    open_frame_good(&pipe.open, &pipe.capture);
  }
  fw_state.dropped = pipe.capture.dropped;
}

static void select_camera(uint32_t camera) {
#ifdef CONSOLE
  if (pipe.config->multiplexer) {
    multiplexer_select(camera);
    return;
  }
#endif
  /* Without an answer the next look shows no lock. */
  i2c_result_t ignored = tvp5146_select(pipe.config->input[camera]);
  (void)ignored;
}

/* The decoder is asked before the first active line of a frame whether this frame can be captured: a lock
 * to the field syncs is only gained at a field's start. The capture is off meanwhile. */
static void begin_frame(const signal_state_t *seen) {
  if (!signal_ready(seen)) return;
  if (seen->lost && tvp5146_clear_lost() != I2C_OK) return;
  field_watch_frame(&pipe.watch);
  isif_capture();
  if (isif_second_field()) /* the first active line has not come yet */
    pipe.capturing = 1;
  else
    isif_watch();
}

static void fill(int32_t buffer) {
  if (buffer == CAPTURE_NONE) return;
  if (isif_set_address((uint32_t)pipeline_buffer(buffer)) != ISIF_OK) fail("ISIF", "buffer address");
}

/* A frame that is being captured is of no use, whether all of it has come (`pipe.complete`) or a part. What marks its
 * buffer had are gone: capture goes on in another one that has them, if there is one. */
static void leave_frame_out(void) {
  if (pipe.complete)
    capture_frame_useless(&pipe.capture);
  else
    capture_frame_broken(&pipe.capture);
  fw_state.dropped = pipe.capture.dropped;
  if (pipe.config->check_capture) fill(capture_move_on(&pipe.capture));
}

static void captured_frame_done(void) {
  pipe.camera_of[pipe.capture.filling] = (uint8_t)pipe.turns.now;
  ++fw_state.captured;
  const int32_t next = open_frame_begin(&pipe.open, &pipe.capture);
  fw_state.dropped = pipe.capture.dropped;
  fill(next);
}

/* Takes the frame over if the lock has held since its start. */
static void end_frame(const signal_state_t *seen) {
  pipe.capturing = 0;
  const int good = signal_ready(seen) && !seen->lost;
  if (pipe.complete && good && !pipe.watch.irregular) {
    captured_frame_done();
    keep_line_count();
    turns_captured(&pipe.turns);
    return;
  }
  leave_frame_out();
  if (good && pipe.watch.irregular)
    turns_irregular(&pipe.turns);
  else
    turns_torn(&pipe.turns);
}

/* Between two frames the decoder changes to the camera whose turn it is. */
static void field_start(void) {
  watch_field(timer_ticks());
  pipe.quiet_fields = 0;
  if (!isif_second_field()) return;
  isif_watch();
  const uint32_t before = pipe.turns.now;
  signal_state_t seen = look();
  if (pipe.capturing)
    end_frame(&seen);
  else if (!signal_ready(&seen))
    turns_not_ready(&pipe.turns, &seen);
  pipe.complete = 0;
  if (pipe.turns.now != before) {
    /* Without a lock the fields so far were no camera's, or of another standard. */
    if (!signal_ready(&seen)) field_watch_restart(&pipe.watch);
    select_camera(pipe.turns.now);
    /* The lines of a camera with other syncs go on in the midst of a picture: first a frame must begin. */
    if (!pipe.config->genlocked[before] || !pipe.config->genlocked[pipe.turns.now]) {
      field_watch_restart(&pipe.watch);
      judge_frame();
      return;
    }
    seen = look();
  }
  begin_frame(&seen);
  judge_frame();
}

void pipeline_turns_field_start(void) {
#ifdef CONSOLE
  /* A millisecond with the decoder is not the time of a table that is built meanwhile. */
  const uint32_t start = timer_ticks();
  field_start();
  view_other_ticks += timer_ticks() - start;
#else
  field_start();
#endif
}

static void look_for_quiet(void) {
  if (++pipe.quiet_fields < QUIET_FIELDS) return;
  pipe.quiet_fields = 0;
  isif_watch();
  if (pipe.capturing) leave_frame_out();
  pipe.capturing = pipe.complete = 0;
  field_watch_restart(&pipe.watch);
  const signal_state_t seen = look();
  select_camera(turns_no_frames(&pipe.turns, &seen));
}

void pipeline_turns_display_field(void) {
  look_for_quiet();
  display_watch_field(&pipe.display_watch, display_take_late());
}

void pipeline_turns_start(const config_t *config, uint32_t in_count) {
#ifdef COMPOSED_VIEW
  turns_init(&pipe.turns, composition_sources());
  for (uint32_t n = 0; n < CAMERAS_MAX; ++n) pipe.kept[n] = CAPTURE_NONE;
  pipe.replaced = CAPTURE_NONE;
#else
  turns_init(&pipe.turns, config->cameras);
#endif
  field_watch_init(&pipe.watch, config->is_625);
  pipe.open.buffer = CAPTURE_NONE;
  pipe.config = config;
  pipe.standard = config->is_625 ? TVP5146_PAL : TVP5146_NTSC;
  isif_mark_fields(config->is_625);
  if (tvp5146_autoswitch() != I2C_OK) uart_puts("decoder: no answer on I2C, going on\n");
#ifdef CONSOLE
  /* The decoder's input is that of the multiplexer from here on. */
  if (config->multiplexer) {
    multiplexer_start();
    if (tvp5146_select(config->input[0]) != I2C_OK) uart_puts("decoder: no answer on I2C, going on\n");
  }
#endif
  select_camera(0);
  for (uint32_t n = 0; config->check_capture && n < in_count; ++n) mark_buffer((int32_t)n);
}

int pipeline_whole(void) {
  const config_t *c = pipe.config;
  if (!c->check_capture) return 1;
  const int32_t buffer = held_of_age(&pipe.held, 0);
  const uint32_t bit = 1u << buffer;
  int reused = (pipe.capture.reused & bit) != 0; /* what is left of an older frame cannot be told from this one */
  dcache_invalidate_range(pipeline_buffer(buffer), c->height * c->pitch_bytes);
  const uint32_t lost =
      reused ? 0 : capture_check_lost(pipeline_buffer(buffer), c->width * 2u, c->pitch_bytes, c->height);
  if (!reused && lost == 0) return 1;
  mark_buffer(buffer);
  const uint32_t cpsr = irq_mask();
  capture_release(&pipe.capture, held_drop(&pipe.held));
  output_give_back(&pipe.output, pipe.taken_out);
  fw_state.dropped = ++pipe.capture.dropped;
  if (lost != 0) turns_overflow(&pipe.turns, pipe.taken_camera);
  irq_restore(cpsr);
  return 0;
}

void pipeline_turns_release(int32_t buffer) {
  if (pipe.config->check_capture) mark_buffer(buffer);
  const uint32_t cpsr = irq_mask();
  capture_release(&pipe.capture, buffer);
  irq_restore(cpsr);
}

void pipeline_mark_free(void) {
  if (!pipe.config->check_capture) return;
  const uint32_t cpsr = irq_mask();
  const int32_t buffer = capture_take_reused(&pipe.capture);
  irq_restore(cpsr);
  if (buffer != CAPTURE_NONE) pipeline_turns_release(buffer);
}

#ifdef COMPOSED_VIEW
const uint8_t *const *pipeline_keep(void) {
  const uint32_t camera = pipe.taken_camera;
  const int32_t buffer = held_drop(&pipe.held);
  pipe.replaced = pipe.kept[camera];
  pipe.kept[camera] = buffer;
  pipe.kept_frame[camera] = pipeline_buffer(buffer);
  return pipe.kept_frame;
}
#endif

uint32_t pipeline_camera(void) { return pipe.taken_camera; }

display_event_t pipeline_display_event(uint32_t *late_fields) {
  const uint32_t cpsr = irq_mask();
  const display_event_t event = display_watch_take(&pipe.display_watch);
  *late_fields = pipe.display_watch.late_fields;
  irq_restore(cpsr);
  return event;
}

int pipeline_event(uint32_t *camera, const char **what) {
  camera_event_t event;
  const uint32_t cpsr = irq_mask();
  const int is_one = turns_event(&pipe.turns, camera, &event);
  irq_restore(cpsr);
  if (is_one) *what = camera_event_text(event);
  return is_one;
}

uint32_t pipeline_given_up(void) { return pipe.turns.given_up; }

#ifdef CONSOLE
int pipeline_frame_waits(void) { return pipe.capture.ready != CAPTURE_NONE; }

void pipeline_choose(const uint8_t *cameras, uint32_t count) {
  const uint32_t cpsr = irq_mask();
  turns_choose(&pipe.turns, cameras, count);
  irq_restore(cpsr);
}

int32_t pipeline_clock_ppm(uint32_t camera) { return -pipe.watch.camera[camera].ppm; }

const char *pipeline_state(uint32_t camera) {
  return pipe.turns.state[camera] == CAMERA_FINE
             ? "frames"
             : camera_event_text((camera_event_t)pipe.turns.state[camera]);
}
#endif
