#include "pipeline.h"

#include <stddef.h>

#include "../boot/boot.h"
#include "../drivers/cp15.h"
#include "../drivers/display.h"
#include "../drivers/gpio.h"
#include "../drivers/intc.h"
#include "../drivers/isif.h"
#include "../drivers/priority.h"
#include "../drivers/timer.h"
#include "../drivers/tvp5146.h"
#include "../drivers/uart.h"
#include "../drivers/vpss.h"
#include "capture.h"
#include "output.h"
#include "state.h"
#ifdef TIME_DIVISION
#include "../drivers/tvp5146_inputs.h"
#include "turns.h"
#endif
#ifdef CONSOLE
#include "../drivers/multiplexer.h"
#include "../drivers/uart_queue.h"
#include "capture_check.h"
#include "field_watch.h"
#include "open_frame.h"
#include "view.h"
#endif
#ifdef COMPOSED_VIEW
#include "composition.h"
#endif

/* Minimum time before a field's start for a change of the displayed buffer by the main loop. */
#define FLIP_MARGIN_TICKS TIMER_TICKS_PER_MS

/* Public drivers wait up to five times 200 ms for the decoder's lock. */
#define LOCK_TIMEOUT_TICKS (1000u * TIMER_TICKS_PER_MS)
#define LOCK_POLL_TICKS (10u * TIMER_TICKS_PER_MS)

/* The display's frames begin this long before the end of a camera frame. In the serial flow, the
 * result of one frame is then already displayed when the capture of the next one may start. */
#define DISPLAY_LEAD_TICKS TIMER_TICKS_PER_MS

/* All of this is used by the interrupt handler; the main loop accesses it with IRQ masked. */
static struct {
  capture_t capture;
  output_t output;
  uint32_t pitch_bytes;
  uint32_t field_ticks;
  int serial;
  int progressive; /* the camera: each of its fields is a frame */
  int passthrough;
  int capturing;       /* the current frame is written to memory */
  int capture_wanted;  /* capture starts with the next frame */
  int in_second_field; /* of the display, since second_field_start */
  uint32_t second_field_start;
  int window_on;
  uint32_t sources; /* number of frames that a remap may read */
  held_t held;      /* those frames; only the main loop uses this and what follows */
  int32_t taken_out;
  uint32_t taken_sequence;
#ifdef TIME_DIVISION
  turns_t turns;
  const config_t *config;
  uint32_t standard;     /* that a camera must send, as the decoder tells it */
  int complete;          /* the second field of the frame that is captured has ended */
  uint32_t quiet_fields; /* of the display, since the last field of a camera */
  uint8_t camera_of[CAPTURE_BUFFERS_MAX]; /* whose frame is in each buffer */
  uint32_t taken_camera;
#endif
#ifdef CONSOLE
  field_watch_t watch;
  open_frame_t open;  /* only within the handler */
#endif
#ifdef TIME_DIVISION
  display_watch_t display_watch;
#endif
#ifdef COMPOSED_VIEW
  int32_t kept[CAMERAS_MAX]; /* buffers of the newest frames; CAPTURE_NONE before the first one */
  const uint8_t *kept_frame[CAMERAS_MAX];
#endif
} pipe;

void fail(const char *what, const char *why) {
  phase_mark(PHASE_FAILED, 0);
#ifdef CONSOLE
  uart_queue_stop();
#endif
  uart_puts("failed: ");
  uart_puts(what);
  uart_puts(": ");
  uart_puts(why);
  uart_puts("\n");
  uart_drain();
  stop();
}

static uint8_t *in_buffer(int32_t n) { return frame_in + (uint32_t)n * frame_stride; }

#ifdef CONSOLE
/* The marks of capture_check.h, in memory. The buffer must not be one that the capture fills. */
static void mark_buffer(int32_t n) {
  const config_t *c = pipe.config;
  capture_check_mark(in_buffer(n), c->width * 2u, c->pitch_bytes, c->height);
  dcache_clean_range(in_buffer(n), c->height * c->pitch_bytes);
  write_buffer_drain();
  const uint32_t cpsr = irq_mask();
  pipe.capture.reused &= ~(1u << n);
  irq_restore(cpsr);
}
#endif

static uint8_t *shown_buffer(int32_t n) {
  return pipe.passthrough ? in_buffer(n) : frame_out + (uint32_t)n * frame_stride;
}

