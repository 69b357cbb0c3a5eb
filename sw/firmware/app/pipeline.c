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
#include "fail.h"
#include "output.h"
#include "pipeline_state.h"
#ifdef TIME_DIVISION
#include "../drivers/uart_queue.h"
#include "pipeline_turns.h"
#include "progress.h"
#endif

/* Minimum time before a field's start for a change of the displayed buffer by the main loop. */
#define FLIP_MARGIN_TICKS TIMER_TICKS_PER_MS

/* Public drivers wait up to five times 200 ms for the decoder's lock. */
#define LOCK_TIMEOUT_TICKS (1000u * TIMER_TICKS_PER_MS)
#define LOCK_POLL_TICKS (10u * TIMER_TICKS_PER_MS)

/* The display's frames begin this long before the end of a camera frame. In the serial flow, the
 * result of one frame is then already displayed when the capture of the next one may start. */
#define DISPLAY_LEAD_TICKS TIMER_TICKS_PER_MS

pipeline_t pipe;

void fail(const char *what, const char *why) {
  phase_mark(PHASE_FAILED, 0);
#ifdef TIME_DIVISION
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

static uint8_t *shown_buffer(int32_t n) {
  return pipe.passthrough ? pipeline_buffer(n) : frame_out + (uint32_t)n * frame_stride;
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

#ifndef TIME_DIVISION
static void captured_frame_done(void) {
  ++fw_state.captured;
  if (pipe.serial) {
    capture_single_done(&pipe.capture);
    isif_watch();
    pipe.capturing = 0;
    return;
  }
  const int32_t next = capture_frame_done(&pipe.capture);
  fw_state.dropped = pipe.capture.dropped;
  if (next == CAPTURE_NONE) return;
  if (isif_set_address((uint32_t)pipeline_buffer(next)) != ISIF_OK) fail("ISIF", "buffer address");
  if (pipe.passthrough) {
    uint32_t sequence;
    const int32_t buffer = capture_take(&pipe.capture, &sequence);
    output_queue(&pipe.output, buffer, sequence);
  }
}

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
  pipeline_turns_display_field();
  progress_look();
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
#ifdef TIME_DIVISION
  if (source == IRQ_VPSSINT0)
    pipeline_turns_field_end();
  else if (source == IRQ_VPSSINT8)
    display_field_start();
  else if (source == IRQ_VPSSINT1)
    pipeline_turns_field_start();
  else if (source == IRQ_UART0)
    uart_queue_interrupt();
#else
  if (source == IRQ_VPSSINT0)
    capture_field_end();
  else if (source == IRQ_VPSSINT8)
    display_field_start();
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

static void sleep_between_looks(void) {
  (void)sleep_at_most(LOCK_POLL_TICKS);
#ifdef TIME_DIVISION
  progress_made();
#endif
}

/* Returns DISPLAY_LEAD_TICKS before the end of a camera frame, or soon if there are no syncs. If
 * the display is started now, the remap of each frame ends during the display's second field, in
 * which the displayed buffer may be changed. This leaves the largest margin before a late result
 * would be displayed one frame later, and gives the shortest latency from camera to display. */
static void wait_for_frame_end(void) {
  isif_watch();
  intc_enable(IRQ_VPSSINT0, 2);
#ifndef TIME_DIVISION
  /* The time between two frames follows from the camera's clock, which no parameter gives. */
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
  pipeline_turns_start(config, in_count);
#endif
  if (isif_set_address((uint32_t)pipeline_buffer(0)) != ISIF_OK) fail("ISIF", "buffer address");
#ifdef CONSOLE
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

int pipeline_take(uint8_t **out, uint32_t *sequence) {
  if (pipe.capture.ready == CAPTURE_NONE) return 0;
  if (pipe.held.count + 1u < pipe.sources) { /* the first frames only become sources */
    held_add(&pipe.held, capture_take(&pipe.capture, &pipe.taken_sequence));
    return 0;
  }
  const int32_t out_buffer = output_take(&pipe.output);
  if (out_buffer == OUTPUT_NONE) return 0;
  pipe.taken_out = out_buffer;
  held_add(&pipe.held, capture_take(&pipe.capture, &pipe.taken_sequence));
  *out = shown_buffer(out_buffer);
  *sequence = pipe.taken_sequence;
#ifdef TIME_DIVISION
  pipe.taken_camera = pipe.camera_of[held_of_age(&pipe.held, 0)];
#endif
  return 1;
}

const uint8_t *pipeline_source(uint32_t age) { return pipeline_buffer(held_of_age(&pipe.held, age)); }

void pipeline_done(int good) {
  const uint32_t cpsr = irq_mask();
#ifdef COMPOSED_VIEW
  const int32_t source = pipe.replaced;
#else
  const int32_t source = held_drop(&pipe.held);
#endif
#ifndef TIME_DIVISION
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
#ifdef TIME_DIVISION
  /* The result is queued already, so there is time to mark its source before the camera gets it. */
  if (source != CAPTURE_NONE) pipeline_turns_release(source);
#endif
}

uint32_t pipeline_last_sequence(void) { return pipe.taken_sequence; }
