/* Transfers of the EDMA3 on the board, as a driver makes them: registers only, no model of it. Prints one
 * line for each scenario; the status is the number of those that failed. Register addresses: Linux
 * drivers/dma/ti/edma.c and arch/arm/mach-davinci/dm365.c. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define REG(address) (*(volatile uint32_t *)(address))
enum {
  CC = 0x01C00000,
  CCCFG = CC + 0x4,
  DMAQNUM0 = CC + 0x240,
  EMR = CC + 0x300,
  EMCR = CC + 0x308,
  CCERR = CC + 0x318,
  DRAE0 = CC + 0x340,
  SHADOW0 = CC + 0x2000,
  ESR = SHADOW0 + 0x10,
  EESR = SHADOW0 + 0x30,
  EECR = SHADOW0 + 0x28,
  SECR = SHADOW0 + 0x40,
  IESR = SHADOW0 + 0x60,
  IPR = SHADOW0 + 0x68,
  ICR = SHADOW0 + 0x70,
  TC0 = 0x01C10000,
  TC_ERRSTAT = 0x120,
  TC_ERRCLR = 0x128,
  TC_ERRDET = 0x12C,
  PSC = 0x01C41000,
  SYSTEM_MISC = 0x01C40038,
  TIMER0 = 0x01C21400,
};
enum {
  AB_SYNC = 1 << 2,
  STATIC_SET = 1 << 3,
  EARLY = 1 << 11,
  TCINT = 1 << 20,
  TCCHAIN = 1 << 22,
  ITCCHAIN = 1 << 23,
};
#define TCC(n) ((uint32_t)(n) << 12)
#define PAIR(low, high) ((uint32_t)(uint16_t)(low) | (uint32_t)(uint16_t)(high) << 16)

static uint8_t source[65536] __attribute__((aligned(64)));
static uint8_t target[65536] __attribute__((aligned(64)));
static int failures;

static void check(const char *name, int good) {
  printf("%s: %s\n", name, good ? "good" : "BAD");
  failures += !good;
}

static void enable(unsigned module) {
  REG(PSC + 0xA00 + 4 * module) = (REG(PSC + 0xA00 + 4 * module) & ~0x1Fu) | 3;
  REG(PSC + 0x120) = 1;
  while (REG(PSC + 0x128) & 1) {
  }
}

static void set(unsigned n, uint32_t opt, const void *src, uint32_t counts, const void *dst,
                uint32_t array_index, uint32_t link, uint32_t frame_index, uint32_t frames) {
  volatile uint32_t *p = (volatile uint32_t *)(uintptr_t)(CC + 0x4000 + 32 * n);
  p[0] = opt;
  p[1] = (uint32_t)src;
  p[2] = counts;
  p[3] = (uint32_t)dst;
  p[4] = array_index;
  p[5] = link;
  p[6] = frame_index;
  p[7] = frames;
}

static int done(unsigned code) {
  for (unsigned n = 0; n < 20000; ++n)
    if (REG(IPR) >> code & 1) {
      REG(ICR) = 1u << code;
      return 1;
    }
  return 0;
}

static void clear(void) { memset(target, 0xEE, sizeof target); }

/* 64 KB by channel 0; the ticks that it takes. */
static uint32_t copy(const char *name) {
  clear();
  set(0, AB_SYNC | TCINT, source, PAIR(512, 128), target, PAIR(512, 512), 0xFFFF, 0, 1);
  const uint32_t start = REG(TIMER0 + 0x10);
  REG(ESR) = 1;
  const int ended = done(0);
  const uint32_t ticks = REG(TIMER0 + 0x10) - start;
  check(name, ended && memcmp(source, target, sizeof source) == 0 && ticks >= 65536u * 24 / 486);
  printf("  %u ticks of the 24 MHz timer\n", (unsigned)ticks);
  return ticks;
}