/* Displays the next finished frame. Only during a second field. */
static void flip(void) {
  uint32_t sequence;
  const int32_t buffer = output_next(&pipe.output, &sequence);
  if (buffer == OUTPUT_NONE) return;
  phase_mark(PHASE_FLIP, sequence);
  if (display_set_address((uint32_t)shown_buffer(buffer), pipe.pitch_bytes) != DISPLAY_OK)
    fail("display", "buffer address");
  if (!pipe.window_on) {
    display_enable_window();
    pipe.window_on = 1;
  }
  ++fw_state.flipped;
}

static void captured_frame_done(void) {
  ++fw_state.captured;
  if (pipe.serial) {
    capture_single_done(&pipe.capture);
    isif_watch();
    pipe.capturing = 0;
    return;
  }
#ifdef CONSOLE
  const int32_t next = open_frame_begin(&pipe.open, &pipe.capture);
#else
  const int32_t next = capture_frame_done(&pipe.capture);
#endif
  fw_state.dropped = pipe.capture.dropped;
  if (next == CAPTURE_NONE) return;
  if (isif_set_address((uint32_t)in_buffer(next)) != ISIF_OK) fail("ISIF", "buffer address");
  if (pipe.passthrough) {
    uint32_t sequence;
    const int32_t buffer = capture_take(&pipe.capture, &sequence);
    output_queue(&pipe.output, buffer, sequence);
  }
}

#ifdef TIME_DIVISION

/* While no field of a camera begins for so many fields of the display, its signal is of no use. */
#define QUIET_FIELDS 6u

static signal_state_t look(void) {
  tvp5146_state_t seen = {0};
  if (tvp5146_look(&seen) != I2C_OK) return (signal_state_t){0};
  return (signal_state_t){.present = seen.signal,
                          .locked = seen.locked,
                          .lost = seen.lost,
                          .right_standard = seen.standard == pipe.standard};
}

/* VDINT0: the captured lines of a field are complete. The ISIF counts a frame with its second one. */
static void capture_field_end(void) {
  if (!pipe.capturing || !isif_second_field()) return;
  if (pipe.complete) capture_frame_useless(&pipe.capture); /* the one before, in the same buffer */
  pipe.complete = 1;
}

/* Field starts at wrong distances, and a clock that is off, while the decoder stays locked. */
#ifdef CONSOLE
static void watch_field(uint32_t now) {
  const watch_event_t seen =
      field_watch_field(&pipe.watch, pipe.turns.now, isif_second_field(), now);
  if (seen == WATCH_SUSPECT_SHORT)
    turns_short(&pipe.turns, pipe.watch.suspect);
  else if (seen != WATCH_NOTHING)
    turns_note(&pipe.turns, seen == WATCH_CLOCK_OFF ? CAMERA_CLOCK_OFF : CAMERA_CLOCK_RIGHT);
}
static int irregular(void) { return pipe.watch.irregular; }
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
static void watch_frame(void) { field_watch_frame(&pipe.watch); }
static void watch_another(void) { field_watch_restart(&pipe.watch); }
#else
static void watch_field(uint32_t now) { (void)now; }
static int irregular(void) { return 0; }
static void keep_line_count(void) {}
static void judge_frame(void) {}
static void watch_frame(void) {}
static void watch_another(void) {}
#endif

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
  watch_frame();
  isif_capture();
  if (isif_second_field()) /* the first active line has not come yet */
    pipe.capturing = 1;
  else
    isif_watch();
}

/* A frame that is being captured is of no use, whether all of it has come (`pipe.complete`) or a part. What marks its
 * buffer had are gone: capture goes on in another one that has them, if there is one. */
static void leave_frame_out(void) {
  if (pipe.complete)
    capture_frame_useless(&pipe.capture);
  else
    capture_frame_broken(&pipe.capture);
  fw_state.dropped = pipe.capture.dropped;
#ifdef CONSOLE
  if (!pipe.config->check_capture) return;
  const int32_t next = capture_move_on(&pipe.capture);
  if (next != CAPTURE_NONE && isif_set_address((uint32_t)in_buffer(next)) != ISIF_OK) fail("ISIF", "buffer address");
#endif
}

