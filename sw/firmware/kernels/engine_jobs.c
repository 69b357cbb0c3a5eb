#include "engine_jobs.h"

#include "../drivers/cp15.h"
#include "../drivers/engine.h"
#include "../drivers/intc.h"
#include "../drivers/timer.h"
#include "../drivers/uart.h"
#include "../app/say.h" /* behind uart.h */
#include "../regs.h"

#define INTERRUPT_PRIORITY 4u
#define LONGEST_TICKS (2000u * TIMER_TICKS_PER_MS)
#define COUNT_MODULUS 0x10000u /* of jobs that ended */

static struct {
  uint32_t submitted; /* jobs since the start */
  uint32_t offset;    /* of the engine's count of jobs that ended, against ours */
  uint32_t events;    /* of the jobs under way */
  int failed;         /* one of the jobs under way */
  int any_failed;     /* since engine_jobs_failed() */
} jobs;

static uint32_t under_way(void) {
  return (jobs.submitted + jobs.offset - engine_ended()) % COUNT_MODULUS;
}

static int start(void) {
  if (!engine_init()) return 0;
  jobs.offset = engine_ended() - jobs.submitted;
  jobs.events = 0;
  jobs.failed = 0;
  return 1;
}

int engine_jobs_open(void) {
  /* A frame that comes while a table is built in the background must find the engine ready. */
  const uint32_t cpsr = irq_mask();
  const int good = start();
  irq_restore(cpsr);
  if (good) intc_enable(IRQ_ENGINE, INTERRUPT_PRIORITY);
  return good;
}

/* Sleeps until at most `most` jobs are under way, or one has failed, or none has ended for too long. */
static void wait_until(uint32_t most) {
  uint32_t since = timer_ticks(), left = COUNT_MODULUS;
  int ready;
  do {
    /* Checked with interrupts masked: one that comes after the check still ends the sleep. */
    const uint32_t cpsr = irq_mask();
    jobs.events |= engine_take_events();
    const uint32_t now = under_way();
    if (now < left) since = timer_ticks();
    left = now;
    jobs.failed = (jobs.events & ~(uint32_t)ENGINE_EVENTS_DONE) != 0 || timer_ticks() - since > LONGEST_TICKS;
    ready = jobs.failed || left <= most;
    if (!ready) wait_for_interrupt();
    irq_restore(cpsr);
  } while (!ready);
}

void engine_jobs_add(const remap_engine_job_t *job) {
  if (!jobs.failed) wait_until(ENGINE_QUEUE - 1u);
  if (jobs.failed) return;
  engine_submit(job, jobs.submitted++);
}

static void report(void) {
  static const char kDigits[] = "0123456789abcdef";
  char text[] = "0x00";
  text[2] = kDigits[jobs.events >> 4 & 15u];
  text[3] = kDigits[jobs.events & 15u];
  uart_puts("engine: ");
  if (jobs.events == 0) uart_puts("no end of a job, ");
  uart_puts("events ");
  uart_puts(text);
  uart_puts("\n");
}

void engine_jobs_wait(void) {
  if (!jobs.failed) wait_until(0);
  if (jobs.failed) {
    jobs.any_failed = 1;
    report();
    if (!start()) uart_puts("engine: does not stop\n");
  }
  jobs.events = 0;
}

int engine_jobs_failed(void) {
  const int failed = jobs.any_failed;
  jobs.any_failed = 0;
  return failed;
}
