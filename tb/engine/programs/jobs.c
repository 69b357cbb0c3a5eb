/* Jobs of the remap engine on the board, as a driver makes them; each line on UART0 says whether one did what it
 * should. The core sleeps while the engine works. Starts in internal RAM by foreign_start.S; caches are off.
 */
#include <stdint.h>

#include "sw/firmware/boot/boot.h"
#include "sw/firmware/drivers/uart.h"
#include "sw/firmware/mmio.h"
#include "sw/firmware/regs.h"

#define WORDS(address) ((volatile uint32_t *)(address))
enum {
  kSource = 0x80100000, kTarget = 0x80200000, kMap = 0x80300000, kNowhere = 0x40000000,
  kPairs = 13, kRows = 9, kSourcePairs = 16, kSourceRows = 12, kPitch = 20, /* words */
  kBorder = 0x10801080,
};
enum { kDone = 1, kRefused = 2, kReadError = 4, kAborted = 16, kDropped = 64 };

volatile uint32_t aborts; /* data aborts so far */
static volatile uint32_t interrupts, events;

/* The line is a level and the controller keeps edges: acknowledge first, then clear events until none is left. */
void irq_handler(void) {
  ++interrupts;
  mmio_write32(AINTC_IRQ0, 1u << IRQ_ENGINE);
  for (uint32_t now; (now = mmio_read32(ENGINE_EVENTS)) != 0;) {
    events |= now;
    mmio_write32(ENGINE_EVENTS, now);
  }
}

static void say(const char *name, int good, uint32_t value) {
  uart_puts(name);
  uart_puts(good ? " good " : " BAD ");
  uart_put_hex(value);
  uart_puts("\n");
}

/* Sleeps until all of `wanted` have happened. */
static void wait_for(uint32_t wanted) {
  for (;;) {
    __asm__ volatile("msr cpsr_c, #0xD3");
    if ((events & wanted) == wanted) break;
    __asm__ volatile("mcr p15, 0, %0, c7, c0, 4" : : "r"(0) : "memory");
    __asm__ volatile("msr cpsr_c, #0x53");
  }
  __asm__ volatile("msr cpsr_c, #0x53");
  events &= ~wanted;
}

static void window(uint32_t mode, uint32_t source, uint32_t rows) {
  mmio_write32(ENGINE_MODE, mode);
  mmio_write32(ENGINE_SIZE, kPairs | rows << 16);
  mmio_write32(ENGINE_SRC_BASE, source);
  mmio_write32(ENGINE_SRC_PITCH, kSourcePairs * 4);
  mmio_write32(ENGINE_SRC_SIZE, kSourcePairs * 2 | kSourceRows << 16);
  mmio_write32(ENGINE_DST_BASE, kTarget);
  mmio_write32(ENGINE_DST_PITCH, kPitch * 4);
  mmio_write32(ENGINE_MAP_BASE, kMap);
  mmio_write32(ENGINE_MAP_WORDS, kPairs * kRows);
  mmio_write32(ENGINE_BORDER, kBorder);
}

static void prepare(void) {
  const uint32_t end = kSourcePairs * kSourceRows;
  for (uint32_t n = 0; n < end; ++n) WORDS(kSource)[n] = n * 0x01030507u + 0x20406080u;
  for (uint32_t n = 0; n < kPairs * kRows; ++n) /* backwards; one is no address, one is the black word */
    WORDS(kMap)[n] = n == 5u ? 2u : n == 6u ? end * 4u : (end - 1u - n) * 4u;
}

static int result(int copy) {
  int good = 1;
  for (uint32_t j = 0; j < kRows; ++j)
    for (uint32_t i = 0; i < kPitch; ++i) {
      const uint32_t n = j * kPairs + i;
      uint32_t want = 0xEEEEEEEEu;
      if (i < kPairs)
        want = copy                  ? WORDS(kSource)[j * kSourcePairs + i]
               : n == 5u || n == 6u ? kBorder
                                     : WORDS(kSource)[kSourcePairs * kSourceRows - 1u - n];
      good &= WORDS(kTarget)[j * kPitch + i] == want;
    }
  return good;
}

static void clear(void) {
  for (uint32_t n = 0; n < kRows * kPitch; ++n) WORDS(kTarget)[n] = 0xEEEEEEEEu;
}

static uint32_t ended(void) { return mmio_read32(ENGINE_ENDED); }

int main(void) {
  const uint32_t id = mmio_read32(ENGINE_ID);
  if (aborts) {
    uart_puts("no engine\nfinished\n");
    for (;;) {
    }
  }
  say("ID", id == 0x52454D31u, id);
  mmio_write32(AINTC_EINT0, 1u << IRQ_ENGINE);
  __asm__ volatile("msr cpsr_c, #0x53");
  mmio_write32(ENGINE_ENABLES, 0x7F);
  mmio_write32(ENGINE_CTRL, ENGINE_CTRL_ENABLE);

  prepare();
  clear();
  window(0, kSource, kRows);
  mmio_write32(ENGINE_SUBMIT, 0x11);
  wait_for(kDone);
  say("table", result(0) && ended() == (1u << 16 | kDone << 8 | 0x11u), ended());
  say("bad entries", mmio_read32(ENGINE_BAD) == 1u, mmio_read32(ENGINE_BAD));

  /* Two jobs that wait: one that is not possible, and a copy, bilinear, by a projection. */
  clear();
  mmio_write32(ENGINE_CTRL, 0);
  mmio_write32(ENGINE_SIZE, 0);
  mmio_write32(ENGINE_SUBMIT, 0x22);
  window(3u | ENGINE_MODE_BILINEAR, kSource, kRows);
  mmio_write32(ENGINE_MAP_WORDS, 0);
  mmio_write32(ENGINE_A(1), 2u << 8);
  mmio_write32(ENGINE_B(2), 1u << 8);
  mmio_write32(ENGINE_C(0), 1u << 8);
  mmio_write32(ENGINE_SUBMIT, 0x33);
  say("waiting", mmio_read32(ENGINE_STATUS) == 0x20u, mmio_read32(ENGINE_STATUS));
  mmio_write32(ENGINE_CTRL, ENGINE_CTRL_ENABLE);
  wait_for(kRefused | kDone);
  say("projection", result(1) && ended() == (3u << 16 | kDone << 8 | 0x33u), ended());

  window(0, kNowhere, kRows);
  mmio_write32(ENGINE_SUBMIT, 0x44);
  wait_for(kReadError);
  say("bus error", ended() == (4u << 16 | kReadError << 8 | 0x44u), ended());

  /* Much longer than it takes to say so. */
  window(3, kSource, 4096);
  mmio_write32(ENGINE_SUBMIT, 0x55);
  mmio_write32(ENGINE_SUBMIT, 0x66);
  mmio_write32(ENGINE_CTRL, ENGINE_CTRL_ENABLE | ENGINE_CTRL_ABORT);
  wait_for(kDropped | kAborted);
  say("abort", ended() == (5u << 16 | kAborted << 8 | 0x55u), ended());

  clear();
  window(0, kSource, kRows);
  mmio_write32(ENGINE_SUBMIT, 0x77);
  wait_for(kDone);
  say("table again", result(0), ended());
  say("interrupts", interrupts >= 5u && interrupts <= 8u && events == 0u, events);
  uart_puts("finished\n");
  for (;;) {
  }
}