/* Takes the frame over if the lock has held since its start. */
static void end_frame(const signal_state_t *seen) {
  pipe.capturing = 0;
  const int good = signal_ready(seen) && !seen->lost;
  if (pipe.complete && good && !irregular()) {
    pipe.camera_of[pipe.capture.filling] = (uint8_t)pipe.turns.now;
    captured_frame_done();
    keep_line_count();
    turns_captured(&pipe.turns);
    return;
  }
  leave_frame_out();
  if (good && irregular())
    turns_irregular(&pipe.turns);
  else
    turns_torn(&pipe.turns);
}

/* VDINT1, at the start of a field. Between two frames the decoder changes to the camera whose turn it is. */
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
    if (!signal_ready(&seen)) watch_another(); /* the fields so far were no camera's, or of another standard */
    select_camera(pipe.turns.now);
    /* The lines of a camera with other syncs go on in the midst of a picture: first a frame must begin. */
    if (!pipe.config->genlocked[before] || !pipe.config->genlocked[pipe.turns.now]) {
      watch_another();
      judge_frame();
      return;
    }
    seen = look();
  }
  begin_frame(&seen);
  judge_frame();
}

#ifdef CONSOLE
/* A millisecond with the decoder is not the time of a table that is built meanwhile. */
static void timed_field_start(void) {
  const uint32_t start = timer_ticks();
  field_start();
  view_other_ticks += timer_ticks() - start;
}
#endif

static void display_field_passed(void) {
  if (++pipe.quiet_fields < QUIET_FIELDS) return;
  pipe.quiet_fields = 0;
  isif_watch();
  if (pipe.capturing) leave_frame_out();
  pipe.capturing = pipe.complete = 0;
  watch_another();
  const signal_state_t seen = look();
  select_camera(turns_no_frames(&pipe.turns, &seen));
}

#else

/* VDINT0, after the last line of a field. Capture is started and stopped only here, after a second
 * field, so that frames are complete and begin with a first field. */
static void capture_field_end(void) {
  if (!pipe.progressive && !isif_second_field()) return;
  if (pipe.capturing) captured_frame_done();
  if (!pipe.capturing && pipe.capture_wanted) {
    pipe.capture_wanted = 0;
    pipe.capturing = 1;
    isif_capture();
  }
}
#endif

static void display_field_start(void) {
#ifdef TIME_DIVISION
  display_field_passed();
  display_watch_field(&pipe.display_watch, display_take_late());
#endif
  pipe.in_second_field = display_second_field();
  if (pipe.in_second_field) {
    pipe.second_field_start = timer_ticks();
    flip();
    return;
  }
  int32_t released;
  if (!output_first_field(&pipe.output, &released)) return;
  if (pipe.passthrough && released != OUTPUT_NONE) capture_release(&pipe.capture, released);
  if (pipe.serial) pipe.capture_wanted = 1;
}

/* Called by the IRQ entry. Acknowledges before handling, so that an edge in between is latched
 * again. */
void irq_dispatch(void);
void irq_dispatch(void) {
  const uint32_t source = intc_pending();
  if (source == INTC_NONE) {
    ++fw_state.spurious;
    return;
  }
  intc_acknowledge(source);
  if (source == IRQ_VPSSINT0)
    capture_field_end();
  else if (source == IRQ_VPSSINT8)
    display_field_start();
#if defined(CONSOLE)
  else if (source == IRQ_VPSSINT1)
    timed_field_start();
#elif defined(TIME_DIVISION)
  else if (source == IRQ_VPSSINT1)
    field_start();
#endif
#ifdef CONSOLE
  else if (source == IRQ_UART0)
    uart_queue_interrupt();
#endif
}

void pipeline_prepare(const config_t *config) {
  vpss_init(config->vpss_clk_ctrl);
  priority_set(config->priority);
  if (config->digital) return;
  i2c_init();
  uint32_t id;
  switch (tvp5146_start(config->is_625, &id)) {
    case I2C_OK:
      uart_puts("decoder: id ");
      uart_put_hex(id);
      uart_puts(", output on\n");
      break;
    case I2C_NACK:
      uart_puts("decoder: no answer on I2C, going on\n");
      break;
    case I2C_TIMEOUT:
      uart_puts("decoder: I2C timeout, going on\n");
      break;
  }
}

/* Sleeps until an enabled source is pending, for at most `ticks`, with interrupts masked in the
 * core. @return the pending source, or IRQ_TINT0_34 if the time has passed */
static uint32_t sleep_at_most(uint32_t ticks) {
  intc_enable(IRQ_TINT0_34, 7);
  timer_alarm(ticks);
  wait_for_interrupt();
  const uint32_t source = intc_pending();
  intc_disable(IRQ_TINT0_34);
  return source;
}

