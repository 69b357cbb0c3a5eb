/* How long transfers of the EDMA take, for a test that computes the same from latencies. Prints one line for each:
 * name, bytes more in the longer of two copies, and by how many ticks of the 24 MHz timer it took longer, so that
 * what a copy costs once does not count. The status is the number of copies that moved something else. No other
 * master uses the SDRAM meanwhile: the program polls registers from its instruction cache. Register addresses: Linux
 * drivers/dma/ti/edma.c and arch/arm/mach-davinci/dm365.c. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define REG(address) (*(volatile uint32_t *)(address))
enum {
  CC = 0x01C00000,
  ESR = CC + 0x1010,
  IPR = CC + 0x1068,
  ICR = CC + 0x1070,
  PSC = 0x01C41000,
  TIMER0 = 0x01C21400,
  RAM = 0x10000, /* internal RAM, as other masters see it */
};
enum { AB_SYNC = 1 << 2, TCINT = 1 << 20 };
enum { ARRAY = 4096, SHORT = 2, LONG = 10 };

/* In different banks of the SDRAM: 4 KB apart modulo the 16 KB of a row of all eight banks. */
static uint8_t source[LONG * ARRAY + 16384] __attribute__((aligned(16384)));
static uint8_t target[LONG * ARRAY + 16384] __attribute__((aligned(16384)));
static int failures;

static void enable(unsigned module) {
  REG(PSC + 0xA00 + 4 * module) = (REG(PSC + 0xA00 + 4 * module) & ~0x1Fu) | 3;
  REG(PSC + 0x120) = 1;
  while (REG(PSC + 0x128) & 1) {
  }
}

/* Ticks of `arrays` arrays of 4 KB, each `step` behind the one before. */
static uint32_t ticks(uintptr_t from, unsigned from_step, uintptr_t to, unsigned to_step, unsigned arrays) {
  volatile uint32_t *const p = (volatile uint32_t *)(uintptr_t)(CC + 0x4000);
  p[0] = AB_SYNC | TCINT;
  p[1] = from;
  p[2] = ARRAY | arrays << 16;
  p[3] = to;
  p[4] = from_step | to_step << 16;
  p[5] = 0xFFFF;
  p[6] = 0;
  p[7] = 1;
  const uint32_t start = REG(TIMER0 + 0x10);
  REG(ESR) = 1;
  while (!(REG(IPR) & 1)) {
  }
  const uint32_t end = REG(TIMER0 + 0x10);
  REG(ICR) = 1;
  return end - start;
}

static void measure(const char *name, uintptr_t from, unsigned from_step, uintptr_t to, unsigned to_step) {
  ticks(from, from_step, to, to_step, SHORT); /* the loop is in the instruction cache afterwards */
  const uint32_t few = ticks(from, from_step, to, to_step, SHORT);
  memset(target, 0xEE, sizeof target);
  const uint32_t many = ticks(from, from_step, to, to_step, LONG);
  for (unsigned n = 0; to != RAM && n < LONG; ++n)
    failures +=
        memcmp((void *)(to + n * to_step), (void *)(from - (from == RAM ? RAM : 0) + n * from_step), ARRAY) != 0;
  printf("%s %u %u\n", name, (LONG - SHORT) * ARRAY, (unsigned)(many - few));
}

int main(void) {
  uint32_t control;
  __asm__ volatile("mrc p15, 0, %0, c1, c0, 0" : "=r"(control));
  __asm__ volatile("mcr p15, 0, %0, c1, c0, 0" ::"r"(control | 1u << 12));
  for (unsigned module = 0; module < 5; ++module) enable(module);
  enable(27);
  REG(TIMER0 + 0x24) = 0x7;
  REG(TIMER0 + 0x18) = ~0u;
  REG(TIMER0 + 0x20) = 2u << 6;
  for (unsigned i = 0; i < sizeof source / 4; ++i) ((uint32_t *)source)[i] = i * 2654435761u;
  for (unsigned i = 0; i < ARRAY / 4; ++i) ((volatile uint32_t *)0x4000)[i] = i * 40503u;
  measure("ddr_to_ddr", (uintptr_t)source, ARRAY, (uintptr_t)target + 8192, ARRAY);
  measure("ram_to_ddr", RAM + 0x4000, 0, (uintptr_t)target, ARRAY);
  return failures;
}
