/* Hardware events of the EDMA3 on the board: each source moves data by its own event, and moves nothing
 * while the multiplexer in front of the channel is set to another source. Then the registers that show what a
 * transfer controller works on. Registers only, no model of them. Prints one line for each scenario; the
 * status is the number of those that failed. Register addresses: Linux drivers/dma/ti/edma.c,
 * arch/arm/mach-davinci/dm365.c and drivers/i2c/busses/i2c-davinci.c; events: SPRUH82C; their numbers: TI's register
 * header for the DM36x. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define REG(address) (*(volatile uint32_t *)(address))
enum {
  CC = 0x01C00000,
  EMR = CC + 0x300,
  EMCR = CC + 0x308,
  DRAE0 = CC + 0x340,
  SHADOW0 = CC + 0x2000,
  ECR = SHADOW0 + 0x08,
  ESR = SHADOW0 + 0x10,
  EECR = SHADOW0 + 0x28,
  EESR = SHADOW0 + 0x30,
  SECR = SHADOW0 + 0x40,
  IESR = SHADOW0 + 0x60,
  IPR = SHADOW0 + 0x68,
  ICR = SHADOW0 + 0x70,
  TC0 = 0x01C10000,
  PSC = 0x01C41000,
  SYSTEM = 0x01C40000,
  PINMUX3 = SYSTEM + 0x0C,
  EVTMUX = SYSTEM + 0x1C,
  UART0 = 0x01C20000,
  UART1 = 0x01D06000,
  I2C = 0x01C21000,
  BINTEN = 0x01C67008,
  GPIO01 = 0x01C67010,
  VPSS = 0x01C70000,
  VENC = 0x01C71E00,
};
enum { TIMER_TIM12 = 0x10, TIMER_PRD12 = 0x18, TIMER_TCR = 0x20, TIMER_TGCR = 0x24 };
enum { AB_SYNC = 1 << 2, TCINT = 1 << 20, TCCHAIN = 1 << 22 };
#define TCC(n) ((uint32_t)(n) << 12)
#define PAIR(low, high) ((uint32_t)(uint16_t)(low) | (uint32_t)(uint16_t)(high) << 16)

static uint8_t source[40960] __attribute__((aligned(64)));
static uint8_t target[40960] __attribute__((aligned(64)));
static int failures;
static uint32_t missed;

enum { DUMMY = 100 }; /* a set of no bytes, which links to itself: events behind a transfer do no harm */

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

static void set(unsigned n, uint32_t opt, uintptr_t src, uint32_t counts, uintptr_t dst,
                uint32_t array_index, uint32_t frames) {
  volatile uint32_t *p = (volatile uint32_t *)(uintptr_t)(CC + 0x4000 + 32 * n);
  p[0] = opt;
  p[1] = src;
  p[2] = counts;
  p[3] = dst;
  p[4] = array_index;
  p[5] = 0x4000 + 32 * DUMMY;
  p[6] = 0;
  p[7] = frames;
}

/* A channel's event and what it has left behind; channels from 32 on are in the upper registers. */
static void stop(unsigned channel) {
  const unsigned upper = channel / 32 * 4;
  const uint32_t bit = 1u << channel % 32;
  REG(EECR + upper) = bit;
  REG(ECR + upper) = bit;
  REG(SECR + upper) = bit;
  missed |= REG(EMR + upper) & bit;
  REG(EMCR + upper) = bit;
  REG(ICR) = ~0u;
}
static void listen(unsigned channel) {
  stop(channel);
  REG(EESR + channel / 32 * 4) = 1u << channel % 32;
}

static int done(unsigned code, unsigned polls) {
  for (unsigned n = 0; n < polls; ++n)
    if (REG(IPR) >> code & 1) return 1;
  return 0;
}

enum { THR = 0x00, FCR = 0x08, MCR = 0x10, DLL = 0x20, PWREMU = 0x30 };

/* A loop: what the transmitter sends arrives in the receiver. `flags` of FCR beside the FIFO's enable. */
static void uart_loop(uint32_t uart, uint32_t flags) {
  REG(uart + PWREMU) = 0;
  REG(uart + 0x0C) = 3; /* 8 bits */
  REG(uart + MCR) = 0x10;
  REG(uart + DLL) = 1;
  REG(uart + 0x24) = 0;
  REG(uart + FCR) = 1;
  REG(uart + FCR) = 7 | flags;
}

