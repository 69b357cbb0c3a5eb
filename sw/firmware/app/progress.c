#include "progress.h"

#include "../drivers/cp15.h"
#include "../drivers/timer.h"
#include "../drivers/uart.h"
#include "../drivers/watchdog.h"
#include "loop_watch.h"
#include "say.h"

/* At least what a sentence of the interrupt handler takes, which must not wait for room. */
#define SENTENCE_BYTES 100u

static struct {
  loop_watch_t loop;
  int on;
  uint32_t given_up; /* when the program last got on by it */
} progress;

void progress_start(uint32_t watchdog_us) {
  if (watchdog_has_reset()) uart_puts("reset by the watchdog: the program had stalled\n");
  progress.on = watchdog_us != 0;
  if (!progress.on) return;
  loop_watch_init(&progress.loop, watchdog_us / 2u * WATCHDOG_TICKS_PER_US, timer_ticks());
  watchdog_start(watchdog_us);
}

void progress_made(void) {
  if (!progress.on) return;
  const uint32_t cpsr = irq_mask(); /* a frame that suspends the build of a table serves the watchdog too */
  watchdog_serve();
  const uint32_t stalled = loop_watch_progress(&progress.loop, timer_ticks());
  irq_restore(cpsr);
  if (stalled == 0) return;
  uart_puts("watchdog: the program goes on after ");
  uart_put_uint(stalled / TIMER_TICKS_PER_MS);
  uart_puts(" ms\n");
}

void progress_without_frames(uint32_t given_up) {
  if (given_up == progress.given_up) return;
  progress.given_up = given_up;
  progress_made();
}

/* The interrupt entry has put it on top of its stack; interrupts do not nest. */
static uint32_t interrupted_pc(void) {
  extern uint8_t __irq_stack_top[];
  return *(const volatile uint32_t *)((uintptr_t)__irq_stack_top - 4u);
}

void progress_look(void) {
  if (!progress.on || !loop_watch_look(&progress.loop, timer_ticks())) return;
  if (uart_queue_room() < SENTENCE_BYTES) return;
  char place[] = "0x00000000\n";
  const uint32_t pc = interrupted_pc();
  for (uint32_t n = 0; n < 8u; ++n) place[9u - n] = "0123456789abcdef"[pc >> 4u * n & 15u];
  uart_puts("watchdog: no progress, the program is at ");
  uart_puts(place);
}
