/* Caches, write buffer and sleep mode of the ARM926EJ-S. */
#ifndef FOVEA_FIRMWARE_CP15_H
#define FOVEA_FIRMWARE_CP15_H

#include <stdint.h>

#define CACHE_LINE_BYTES 32u
#define DCACHE_BYTES 8192u

/** Fills the page table at PAGE_TABLE_BASE and enables MMU and both caches. Sections of 1 MiB:
 * internal RAM and devices are uncached and unbuffered (and see POSTED_BASE); DDR2 is cached and
 * write-back, except for its last MiB (UNCACHED_BASE); everything else causes an abort. To be
 * called once, with caches disabled. */
void mmu_enable(void);

/** Registers of the first MiB at DEVICE_BASE can also be written at this address: such a write goes
 * through the write buffer, in order with others, and the core goes on at once. Only for registers
 * that may be written late; read them at their own address. */
#define DEVICE_BASE 0x01C00000u
#define POSTED_BASE 0x01E00000u
static inline uint32_t posted_address(uint32_t address) {
  return address - DEVICE_BASE + POSTED_BASE;
}

/** Waits until the write buffer and the victim buffer are empty. */
static inline void write_buffer_drain(void) {
  __asm__ volatile("mcr p15, 0, %0, c7, c10, 4" : : "r"(0) : "memory");
}

/** Writes back every dirty line of the D-cache (test and clean, at most 256 lines); lines stay
 * valid. */
static inline void dcache_clean_all(void) {
  __asm__ volatile("1: mrc p15, 0, r15, c7, c10, 3\n\tbne 1b" : : : "cc", "memory");
  write_buffer_drain();
}

/** Writes back every dirty line of the D-cache and invalidates the D-cache. */
static inline void dcache_clean_invalidate_all(void) {
  __asm__ volatile("1: mrc p15, 0, r15, c7, c14, 3\n\tbne 1b" : : : "cc", "memory");
  write_buffer_drain();
}

/** Writes back what the core wrote to [start, start + bytes). A range smaller than the cache is
 * cleaned line by line. For others the whole cache is tested and cleaned, which is cheaper (256
 * lines instead of the 25,920 lines of a PAL frame). */
void dcache_clean_range(const void *start, uint32_t bytes);

/** Discards cached copies of [start, start + bytes), so that the next reads come from memory.
 * `start` and `bytes` must be multiples of a cache line. Large ranges: the whole cache is cleaned
 * and invalidated. */
void dcache_invalidate_range(const void *start, uint32_t bytes);

/** Makes instruction fetches from [start, start + bytes) read memory again. */
void icache_invalidate_range(const void *start, uint32_t bytes);

/** Sleeps until an interrupt is pending, even if masked. */
#ifdef FOVEA_HOST_TEST /* what comes meanwhile is the test's */
void wait_for_interrupt(void);
uint32_t irq_mask(void);
void irq_restore(uint32_t cpsr);
#else
static inline void wait_for_interrupt(void) {
  __asm__ volatile("mcr p15, 0, %0, c7, c0, 4" : : "r"(0) : "memory");
}

/** Masks IRQ. Returns the previous CPSR for irq_restore(). */
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

#endif

static inline void irq_unmask(void) {
  uint32_t scratch;
  __asm__ volatile("mrs %0, cpsr\n\tbic %0, %0, #0x80\n\tmsr cpsr_c, %0"
                   : "=r"(scratch)
                   :
                   : "memory");
}

#endif