/* 64 KB on each transfer controller; 486 MB/s is what SDRAM at 243 MHz can copy at most. */
static void copies(void) {
  uint32_t ticks = 0;
  for (unsigned tc = 0; tc < 4; ++tc) {
    char name[32];
    REG(DMAQNUM0) = tc;
    sprintf(name, "copy by TC%u", tc);
    const uint32_t t = copy(name);
    if (tc == 1) ticks = t;
  }
  /* MISC.TPTC1_BST (TI's register header): bursts of 64 bytes instead of 32. */
  REG(DMAQNUM0) = 1;
  REG(SYSTEM_MISC) |= 1u << 7;
  check("TC1 copies faster with bursts of 64 bytes", copy("copy by TC1, bursts of 64") < ticks);
  REG(SYSTEM_MISC) &= ~(1u << 7);
  REG(DMAQNUM0) = 0;
}

/* Each element a request of its own, the next one triggered by the end of the one before. */
static void gather(void) {
  clear();
  set(1, TCINT | ITCCHAIN | TCC(1), source + 4 * 63, PAIR(4, 64), target, PAIR(-4, 4), 0xFFFF, 0, 1);
  REG(ESR) = 2;
  int good = done(1);
  for (unsigned i = 0; i < 64; ++i) good &= memcmp(target + 4 * i, source + 4 * (63 - i), 4) == 0;
  check("gather of 64 elements", good && target[256] == 0xEE);
}

/* Channel 2's set is replaced by set 100, then by set 101, which ends in a null set: the fourth trigger is
 * an error. */
static void links(void) {
  clear();
  set(2, AB_SYNC | TCINT | TCC(2), source, PAIR(16, 1), target, 0, 0x4000 + 32 * 100, 0, 1);
  set(100, AB_SYNC | TCINT | TCC(2), source + 100, PAIR(16, 1), target + 100, 0, 32 * 101, 0, 1);
  set(101, AB_SYNC | TCINT | TCC(2), source + 200, PAIR(16, 1), target + 200, 0, 0xFFFF, 0, 1);
  int good = 1;
  for (unsigned n = 0; n < 3; ++n) {
    REG(ESR) = 4;
    good &= done(2) && memcmp(source + 100 * n, target + 100 * n, 16) == 0;
  }
  check("links", good && target[16] == 0xEE && target[116] == 0xEE && target[216] == 0xEE);
  REG(ESR) = 4;
  good = !done(2) && (REG(EMR) & 4);
  REG(EMCR) = 4;
  REG(SECR) = 4;
  check("a null set is an error", good && !(REG(EMR) & 4));
}

/* TIMER0's event 48 moves a word at each period. Channel 48 is in the upper half of the registers. */
static void timer_event(void) {
  clear();
  set(48, TCC(3) | TCINT, source, PAIR(4, 4), target, PAIR(4, 4), 0xFFFF, 0, 1);
  REG(EECR + 4) = 1u << 16;
  REG(EMCR + 4) = 1u << 16;
  REG(SECR + 4) = 1u << 16;
  REG(SHADOW0 + 0x08 + 4) = 1u << 16;
  REG(EESR + 4) = 1u << 16;
  REG(TIMER0 + 0x20) = 0;
  REG(TIMER0 + 0x10) = 0;
  REG(TIMER0 + 0x18) = 240; /* 10 us */
  REG(TIMER0 + 0x20) = 2u << 6;
  const int ended = done(3);
  REG(EECR + 4) = 1u << 16;
  REG(TIMER0 + 0x20) = 0;
  REG(TIMER0 + 0x18) = ~0u;
  REG(TIMER0 + 0x20) = 2u << 6;
  check("a timer's event moves data", ended && memcmp(source, target, 16) == 0 && target[16] == 0xEE);
}

/* A slow register is read first, internal RAM second: the second answer comes earlier, and the data must not
 * be exchanged. */
static void slow_and_fast(void) {
  static volatile uint32_t *const ram = (volatile uint32_t *)0x00006000;
  ram[0] = 0x11223344;
  ram[1] = 0x55667788;
  clear();
  set(5, AB_SYNC, (void *)(TIMER0 + 0x18), PAIR(4, 1), target, 0, 0xFFFF, 0, 1);
  set(6, AB_SYNC | TCINT | TCC(6), (void *)0x00016000, PAIR(8, 1), target + 64, 0, 0xFFFF, 0, 1);
  REG(ESR) = 3u << 5;
  const int ended = done(6);
  const uint32_t period = ~0u;
  check("answers of slaves of different speed keep their order",
        ended && memcmp(target, &period, 4) == 0 && target[4] == 0xEE &&
            memcmp(target + 64, (void *)ram, 8) == 0);
}

