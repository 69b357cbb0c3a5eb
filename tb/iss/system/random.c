// The environment of a random privileged program: ten megabytes of pages of every kind, each in a
// domain of its own, and a checksum of their contents at the end.
#include "support.h"

enum { kRegions = 10 };

void random_done(void);

static volatile uint8_t *physical(unsigned region) {
  return (volatile uint8_t *)(kTestPa + region * 0x100000u);
}

/// Bytes of a region that the random code may reach; large pages need more of them.
static unsigned bytes(unsigned region) { return region == 5 ? 0x21000u : 0x9000u; }

/// AP of a page's quarter: all four values, none of them always beside the same.
static uint32_t ap_of(unsigned page, unsigned quarter) { return (page * 5 / 2 + quarter * 3) & 3; }

/// C and B of a page: every kind if caches are on. What is fetched from is cached.
static uint32_t kind_of(unsigned region, unsigned page) {
  return region == 8 ? cached() : ((region + page) << 2) & cached();
}

void random_prepare(void) {
  mmu_on();
  uint32_t *coarse = (uint32_t *)(kTables + 0x5000), *fine = (uint32_t *)(kTables + 0x8000);
  for (unsigned k = 0; k < kRegions; ++k) {
    const uint32_t pa = (uint32_t)physical(k), domain = (k + 1) << 5;
    uint32_t *l1 = level1(kTestVa + k * 0x100000u);
    if (k == 7) continue;  // absent
    if (k < 4) {
      *l1 = pa | (3 - k) << 10 | domain | 0x12u | kind_of(k, 0);
      continue;
    }
    if (k == 6) {
      for (unsigned n = 0; n < 1024; ++n)
        fine[n] = (pa + n * 0x400u) | ap_of(n, n >> 4) << 4 | 3u | kind_of(k, n);
      *l1 = (uint32_t)fine | domain | 0x13u;
      continue;
    }
    for (unsigned n = 0; n < 256; ++n) {
      uint32_t ap = 0;
      for (unsigned q = 0; q < 4; ++q) ap |= ap_of(k == 5 ? n >> 4 : n, q) << (4 + 2 * q);
      if (k == 5)
        coarse[n] = (pa + (n & ~15u) * 0x1000u) | ap | 1u | kind_of(k, n >> 4);
      else if (k == 9 && n % 3 == 1)  // domain 15 stays client: QEMU checks it first
        coarse[n] = 0;
      else
        coarse[n] = (pa + n * 0x1000u) | ap | 2u | kind_of(k, n);
    }
    *l1 = (uint32_t)coarse | (k == 9 ? 15u << 5 : domain) | 0x11u;
    coarse += 256;
  }
  for (unsigned k = 0; k < kRegions; ++k)
    for (unsigned n = 0; n < bytes(k); n += 4)
      // Region 8 is for fetches: mov pc, lr.
      *(volatile uint32_t *)(physical(k) + n) = k == 8 ? 0xE1A0F00Eu : (n + k) * 0x9E3779B1u;
  set_domains(0x55555555u);
  refresh();
  *(volatile uint32_t *)0x001FFFFCu = (uint32_t)random_done;
  refresh();
}

void random_check(void) {
  refresh();
  for (unsigned k = 0; k < kRegions; ++k) {
    begin(name3("memory", k, 0, 0));
    for (unsigned n = 0; n < bytes(k); n += 0x1000u) {
      uint32_t sum = 0;
      for (unsigned m = 0; m < 0x1000u; m += 4)
        sum = (sum << 7 | sum >> 25) ^ *(volatile uint32_t *)(physical(k) + n + m);
      note(sum, n, k, 0);
    }
  }
}