/* Bytes leave by the transmit event and come back by the receive event, one for each event. */
static int uart_moves(uint32_t uart, unsigned receive, uint32_t flags) {
  enum { N = 6 };
  memset(target, 0xEE, sizeof target);
  uart_loop(uart, flags);
  set(receive, TCINT | TCC(1), uart + THR, PAIR(1, N), (uintptr_t)target, PAIR(0, 1), 1);
  set(receive + 1, TCC(2) | TCINT, (uintptr_t)source, PAIR(1, N), uart + THR, PAIR(1, 0), 1);
  listen(receive);
  listen(receive + 1);
  REG(uart + PWREMU) = 0x6001; /* the first transmit event */
  const int ended = done(1, 3000);
  REG(EECR) = 3u << receive;
  const int sent = REG(IPR) >> 2 & 1;
  stop(receive);
  stop(receive + 1);
  REG(uart + PWREMU) = 0;
  return ended && sent && memcmp(source, target, N) == 0 && target[N] == 0xEE;
}

static void uarts(void) {
  check("events of UART0 move data", uart_moves(UART0, 18, 8));
  check("events of UART1 move data", uart_moves(UART1, 20, 8));
  REG(EVTMUX) = 1u << 3;
  check("no receive events of UART0 while the multiplexer has SPI3", !uart_moves(UART0, 18, 8));
  check("none of its bytes is in memory", target[0] == 0xEE);
  REG(EVTMUX) = 1u << 4;
  check("no transmit events of UART0 while the multiplexer has SPI3", !uart_moves(UART0, 18, 8));
  REG(EVTMUX) = 3u << 3;
  check("UART1 has no multiplexer", uart_moves(UART1, 20, 8));
  REG(EVTMUX) = 0;
  check("UART0 again", uart_moves(UART0, 18, 8));
  check("no events without DMAMODE1", !uart_moves(UART1, 20, 0));
}

/* Three characters are less than the trigger level of four. */
static void uart_levels(void) {
  memset(target, 0xEE, sizeof target);
  uart_loop(UART1, 8 | 1 << 6);
  set(20, AB_SYNC | TCINT | TCC(1), UART1 + THR, PAIR(1, 4), (uintptr_t)target, PAIR(0, 1), 1);
  listen(20);
  REG(UART1 + PWREMU) = 0x6001;
  for (unsigned n = 0; n < 3; ++n) REG(UART1 + THR) = source[n];
  check("a receive event by time-out", done(1, 3000) && memcmp(source, target, 3) == 0);
  stop(20);
  REG(UART1 + PWREMU) = 0;
}

enum { ICSTR = 0x08, ICCNT = 0x14, ICDRR = 0x18, ICSAR = 0x1C, ICDXR = 0x20, ICMDR = 0x24 };

static void i2c_wait(uint32_t flag) {
  for (unsigned n = 0; n < 100000 && !(REG(I2C + ICSTR) & flag); ++n) {
  }
}

/* The decoder's registers 80h and 81h identify it as 5146h. */
static int i2c_identity(void) {
  REG(I2C + ICCNT) = 1;
  REG(I2C + ICDXR) = 0x80;
  REG(I2C + ICMDR) = 0x2620; /* start, master, transmitter */
  i2c_wait(1u << 2);
  REG(I2C + ICCNT) = 2;
  REG(I2C + ICMDR) = 0x2C20; /* start, stop, master, receiver */
  return done(3, 20000);
}

static void i2c(void) {
  REG(PINMUX3) = (REG(PINMUX3) & ~(0xFu << 21)) | 0xAu << 21;
  REG(I2C + ICMDR) = 0;
  REG(I2C + 0x30) = 2;
  REG(I2C + 0x0C) = 5;
  REG(I2C + 0x10) = 5;
  REG(I2C + ICSAR) = 0x5D;
  REG(I2C + ICMDR) = 0x0020;
  memset(target, 0xEE, sizeof target);
  set(28, TCINT | TCC(3), I2C + ICDRR, PAIR(1, 2), (uintptr_t)target, PAIR(0, 1), 1);
  listen(28);
  check("receive events of the I2C move data",
        i2c_identity() && target[0] == 0x51 && target[1] == 0x46 && target[2] == 0xEE);
  stop(28);
  i2c_wait(1u << 5);
  /* Bytes behind the first one by transmit events: register 0Ah and 0Bh, which read back. */
  static const uint8_t words[2] = {0x5A, 0xA5};
  memcpy(source, words, sizeof words);
  set(29, TCINT | TCC(4), (uintptr_t)source, PAIR(1, 2), I2C + ICDXR, PAIR(1, 0), 1);
  listen(29);
  REG(I2C + ICCNT) = 3;
  REG(I2C + ICDXR) = 0x0A;
  REG(I2C + ICMDR) = 0x2E20;
  const int sent = done(4, 20000);
  REG(EECR) = 1u << 29;
  i2c_wait(1u << 5);
  stop(29);
  uint8_t back[2];
  for (unsigned n = 0; n < 2; ++n) {
    REG(I2C + ICCNT) = 1;
    REG(I2C + ICDXR) = 0x0A + n;
    REG(I2C + ICMDR) = 0x2620;
    i2c_wait(1u << 2);
    REG(I2C + ICMDR) = 0x2C20;
    i2c_wait(1u << 3);
    back[n] = (uint8_t)REG(I2C + ICDRR);
    i2c_wait(1u << 5);
  }
  check("transmit events of the I2C move data", sent && memcmp(back, words, 2) == 0);
  REG(I2C + ICMDR) = 0;
}

