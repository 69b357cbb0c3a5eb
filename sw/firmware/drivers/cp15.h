/* Caches, write buffer and sleep of the ARM926EJ-S. */
#ifndef FOVEA_FIRMWARE_CP15_H
#define FOVEA_FIRMWARE_CP15_H

#include <stdint.h>

#define CACHE_LINE_BYTES 32u
#define DCACHE_BYTES 8192u

/** Fills the page table at PAGE_TABLE_BASE and turns MMU and both caches on. Sections of 1 MiB:
 * internal RAM and devices uncached, unbuffered; DDR2 cached, write-back, except its last MiB
 * (UNCACHED_BASE); everything else faults. Call once, with caches off. */
void mmu_enable(void);

/** Waits until write buffer and victim buffer are empty. */
static inline void write_buffer_drain(void) {
  __asm__ volatile("mcr p15, 0, %0, c7, c10, 4" : : "r"(0) : "memory");
}

/** Writes every dirty D line back (test-and-clean; at most 256 lines), lines stay valid. */
static inline void dcache_clean_all(void) {
  __asm__ volatile("1: mrc p15, 0, r15, c7, c10, 3\n\tbne 1b" : : : "cc", "memory");
  write_buffer_drain();
}

/** Writes every dirty D line back and empties the D cache. */
static inline void dcache_clean_invalidate_all(void) {
  __asm__ volatile("1: mrc p15, 0, r15, c7, c14, 3\n\tbne 1b" : : : "cc", "memory");
  write_buffer_drain();
}

/** Makes memory hold what the core wrote to [start, start + bytes). By line for a range smaller
 * than the cache; else test-and-clean over the whole cache, which is then cheaper (256 lines
 * against 25,920 of a PAL frame). */
void dcache_clean_range(const void *start, uint32_t bytes);

/** Makes the next reads of [start, start + bytes) come from memory. `start` and `bytes` are line
 * aligned. Large ranges: clean and invalidate the whole cache, as above. */
void dcache_invalidate_range(const void *start, uint32_t bytes);

/** Makes instruction fetches from [start, start + bytes) see memory. */
void icache_invalidate_range(const void *start, uint32_t bytes);

/** Sleeps until an interrupt is pending, masked or not. */
static inline void wait_for_interrupt(void) {
  __asm__ volatile("mcr p15, 0, %0, c7, c0, 4" : : "r"(0) : "memory");
}

/** Masks IRQ; returns the CPSR before, for irq_restore(). */
static inline uint32_t irq_mask(void) {
  uint32_t cpsr;
  __asm__ volatile("mrs %0, cpsr\n\torr r12, %0, #0x80\n\tmsr cpsr_c, r12"
                   : "=r"(cpsr)
                   :
                   : "r12", "memory");
  return cpsr;
}

static inline void irq_restore(uint32_t cpsr) {
  __asm__ volatile("msr cpsr_c, %0" : : "r"(cpsr) : "memory");
}

static inline void irq_unmask(void) {
  uint32_t scratch;
  __asm__ volatile("mrs %0, cpsr\n\tbic %0, %0, #0x80\n\tmsr cpsr_c, %0"
                   : "=r"(scratch)
                   :
                   : "memory");
}

#endif