/* Three requests in one queue with slow reads, of which only the last one reports. */
static void slow_queue(void) {
  clear();
  for (unsigned n = 0; n < 3; ++n)
    set(8 + n, AB_SYNC | (n == 2 ? TCINT : 0) | TCC(7), source + 128 * n, PAIR(128, 1),
        target + 128 * n, 0, 0xFFFF, 0, 1);
  REG(TC0 + 0x140) = 1;
  REG(ESR) = 7u << 8;
  check("a queue goes on when its controller is free", done(7) && memcmp(source, target, 384) == 0);
  REG(TC0 + 0x140) = 0;
}

/* A queue that is mapped to a controller that does not exist waits until the mapping is right. */
static void mended_mapping(void) {
  clear();
  REG(CC + 0x280) = 0x3214;
  set(12, AB_SYNC | TCINT | TCC(7), source, PAIR(64, 1), target, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << 12;
  const int early = done(7);
  REG(CC + 0x280) = 0x3210;
  check("a queue goes on when its mapping is right", !early && done(7) && memcmp(source, target, 64) == 0);
}

/* Parameter sets that the EDMA itself brings from memory, 32 bytes each: 48 of them take 384 accesses of 40 ns
 * (`bus.config.fast_latency`), 368 ticks of 24 MHz. Then the first of them, which is channel 40's, runs. */
static void fetched_sets(void) {
  static uint32_t sets[48][8] __attribute__((aligned(64)));
  clear();
  for (unsigned n = 0; n < 48; ++n) {
    const uint32_t set[8] = {AB_SYNC | TCINT | TCC(5), (uint32_t)source + 16 * n, PAIR(16, 1), (uint32_t)target + n,
                             n << 16 | n, 0xFFFF, n, 1};
    memcpy(sets[n], set, sizeof set);
  }
  REG(DMAQNUM0 + 4) = 0;
  set(13, TCINT | TCC(6), sets, PAIR(sizeof sets, 1), (void *)(CC + 0x4000 + 32 * 40), 0, 0xFFFF, 0, 1);
  const uint32_t start = REG(TIMER0 + 0x10);
  REG(ESR) = 1u << 13;
  const int ended = done(6);
  const uint32_t ticks = REG(TIMER0 + 0x10) - start;
  int good = ended && ticks >= 368 && ticks < 368 + 60;
  for (unsigned n = 0; n < 48; ++n)
    for (unsigned w = 0; w < 8; ++w) good &= REG(CC + 0x4000 + 32 * (40 + n) + 4 * w) == sets[n][w];
  check("sets are fetched in bursts", good);
  printf("  %u ticks of the 24 MHz timer\n", (unsigned)ticks);
  REG(ESR + 4) = 1u << 8;
  check("a fetched set runs", done(5) && memcmp(target, source, 16) == 0 && target[16] == 0xEE);
}

static void bus_error(void) {
  set(4, AB_SYNC | TCINT | TCC(4), (void *)0x40000000, PAIR(32, 1), target, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << 4;
  const int ended = done(4);
  const uint32_t status = REG(TC0 + TC_ERRSTAT), detail = REG(TC0 + TC_ERRDET);
  REG(TC0 + TC_ERRCLR) = 1;
  check("a bus error is in the error registers",
        ended && status == 1 && detail == (1u | 4u << 8 | 1u << 16) && REG(TC0 + TC_ERRSTAT) == 0 &&
            REG(TC0 + TC_ERRDET) == 0);
  clear();
  set(4, AB_SYNC | TCINT | TCC(4), source, PAIR(64, 1), target, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << 4;
  check("the next transfer is good", done(4) && memcmp(source, target, 64) == 0);
}

/* Inputs of the interrupt controller, where a pending one reads 0, and the bit of ARM_INTMUX that selects the EDMA for
 * it. The core masks interrupts. */
enum {
  TC_ERREN = 0x124,
  TC_ERRCMD = 0x130,
  ARM_INTMUX = 0x01C40018,
  IRQ0 = 0x01C48008,
  EINT0 = 0x01C48018,
  INTPRI0 = 0x01C48030,
};
static const struct {
  unsigned input, choice;
} CCERRINT = {17, 2}, TCERRINT[4] = {{18, 3}, {19, 4}, {61, 22}, {62, 23}};

static void listen(unsigned input, unsigned choice) {
  REG(ARM_INTMUX) |= 1u << choice;
  REG(INTPRI0 + input / 8 * 4) |= 7u << input % 8 * 4;
  REG(EINT0 + input / 32 * 4) |= 1u << input % 32;
  REG(IRQ0 + input / 32 * 4) = 1u << input % 32;
}

static void listen_no_more(unsigned input) { REG(EINT0 + input / 32 * 4) &= ~(1u << input % 32); }

static int interrupted(unsigned input) {
  const uint32_t status = IRQ0 + input / 32 * 4;
  int pending = 0;
  for (unsigned n = 0; n < 50; ++n) pending |= !(REG(status) >> input % 32 & 1);
  REG(status) = 1u << input % 32;
  return pending;
}

static int wrong_read(void) {
  set(4, AB_SYNC | TCINT | TCC(4), (void *)0x40000000, PAIR(32, 1), target, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << 4;
  return done(4) && REG(TC0 + TC_ERRSTAT) == 1;
}

static void controller_errors(void) {
  listen(TCERRINT[0].input, TCERRINT[0].choice);
  check("no interrupt by an error that is not enabled", wrong_read() && !interrupted(18));
  REG(TC0 + TC_ERREN) = 1;
  REG(TC0 + TC_ERRCMD) = 1;
  check("ERRCMD pulses for an enabled error that is pending", interrupted(18));
  REG(TC0 + TC_ERRCMD) = 1;
  check("as often as it is written", interrupted(18));
  REG(TC0 + TC_ERRCLR) = 4;
  check("ERRCLR clears what it names", REG(TC0 + TC_ERRSTAT) == 1);
  REG(TC0 + TC_ERRCLR) = 1;
  REG(TC0 + TC_ERRCMD) = 1;
  check("ERRCMD does nothing without an error", REG(TC0 + TC_ERRSTAT) == 0 && !interrupted(18));
  check("an enabled error interrupts", wrong_read() && interrupted(18));
  check("once until it is cleared", wrong_read() && !interrupted(18));
  REG(TC0 + TC_ERRCLR) = 1;
  set(4, 1 | AB_SYNC | TCINT | TCC(4), source + 4, PAIR(32, 1), target, 0, 0xFFFF, 0, 1); /* SAM */
  REG(ESR) = 1u << 4;
  const int silent = !interrupted(18) && !(REG(IPR) & 1u << 4);
  check("constant addressing at no multiple of 32 is TRERR", silent && REG(TC0 + TC_ERRSTAT) == 4);
  REG(TC0 + TC_ERREN) = 4;
  REG(TC0 + TC_ERRCMD) = 1;
  const int enabled = interrupted(18);
  REG(TC0 + TC_ERRCLR) = 4;
  check("with its own enable", enabled && REG(TC0 + TC_ERRSTAT) == 0);
  REG(TC0 + TC_ERREN) = 0;
  listen_no_more(18);
}

/* An error of each transfer controller reaches its own input and no other one. */
static void errors_of_all(void) {
  for (unsigned n = 0; n < 4; ++n) {
    listen(TCERRINT[n].input, TCERRINT[n].choice);
    REG(TC0 + 0x400 * n + TC_ERREN) = 1;
  }
  for (unsigned tc = 0; tc < 4; ++tc) {
    REG(DMAQNUM0) = tc << 16;
    set(4, AB_SYNC | TCINT | TCC(4), (void *)0x40000000, PAIR(32, 1), target, 0, 0xFFFF, 0, 1);
    REG(ESR) = 1u << 4;
    int good = done(4);
    for (unsigned n = 0; n < 4; ++n) {
      good &= REG(TC0 + 0x400 * n + TC_ERRSTAT) == (n == tc);
      good &= interrupted(TCERRINT[n].input) == (n == tc);
    }
    REG(TC0 + 0x400 * tc + TC_ERRCLR) = 1;
    char name[64];
    sprintf(name, "an error of TC%u is interrupt %u", tc, TCERRINT[tc].input);
    check(name, good);
  }
  REG(DMAQNUM0) = 0;
  for (unsigned n = 0; n < 4; ++n) {
    REG(TC0 + 0x400 * n + TC_ERREN) = 0;
    listen_no_more(TCERRINT[n].input);
  }
}

/* CCERRINT comes with the first error and not again until all are cleared; EEVAL asks for it once more. */
static void null_sets_interrupt(void) {
  enum { EEVAL = CC + 0x320, ONE = 1 << 12, TWO = 1 << 13 };
  static uint8_t nothing[1];
  for (unsigned n = 12; n < 14; ++n) set(n, 0, nothing, 0, nothing, 0, 0xFFFF, 0, 0);
  REG(EEVAL) = 1;
  check("no interrupt without an error", REG(EMR) == 0 && !interrupted(CCERRINT.input));
  REG(ESR) = ONE;
  check("a null set interrupts", interrupted(CCERRINT.input) && REG(EMR) == ONE);
  REG(ESR) = TWO;
  check("a second error does not", !interrupted(CCERRINT.input) && REG(EMR) == (ONE | TWO));
  REG(EMCR) = ONE;
  REG(EEVAL) = 1;
  check("EEVAL does while one is pending", interrupted(CCERRINT.input) && REG(EMR) == TWO);
  REG(EMCR) = TWO;
  REG(EEVAL) = 1;
  check("and not when none is", !interrupted(CCERRINT.input) && REG(EMR) == 0);
  REG(SECR) = ONE | TWO;
}

/* A timer's event 48: the first waits in its queue, which has no controller, the second in ER, the third is missed. */
static void missed_events_interrupt(void) {
  const uint32_t bit = 1u << 16;
  clear();
  set(48, TCC(3) | TCINT, source, PAIR(4, 4), target, PAIR(4, 4), 0xFFFF, 0, 1);
  REG(CC + 0x280) = 0x3214; /* QUETCMAP */
  REG(TIMER0 + 0x20) = 0;
  REG(SHADOW0 + 0x08 + 4) = bit; /* ECRH */
  REG(EESR + 4) = bit;
  REG(TIMER0 + 0x10) = 0;
  REG(TIMER0 + 0x18) = 240; /* 10 us */
  REG(TIMER0 + 0x20) = 2u << 6;
  int missed = 0;
  for (unsigned n = 0; n < 1000 && !missed; ++n) missed = REG(EMR + 4) == bit;
  const int waiting = (REG(SHADOW0 + 0x38 + 4) & bit) && (REG(SHADOW0 + 4) & bit) && target[0] == 0xEE;
  check("a missed event interrupts", missed && waiting && interrupted(CCERRINT.input));
  check("once until it is cleared", !interrupted(CCERRINT.input));
  REG(EECR + 4) = bit;
  REG(EMCR + 4) = bit;
  check("cleared", REG(EMR + 4) == 0 && !interrupted(CCERRINT.input));
  REG(CC + 0x280) = 0x3210;
  REG(EESR + 4) = bit;
  check("the events that were kept move data, and those behind them", done(3) && memcmp(source, target, 16) == 0);
  REG(EECR + 4) = bit;
  REG(EMCR + 4) = bit;
  REG(SECR + 4) = bit;
  REG(TIMER0 + 0x20) = 0;
  REG(TIMER0 + 0x18) = ~0u;
  REG(TIMER0 + 0x20) = 2u << 6;
}

static void channel_errors(void) {
  listen(CCERRINT.input, CCERRINT.choice);
  null_sets_interrupt();
  missed_events_interrupt();
  listen_no_more(CCERRINT.input);
}

/* A channel whose transfer controller has no clock waits until it has. */
static void gated_controller(void) {
  enum { TC2 = 3 };
  clear();
  REG(PSC + 0xA00 + 4 * TC2) = (REG(PSC + 0xA00 + 4 * TC2) & ~0x1Fu) | 2;
  REG(PSC + 0x120) = 1;
  while (REG(PSC + 0x128) & 1) {
  }
  REG(DMAQNUM0 + 4) = 2u << 24;
  set(14, AB_SYNC | TCINT | TCC(7), source, PAIR(64, 1), target, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << 14;
  const int early = done(7);
  enable(TC2);
  check("a transfer waits for the clock of its controller", !early && done(7) && memcmp(source, target, 64) == 0);
  REG(DMAQNUM0 + 4) = 0;
}

/* What a program gets wrong, and that the channel works again afterwards. ERRDET: the code of the error in bits 3 to
 * 0 (1: read address, 9: write address), the completion code and TCINTEN of its request. */
static int reports(uint32_t src, uint32_t dst, uint32_t error) {
  set(4, AB_SYNC | TCINT | TCC(4), (void *)src, PAIR(32, 1), (void *)dst, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << 4;
  const int ended = done(4), status = REG(TC0 + TC_ERRSTAT) == 1;
  const uint32_t detail = REG(TC0 + TC_ERRDET);
  REG(TC0 + TC_ERRCLR) = 1;
  clear();
  return ended && status && detail == (error | 4u << 8 | 1u << 16);
}

static int copies_again(unsigned channel) {
  memset(target, 0, 64);
  set(channel, AB_SYNC | TCINT | TCC(4), source, PAIR(64, 1), target, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << channel;
  return done(4) && memcmp(source, target, 64) == 0;
}

static void bad_input(void) {
  enum { UART1_DLL = 0x01D06020, NO_BLOCK = 0x01D30000, NOWHERE = 0x40000000, READ = 1, WRITE = 9 };
  clear();
  check("a write to an unmapped address is a bus error", reports((uint32_t)source, NOWHERE, WRITE));
  check("a write to registers that are absent", reports((uint32_t)source, NO_BLOCK, WRITE));
  check("a read of them", reports(NO_BLOCK, (uint32_t)target, READ));
  /* A module without clock answers as it does to the core: reads give 0, writes are lost, with a remark. */
  clear();
  set(4, AB_SYNC | TCINT | TCC(4), (void *)UART1_DLL, PAIR(4, 1), target, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << 4;
  check("a read of a module without clock", done(4) && *(uint32_t *)target == 0 && target[4] == 0xEE);
  set(4, AB_SYNC | TCINT | TCC(4), source + 4, PAIR(4, 1), (void *)UART1_DLL, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << 4;
  const int lost = done(4) && REG(TC0 + TC_ERRSTAT) == 0;
  enable(20);
  REG(0x01D06030) = 0x6001; /* out of reset */
  check("a write to it is lost", lost && REG(UART1_DLL) == 0);
  set(4, AB_SYNC | TCINT | TCC(4), source + 4, PAIR(4, 1), (void *)UART1_DLL, 0, 0xFFFF, 0, 1);
  REG(ESR) = 1u << 4;
  check("with a clock it is not", done(4) && (REG(UART1_DLL) & 0xFF) == source[4]);
  check("a copy after all of these", copies_again(4));
  clear();
  set(4, AB_SYNC | TCINT | TCC(4), source, PAIR(64, 1), target, 0, 0x4000 + 32 * 256, 0, 1); /* no such set */
  REG(ESR) = 1u << 4;
  const int first = done(4);
  REG(ICR) = 1u << 4;
  REG(ESR) = 1u << 4;
  const int second = done(4), missed = REG(EMR) == 1u << 4;
  REG(EMCR) = 1u << 4;
  REG(SECR) = 1u << 4;
  check("a link to nowhere ends the transfer, and the next trigger finds a null set", first && !second && missed);
  check("a copy after it", copies_again(4) && REG(EMR) == 0);
}

int main(void) {
  for (unsigned module = 0; module < 5; ++module) enable(module);
  enable(27); /* TIMER0: two counters of 32 bits, running */
  REG(TIMER0 + 0x24) = 0x7;
  REG(TIMER0 + 0x18) = ~0u;
  REG(TIMER0 + 0x20) = 2u << 6;
  for (unsigned i = 0; i < sizeof source; ++i) source[i] = (uint8_t)(i * 7 + (i >> 8));
  REG(DRAE0) = ~0u;
  REG(DRAE0 + 4) = ~0u;
  REG(IESR) = 0xFF;
  check("CCCFG", REG(CCCFG) == 0x00234445);
  copies();
  gather();
  links();
  timer_event();
  slow_and_fast();
  slow_queue();
  mended_mapping();
  fetched_sets();
  bus_error();
  controller_errors();
  errors_of_all();
  channel_errors();
  gated_controller();
  bad_input();
  check("no other error", REG(EMR) == 0 && REG(EMR + 4) == 0 && REG(CCERR) == 0);
  return failures;
}