/* Pins that software drives give events like those that the board drives. */
static int pin_moves(unsigned pin, unsigned channel) {
  memset(target, 0xEE, sizeof target);
  set(channel, TCINT | TCC(5), (uintptr_t)source, PAIR(4, 1), (uintptr_t)target, 0, 1);
  REG(GPIO01 + 0x00) &= ~(1u << pin);
  REG(GPIO01 + 0x0C) = 1u << pin;
  REG(GPIO01 + 0x14) = 1u << pin;
  listen(channel);
  REG(GPIO01 + 0x08) = 1u << pin;
  const int ended = done(5, 300);
  stop(channel);
  REG(GPIO01 + 0x0C) = 1u << pin;
  REG(GPIO01 + 0x18) = 1u << pin;
  return ended && memcmp(source, target, 4) == 0;
}

/* That the events which have arrived are those of one channel, whichever channels are enabled. */
static void forget_events(void) {
  REG(ECR) = ~0u;
  REG(ECR + 4) = ~0u;
}
static int only_event(unsigned channel) {
  const uint32_t low = REG(SHADOW0), high = REG(SHADOW0 + 4); /* ER, ERH */
  return low == (channel < 32 ? 1u << channel : 0) && high == (channel < 32 ? 0 : 1u << (channel - 32));
}

static int pin_is_alone(unsigned pin, unsigned channel) {
  REG(GPIO01 + 0x14) = 1u << pin;
  forget_events();
  REG(GPIO01 + 0x08) = 1u << pin;
  for (unsigned n = 0; n < 20; ++n) (void)REG(SHADOW0);
  const int good = only_event(channel);
  REG(GPIO01 + 0x0C) = 1u << pin;
  REG(GPIO01 + 0x18) = 1u << pin;
  return good;
}

static void pins(void) {
  static const uint8_t channels[16] = {32, 33, 34, 35, 36, 37, 38, 39, 47, 25, 40, 41, 42, 43, 44, 45};
  for (unsigned pin = 0; pin < 16; ++pin) {
    char name[64];
    sprintf(name, "GPIO%u's event moves data", pin);
    check(name, pin_moves(pin, channels[pin]) && pin_is_alone(pin, channels[pin]));
  }
  REG(EVTMUX) = 0x3Fu << 6;
  int silent = 1;
  for (unsigned pin = 10; pin < 16; ++pin) silent &= !pin_moves(pin, 30 + pin);
  check("no events of GPIO10 to 15 while the multiplexer has EMAC and SPI4", silent);
  check("GPIO8 has no multiplexer", pin_moves(8, 47));
  REG(EVTMUX) = 0;
  check("GPIO15 again", pin_moves(15, 45));
}

/* Each timer has two counters: TINT 2n and 2n+1 are those of TIMER n. */
static int timer_moves(uint32_t timer, unsigned upper, unsigned channel) {
  const uint32_t mode = TIMER_TCR + timer, count = TIMER_TIM12 + 4 * upper + timer,
                 period = TIMER_PRD12 + 4 * upper + timer, shift = 6 + 16 * upper;
  memset(target, 0xEE, sizeof target);
  REG(timer + TIMER_TGCR) = 0;
  REG(timer + TIMER_TGCR) = 7; /* two counters of 32 bits, out of reset */
  REG(count) = 0;
  REG(period) = 240; /* 10 us */
  set(channel, TCINT | TCC(5), (uintptr_t)source, PAIR(4, 3), (uintptr_t)target, PAIR(4, 4), 1);
  listen(channel);
  REG(mode) = 2u << shift;
  const int ended = done(5, 2000);
  REG(mode) = 0;
  stop(channel);
  const int moved = ended && memcmp(source, target, 12) == 0 && target[12] == 0xEE;
  forget_events();
  REG(count) = 0;
  REG(mode) = 1u << shift; /* once */
  for (unsigned n = 0; n < 300; ++n) (void)REG(count);
  const int alone = only_event(channel);
  REG(mode) = 0;
  forget_events();
  return moved && alone;
}