static void sleep_between_looks(void) { (void)sleep_at_most(LOCK_POLL_TICKS); }

/* Returns DISPLAY_LEAD_TICKS before the end of a camera frame, or soon if there are no syncs. If
 * the display is started now, the remap of each frame ends during the display's second field, in
 * which the displayed buffer may be changed. This leaves the largest margin before a late result
 * would be displayed one frame later, and gives the shortest latency from camera to display. */
static void wait_for_frame_end(void) {
  isif_watch();
  intc_enable(IRQ_VPSSINT0, 2);
#ifndef TIME_DIVISION
  /* The time between two frames is that of the camera's clock, which nobody tells. */
  uint32_t before = 0, frames = 0;
  while (pipe.progressive && sleep_at_most(LOCK_TIMEOUT_TICKS) == IRQ_VPSSINT0) {
    intc_acknowledge(IRQ_VPSSINT0);
    const uint32_t now = timer_ticks();
    if (++frames == 2) {
      (void)sleep_at_most(now - before - DISPLAY_LEAD_TICKS);
      return;
    }
    before = now;
  }
#endif
  while (sleep_at_most(2u * pipe.field_ticks) == IRQ_VPSSINT0) {
    intc_acknowledge(IRQ_VPSSINT0);
    if (!isif_second_field()) {
      (void)sleep_at_most(pipe.field_ticks - DISPLAY_LEAD_TICKS);
      return;
    }
  }
}

void pipeline_start(const config_t *config, uint32_t in_count, uint32_t out_count) {
  pipe.pitch_bytes = config->pitch_bytes;
  pipe.serial = config->serial;
  pipe.progressive = config->digital;
  pipe.passthrough = out_count == 0;
  pipe.field_ticks = config->is_625 ? 480000u : 400400u; /* 24 MHz / (50, 60000/1001) */
  pipe.sources = config->sources;
  pipe.taken_out = OUTPUT_NONE;
  capture_init(&pipe.capture, in_count);
  output_init(&pipe.output, out_count);

  const display_mode_t mode = {config->is_625, config->left,   config->top,
                               config->width,  config->height, config->pitch_bytes};
  const isif_window_t window = {config->source_left,   config->source_top,  config->source_width,
                                config->source_height, config->pitch_bytes, config->digital};
  if (isif_configure(&window) != ISIF_OK) fail("ISIF", "window");
#ifdef TIME_DIVISION
#ifdef COMPOSED_VIEW
  turns_init(&pipe.turns, composition_sources());
  for (uint32_t n = 0; n < CAMERAS_MAX; ++n) pipe.kept[n] = CAPTURE_NONE;
#else
  turns_init(&pipe.turns, config->cameras);
#endif
#ifdef CONSOLE
  field_watch_init(&pipe.watch, config->is_625);
  pipe.open.buffer = CAPTURE_NONE;
#endif
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
#endif
  if (isif_set_address((uint32_t)in_buffer(0)) != ISIF_OK) fail("ISIF", "buffer address");
#ifdef CONSOLE
  for (uint32_t n = 0; config->check_capture && n < in_count; ++n) mark_buffer((int32_t)n);
  /* The display's frames begin where they will: nothing is known of the camera's yet. */
  if (config->display_free && display_start(&mode) != DISPLAY_OK) fail("display", "mode");
#endif
  if (!config->digital && tvp5146_wait_lock(LOCK_TIMEOUT_TICKS, sleep_between_looks) != I2C_OK)
    uart_puts("decoder: no lock, going on\n");
#ifdef CONSOLE
  if (config->display_free) {
    isif_watch();
    intc_enable(IRQ_VPSSINT0, 2);
  } else
#endif
  {
    wait_for_frame_end();
    if (display_start(&mode) != DISPLAY_OK) fail("display", "mode");
  }

  pipe.capture_wanted = 1;
  intc_enable(IRQ_VPSSINT8, 3);
#ifdef TIME_DIVISION
  intc_enable(IRQ_VPSSINT1, 2);
#endif
  irq_unmask();
}

