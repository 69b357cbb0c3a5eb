#include "support.h"

extern uint32_t options;
extern const uint8_t high_vectors[];

void program(void);

uint32_t *level1(uint32_t va) { return (uint32_t *)kTables + (va >> 20); }

uint32_t cached(void) { return options ? 0xC : 0; }

uint32_t control(void) {
  uint32_t v;
  __asm__ volatile("mrc p15, 0, %0, c1, c0, 0" : "=r"(v));
  return v;
}
void set_control(uint32_t v) { __asm__ volatile("mcr p15, 0, %0, c1, c0, 0" ::"r"(v) : "memory"); }
void set_domains(uint32_t v) { __asm__ volatile("mcr p15, 0, %0, c3, c0, 0" ::"r"(v) : "memory"); }
void set_pid(uint32_t v) { __asm__ volatile("mcr p15, 0, %0, c13, c0, 0" ::"r"(v) : "memory"); }
void set_table(uint32_t v) { __asm__ volatile("mcr p15, 0, %0, c2, c0, 0" ::"r"(v) : "memory"); }
void drop_entry(uint32_t va) { __asm__ volatile("mcr p15, 0, %0, c8, c7, 1" ::"r"(va) : "memory"); }
void clear_status(void) {
  __asm__ volatile(
      "mcr p15, 0, %0, c5, c0, 0\n mcr p15, 0, %0, c5, c0, 1\n mcr p15, 0, %0, c6, c0, 0" ::"r"(0)
      : "memory");
}

void refresh(void) {
  __asm__ volatile(
      "1: mrc p15, 0, r15, c7, c14, 3\n bne 1b\n mcr p15, 0, %0, c7, c10, 4\n"
      "mcr p15, 0, %0, c7, c5, 0\n mcr p15, 0, %0, c8, c7, 0" ::"r"(0)
      : "memory", "cc");
}

void mmu_on(void) {
  for (uint32_t s = 0; s < 4096; ++s) *level1(s << 20) = 0;
  // RAM; sections from the tables on (4 to 7) are never cached, nor are the test pages behind.
  for (uint32_t s = 0; s < 32; ++s)
    *level1(s << 20) = s << 20 | 0xC12u | (s < 4 || s >= 16 ? cached() : 0);
  *level1(0x10100000) = 0x10100000u | 0xC12u;
  uint32_t *coarse = (uint32_t *)(kTables + 0x4000);
  for (unsigned k = 0; k < 256; ++k) coarse[k] = 0;
  coarse[0xF0] = ((uint32_t)high_vectors & ~0xFFFu) | 0xFF2u | cached();
  *level1(0xFFF00000) = (uint32_t)coarse | 0x11u;
  set_table(kTables);
  set_domains(1);
  refresh();
  set_control(control() | 1u | (options & 1 ? 0x1000u : 0) | (options & 2 ? 4u : 0));
}

/// Text of a name with up to three hexadecimal numbers; each text has a place of its own.
const char *name3(const char *head, uint32_t a, uint32_t b, uint32_t c) {
  static char pool[1 << 18];
  static char *next = pool;
  char *const begin_ = next;
  while (*head) *next++ = *head++;
  const uint32_t v[3] = {a, b, c};
  for (unsigned k = 0; k < 3; ++k) {
    *next++ = ' ';
    int shift = 28;
    while (shift > 0 && (v[k] >> shift) == 0) shift -= 4;
    for (; shift >= 0; shift -= 4) *next++ = "0123456789abcdef"[v[k] >> shift & 15];
  }
  *next++ = 0;
  return begin_;
}