static void timers(void) {
  static const uint32_t bases[5] = {0x01C21400, 0x01C21800, 0x01C21C00, 0x01C20800, 0x01C23800};
  static const uint8_t channels[10] = {48, 49, 50, 51, 8, 9, 0, 1, 22, 23}; /* of TINT0 to TINT9 */
  for (unsigned n = 0; n < 10; ++n) {
    char name[64];
    sprintf(name, "the event of TINT%u moves data", n);
    check(name, timer_moves(bases[n / 2], n % 2, channels[n]));
  }
}

/* Channels whose source is not modelled; one is of the second source of the multiplexer. */
static void silent_sources(void) {
  REG(EESR) = 1u << 26 | 1u << 28;
  REG(EVTMUX) = 1u << 11;
  REG(EESR + 4) = 1u << (45 - 32) | 1u << (52 - 32);
  REG(EVTMUX) = 0;
  REG(EECR) = 1u << 26 | 1u << 28;
  REG(EECR + 4) = 1u << (45 - 32) | 1u << (52 - 32);
}

/* The encoder's interrupt, source 21, comes once a field; source 0, the capture's, does not come. */
static int field_moves(unsigned channel, uint32_t selection) {
  memset(target, 0xEE, sizeof target);
  REG(VPSS + 0x1C) = selection;
  set(channel, TCINT | TCC(6), (uintptr_t)source, PAIR(4, 1), (uintptr_t)target, 0, 1);
  listen(channel);
  const int ended = done(6, 400000);
  stop(channel);
  return ended && memcmp(source, target, 4) == 0;
}

static void video(void) {
  REG(SYSTEM + 0x44) = 0x18;
  REG(VPSS + 0x200) |= 1;
  REG(VENC + 0x140) = 1;
  REG(VENC + 0x00) = 3;
  static const char *const names[] = {"VPSS_EVT1", "VPSS_EVT2", "VPSS_EVT3", "VPSS_EVT4"};
  for (unsigned n = 0; n < 4; ++n) {
    char name[64];
    sprintf(name, "the encoder's event as %s moves data", names[n]);
    check(name, field_moves(4 + n, 0x1F1F1F1Fu ^ (21u ^ 31u) << 8 * n));
  }
  check("VPSS_EVT1 is the capture's after reset", !field_moves(4, 0));
  REG(VENC + 0x00) = 0;
}

enum { ACNT = 100, BCNT = 300, SBIDX = 120, DBIDX = 130 };

/* Bytes left by a count register, and the address and the array's start that belong to so many. */
static unsigned left_of(uint32_t count) {
  return count ? ((count >> 16) - 1) * ACNT + (count & 0xFFFF) : 0;
}
static uintptr_t start_of(unsigned left, uintptr_t base, unsigned index) {
  const unsigned arrays = (left + ACNT - 1) / ACNT;
  return base + (arrays ? BCNT - arrays : BCNT - 1u) * index;
}
static uintptr_t address_of(unsigned left, uintptr_t base, unsigned index) {
  const unsigned arrays = (left + ACNT - 1) / ACNT;
  return start_of(left, base, index) + ACNT - (arrays ? left - (arrays - 1) * ACNT : 0);
}

/* One look at a side: count, address and start, and the count again, between which the other two must be.
 * `before`: bytes left at the end of the look before. */
static int look(uint32_t count, uint32_t address, uint32_t start, uintptr_t base, unsigned index,
                unsigned *before) {
  const unsigned first = left_of(REG(count));
  const uint32_t place = REG(address), begin = REG(start);
  const unsigned last = left_of(REG(count));
  const int good = first <= *before && last <= first && address_of(first, base, index) <= place &&
                   place <= address_of(last, base, index) && start_of(first, base, index) <= begin &&
                   begin <= start_of(last, base, index);
  *before = last;
  return good;
}

/* 32 clocks between two reads, so that the program sees the transfer under way: TC0 reads SDRAM in commands of
 * 32 bytes. */