#ifdef COMPOSED_VIEW
/* The frame that waits takes the place of its camera's last one. */
static void keep_frame(void) {
  const int32_t buffer = capture_take(&pipe.capture, &pipe.taken_sequence);
  const uint32_t camera = pipe.taken_camera = pipe.camera_of[buffer];
  if (pipe.kept[camera] != CAPTURE_NONE) capture_release(&pipe.capture, pipe.kept[camera]);
  pipe.kept[camera] = buffer;
  pipe.kept_frame[camera] = in_buffer(buffer);
}

const uint8_t *const *pipeline_kept(void) { return pipe.kept_frame; }
#endif

int pipeline_take(uint8_t **out, uint32_t *sequence) {
  if (pipe.capture.ready == CAPTURE_NONE) return 0;
  if (pipe.held.count + 1u < pipe.sources) { /* the first frames only become sources */
    held_add(&pipe.held, capture_take(&pipe.capture, &pipe.taken_sequence));
    return 0;
  }
  const int32_t out_buffer = output_take(&pipe.output);
  if (out_buffer == OUTPUT_NONE) return 0;
  pipe.taken_out = out_buffer;
#ifdef COMPOSED_VIEW
  keep_frame();
#else
  held_add(&pipe.held, capture_take(&pipe.capture, &pipe.taken_sequence));
#endif
  *out = shown_buffer(out_buffer);
  *sequence = pipe.taken_sequence;
#if defined(TIME_DIVISION) && !defined(COMPOSED_VIEW)
  pipe.taken_camera = pipe.camera_of[held_of_age(&pipe.held, 0)];
#endif
  return 1;
}

#ifdef CONSOLE
int pipeline_whole(void) {
  const config_t *c = pipe.config;
  if (!c->check_capture) return 1;
  const int32_t buffer = held_of_age(&pipe.held, 0);
  const uint32_t bit = 1u << buffer;
  int reused = (pipe.capture.reused & bit) != 0; /* what is left of an older frame cannot be told from this one */
  dcache_invalidate_range(in_buffer(buffer), c->height * c->pitch_bytes);
  const uint32_t lost =
      reused ? 0 : capture_check_lost(in_buffer(buffer), c->width * 2u, c->pitch_bytes, c->height);
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

void pipeline_mark_free(void) {
  if (!pipe.config->check_capture) return;
  uint32_t cpsr = irq_mask();
  const int32_t buffer = capture_take_reused(&pipe.capture);
  irq_restore(cpsr);
  if (buffer == CAPTURE_NONE) return;
  mark_buffer(buffer);
  cpsr = irq_mask();
  capture_release(&pipe.capture, buffer);
  irq_restore(cpsr);
}

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

#ifdef TIME_DIVISION
display_event_t pipeline_display_event(uint32_t *late_fields) {
  const uint32_t cpsr = irq_mask();
  const display_event_t event = display_watch_take(&pipe.display_watch);
  *late_fields = pipe.display_watch.late_fields;
  irq_restore(cpsr);
  return event;
}

uint32_t pipeline_camera(void) { return pipe.taken_camera; }

int pipeline_event(uint32_t *camera, const char **what) {
  camera_event_t event;
  const uint32_t cpsr = irq_mask();
  const int is_one = turns_event(&pipe.turns, camera, &event);
  irq_restore(cpsr);
  if (is_one) *what = camera_event_text(event);
  return is_one;
}
#endif

const uint8_t *pipeline_source(uint32_t age) { return in_buffer(held_of_age(&pipe.held, age)); }

void pipeline_done(int good) {
  uint32_t cpsr = irq_mask();
#ifndef COMPOSED_VIEW
  const int32_t source = held_drop(&pipe.held);
#ifdef CONSOLE
  const int marked = pipe.config->check_capture;
  if (!marked)
#endif
    capture_release(&pipe.capture, source);
#endif
  if (good)
    output_queue(&pipe.output, pipe.taken_out, pipe.taken_sequence);
  else
    output_give_back(&pipe.output, pipe.taken_out);
  /* The main loop changes the display earlier than the handler would, if enough of a second field
   * is left. */
  if (pipe.in_second_field &&
      timer_ticks() - pipe.second_field_start < pipe.field_ticks - FLIP_MARGIN_TICKS)
    flip();
  irq_restore(cpsr);
#ifdef CONSOLE
  /* The result waits for nobody; its source is marked before the camera gets it. */
  if (!marked) return;
  mark_buffer(source);
  cpsr = irq_mask();
  capture_release(&pipe.capture, source);
  irq_restore(cpsr);
#endif
}

uint32_t pipeline_last_sequence(void) { return pipe.taken_sequence; }
