/* What a remap method may use of the internal RAM after the start, when parameter page and boot
 * stack are no longer needed: everything from RAM_WORK_BASE to RAM_WORK_END. Below it are vectors
 * and boot code, which the handlers still use (the linker script asserts that they end there),
 * above it the exception stack. The methods share this memory: what one of them needs it loads in
 * each run(). After a reset a loader has to bring the parameter page again.
 *
 * The RAM has two banks of 16 KiB; core and EDMA do not wait for each other in different banks.
 * Addresses are those of the core's data accesses; for the EDMA see internal_ram_offset(). */
#ifndef FOVEA_FIRMWARE_INTERNAL_RAM_H
#define FOVEA_FIRMWARE_INTERNAL_RAM_H

#include "model/contract/memory_map.h"

#define RAM_BOOT_END MAP_WORD(0x1000) /* offset in the RAM; the boot code ends before it */
#define RAM_BANK_BYTES MAP_WORD(0x4000)

#define RAM_WORK_BASE (INTERNAL_RAM_DATA_BASE + RAM_BOOT_END)
#define RAM_WORK_END (INTERNAL_RAM_DATA_BASE + BOOT_STACK_TOP)

/* The same by banks: 12 KiB and 15 KiB. */
#define RAM_BANK0_BASE RAM_WORK_BASE
#define RAM_BANK0_END (INTERNAL_RAM_DATA_BASE + RAM_BANK_BYTES)
#define RAM_BANK1_BASE RAM_BANK0_END
#define RAM_BANK1_END RAM_WORK_END

#if !defined(__ASSEMBLER__) && !defined(LINKER_SCRIPT)
#include <stdint.h>

/** Offset in the internal RAM of an address of the core's data accesses. */
static inline uint32_t internal_ram_offset(const void *address) {
  return (uint32_t)(uintptr_t)address - INTERNAL_RAM_DATA_BASE;
}
#endif

#endif