static void register_sets(void) {
  const uintptr_t from = (uintptr_t)source, to = (uintptr_t)target;
  REG(CC + 0x284) = 0x5555; /* QUEPRI */
  REG(TC0 + 0x140) = 4;
  const uint32_t slot = REG(TC0 + 0x100) >> 12 & 3;
  set(2, AB_SYNC | TCINT | TCC(7), from, PAIR(ACNT, BCNT), to, PAIR(SBIDX, DBIDX), 1);
  REG(ESR) = 4;
  for (unsigned n = 0; n < 100 && !(REG(TC0 + 0x100) & 2); ++n) {
  }
  const uint32_t df = TC0 + 0x300 + 0x40 * slot;
  int read_good = 1, written_good = 1;
  unsigned unread = ACNT * BCNT, unwritten = ACNT * BCNT, looks = 0;
  for (unsigned n = 0; n < 10000 && !(REG(IPR) >> 7 & 1); ++n) {
    const unsigned before = unread;
    read_good &= look(TC0 + 0x248, TC0 + 0x244, TC0 + 0x25C, from, SBIDX, &unread);
    looks += unread && unread < before;
    written_good &= look(df + 0x8, df + 0xC, TC0 + 0x288, to, DBIDX, &unwritten);
    written_good &= unwritten >= left_of(REG(TC0 + 0x248));
  }
  REG(ICR) = 1u << 7;
  const uint32_t options = 5u << 4 | 7u << 12 | TCINT, index = PAIR(SBIDX, DBIDX);
  check("the source active shows what is read", read_good && looks > 5);
  check("the destination register shows what is written", written_good);
  check("at the end nothing is left",
        REG(TC0 + 0x248) == 0 && REG(df + 0x8) == 0 && REG(TC0 + 0x25C) == from + (BCNT - 1) * SBIDX &&
            REG(TC0 + 0x244) == from + (BCNT - 1) * SBIDX + ACNT && REG(df + 0xC) == to + (BCNT - 1) * DBIDX + ACNT);
  check("options, indices and reload values",
        REG(TC0 + 0x240) == options && REG(df) == options && REG(TC0 + 0x200) == options &&
            REG(TC0 + 0x250) == index && REG(df + 0x10) == index && REG(TC0 + 0x210) == index &&
            REG(TC0 + 0x258) == ACNT && REG(TC0 + 0x280) == ACNT);
  check("the program register",
        REG(TC0 + 0x204) == from && REG(TC0 + 0x208) == PAIR(ACNT, BCNT) && REG(TC0 + 0x20C) == to);
  check("what does not apply is 0", REG(TC0 + 0x24C) == 0 && REG(TC0 + 0x260) == 0 && REG(df + 0x4) == 0 &&
                                        REG(TC0 + 0x284) == 0 && REG(df + 0x14) == 0);
  check("the next request has the next destination register",
        (REG(TC0 + 0x100) >> 12 & 3) == ((slot + 1) & 3));
  REG(TC0 + 0x140) = 0;
}

static void enable_instruction_cache(void) {
  uint32_t control;
  __asm__ volatile("mrc p15, 0, %0, c1, c0, 0" : "=r"(control));
  __asm__ volatile("mcr p15, 0, %0, c1, c0, 0" ::"r"(control | 1u << 12));
}

int main(void) {
  enable_instruction_cache(); /* or else a transfer is over before the program has looked twice */
  for (unsigned module = 0; module < 5; ++module) enable(module);
  static const unsigned modules[] = {5, 17, 18, 19, 20, 26, 27, 28, 47}; /* timers, I2C, UARTs, GPIO, VPSS */
  for (unsigned n = 0; n < sizeof modules / sizeof *modules; ++n) enable(modules[n]);
  for (unsigned i = 0; i < sizeof source; ++i) source[i] = (uint8_t)(i * 7 + (i >> 8) + 1);
  REG(BINTEN) = 1;
  REG(DRAE0) = ~0u;
  REG(DRAE0 + 4) = ~0u;
  REG(IESR) = 0xFF;
  REG(VPSS + 0x1C) = 0x1F1F1F1F;
  set(DUMMY, 0, 0, PAIR(1, 0), 0, 0, 1);
  uarts();
  uart_levels();
  i2c();
  pins();
  timers();
  silent_sources();
  video();
  register_sets();
  check("no event was missed", missed == 0 && REG(EMR) == 0 && REG(EMR + 4) == 0);
  return failures;
}
