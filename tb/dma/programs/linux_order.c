/* A copy of 16 KiB by channel 40 with the register accesses of a public driver in their order: probe, allocation of
 * the channel, transfer, interrupt (Linux 6.1 drivers/dma/ti/edma.c with the platform data of
 * arch/arm/mach-davinci/dm365.c, without a device tree). linux_order.txt is what Linux itself does. Registers only;
 * nothing else of the EDMA is touched in between. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define REG(address) (*(volatile uint32_t *)(address))
enum {
  CC = 0x01C00000,
  CCCFG = CC + 0x004,
  DMAQNUM = CC + 0x240,
  QUEPRI = CC + 0x284,
  EMCR = CC + 0x308,
  DRAE0 = CC + 0x340,
  QRAE0 = CC + 0x380,
  SHADOW0 = CC + 0x2000,
  ECR = SHADOW0 + 0x08,
  ESR = SHADOW0 + 0x10,
  EECR = SHADOW0 + 0x28,
  SECR = SHADOW0 + 0x40,
  IER = SHADOW0 + 0x50,
  IESR = SHADOW0 + 0x60,
  IPR = SHADOW0 + 0x68,
  ICR = SHADOW0 + 0x70,
  IEVAL = SHADOW0 + 0x78,
  SETS = CC + 0x4000,
  PSC = 0x01C41000,
  IRQ0 = 0x01C48008,
  EINT0 = 0x01C48018,
};
enum { CHANNEL = 40, HIGH = 4, BIT = 1 << (CHANNEL - 32), DUMMY = 64, CCINT0 = 1 << 16, BYTES = 16384 };

static uint8_t source[BYTES] __attribute__((aligned(64)));
static uint8_t target[BYTES] __attribute__((aligned(64)));

static void enable(unsigned module) {
  REG(PSC + 0xA00 + 4 * module) = (REG(PSC + 0xA00 + 4 * module) & ~0x1Fu) | 3;
  REG(PSC + 0x120) = 1;
  while (REG(PSC + 0x128) & 1) {
  }
}

static void modify(uint32_t address, uint32_t keep, uint32_t bits) {
  const uint32_t value = REG(address);
  REG(address) = (value & keep) | bits;
}

static void write_set(unsigned n, const uint32_t words[8]) {
  for (unsigned w = 0; w < 8; ++w) REG(SETS + 32 * n + 4 * w) = words[w];
}

/* One array of one byte count 0: nothing is moved. */
static const uint32_t kDummy[8] = {0, 0, 0, 0, 0, 0xFFFF, 0, 1};

static void assign_queue(unsigned channel) {
  const unsigned shift = channel % 8 * 4;
  modify(DMAQNUM + channel / 8 * 4, ~(7u << shift), 3u << shift);
}

static void stop(void) {
  REG(EECR + HIGH) = BIT;
  REG(ECR + HIGH) = BIT;
  REG(SECR + HIGH) = BIT;
  REG(EMCR + HIGH) = BIT;
  REG(ICR + HIGH) = BIT;
}

static void probe(void) {
  static const uint8_t priority[4] = {7, 7, 7, 0};
  const uint32_t config = REG(CCCFG);
  const unsigned channels = 1u << ((config & 7) + 1), sets = 16u << (config >> 12 & 7);
  for (unsigned n = 0; n < sets; ++n) write_set(n, kDummy);
  write_set(DUMMY, kDummy);
  for (unsigned q = 0; q < 4; ++q) modify(QUEPRI, ~(7u << 4 * q), (uint32_t)priority[q] << 4 * q);
  REG(DRAE0) = 0;
  REG(DRAE0 + HIGH) = 0;
  REG(QRAE0) = 0;
  for (unsigned n = 0; n < channels; ++n) assign_queue(n);
}

static void allocate(void) {
  modify(DRAE0 + HIGH, ~0u, BIT);
  stop();
  REG(ICR + HIGH) = BIT;
  REG(IESR + HIGH) = BIT;
  assign_queue(CHANNEL);
  write_set(CHANNEL, kDummy);
}

static void copy(void) {
  const uint32_t words[8] = {1u << 23 | 1u << 20 | CHANNEL << 12, /* ITCCHEN, TCINTEN */
                             (uint32_t)source,
                             1u << 16 | BYTES,
                             (uint32_t)target,
                             (uint32_t)BYTES << 16 | BYTES,
                             ~0u,
                             (uint32_t)BYTES << 16 | BYTES,
                             1};
  write_set(CHANNEL, words);
  modify(SETS + 32 * CHANNEL + 0x14, 0xFFFF0000u, 0x4000 + 32 * DUMMY);
  REG(ESR + HIGH) = BIT;
}

static int interrupt(void) {
  if (REG(IPR) != 0) return 0;
  const uint32_t pending = REG(IPR + HIGH);
  const uint32_t enabled = REG(IER + HIGH);
  REG(ICR + HIGH) = BIT;
  stop();
  REG(IEVAL) = 1;
  return pending == BIT && enabled == BIT;
}

int main(void) {
  for (unsigned module = 0; module < 5; ++module) enable(module);
  for (unsigned i = 0; i < BYTES; ++i) source[i] = (uint8_t)(i * 7 + (i >> 8) + 1);
  REG(IRQ0) = CCINT0;
  REG(EINT0) = CCINT0;
  probe();
  allocate();
  copy();
  unsigned looks = 0;
  while (REG(IRQ0) & CCINT0 && ++looks < 100000) {
  }
  const int good = looks < 100000 && interrupt() && memcmp(source, target, BYTES) == 0;
  printf("a copy as Linux does it: %s\n", good ? "good" : "BAD");
  return !good;
}
