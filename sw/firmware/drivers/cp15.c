#include "cp15.h"

#include "model/contract/memory_map.h"

#define SECTION 0xC12u /* section, full access, domain 0, uncached and unbuffered */
#define SECTION_BUFFERED (SECTION | 0x4u)
#define SECTION_CACHED (SECTION | 0xCu)
#define CONTROL_M 0x0001u
#define CONTROL_C 0x0004u
#define CONTROL_I 0x1000u

static void map(uint32_t *table, uint32_t base, uint32_t bytes, uint32_t attributes) {
  for (uint32_t address = base; address - base < bytes; address += 0x100000u)
    table[address >> 20] = (address & 0xFFF00000u) | attributes;
}

void mmu_enable(void) {
  uint32_t *table = (uint32_t *)PAGE_TABLE_BASE;
  for (uint32_t i = 0; i < 4096; ++i) table[i] = 0;
  map(table, 0x00000000u, 0x00100000u, SECTION);
  map(table, DEVICE_BASE, 0x00200000u, SECTION);
  table[POSTED_BASE >> 20] = DEVICE_BASE | SECTION_BUFFERED;
  map(table, 0x20000000u, 0x00100000u, SECTION);
  map(table, DDR_BASE, FIRMWARE_DDR_BYTES - UNCACHED_BYTES, SECTION_CACHED);
  map(table, UNCACHED_BASE, UNCACHED_BYTES, SECTION);

  uint32_t control;
  __asm__ volatile(
      "mcr p15, 0, %1, c2, c0, 0\n\t" /* table */
      "mcr p15, 0, %2, c3, c0, 0\n\t" /* domain 0: permissions are checked */
      "mcr p15, 0, %3, c8, c7, 0\n\t" /* invalidate TLB */
      "mcr p15, 0, %3, c7, c7, 0\n\t" /* invalidate caches */
      "mrc p15, 0, %0, c1, c0, 0"
      : "=&r"(control)
      : "r"(PAGE_TABLE_BASE), "r"(1), "r"(0)
      : "memory");
  control |= CONTROL_M | CONTROL_C | CONTROL_I;
  __asm__ volatile("mcr p15, 0, %0, c1, c0, 0\n\tnop\n\tnop" : : "r"(control) : "memory");
}

void dcache_clean_range(const void *start, uint32_t bytes) {
  if (bytes >= DCACHE_BYTES) {
    dcache_clean_all();
    return;
  }
  const uint32_t end = (uint32_t)start + bytes;
  for (uint32_t line = (uint32_t)start & ~(CACHE_LINE_BYTES - 1); line < end;
       line += CACHE_LINE_BYTES)
    __asm__ volatile("mcr p15, 0, %0, c7, c10, 1" : : "r"(line) : "memory");
  write_buffer_drain();
}

void dcache_invalidate_range(const void *start, uint32_t bytes) {
  if (bytes >= DCACHE_BYTES) {
    dcache_clean_invalidate_all();
    return;
  }
  const uint32_t end = (uint32_t)start + bytes;
  for (uint32_t line = (uint32_t)start; line < end; line += CACHE_LINE_BYTES)
    __asm__ volatile("mcr p15, 0, %0, c7, c6, 1" : : "r"(line) : "memory");
}

void icache_invalidate_range(const void *start, uint32_t bytes) {
  const uint32_t end = (uint32_t)start + bytes;
  for (uint32_t line = (uint32_t)start & ~(CACHE_LINE_BYTES - 1); line < end;
       line += CACHE_LINE_BYTES)
    __asm__ volatile("mcr p15, 0, %0, c7, c5, 1" : : "r"(line) : "memory");
}
