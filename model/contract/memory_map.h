/* Where the memories of the board lie: one declaration for the model, the host program and its debugger, the
 * firmware's C and assembly, and the firmware's linker script (preprocessed with LINKER_SCRIPT defined).
 * Registers are not here: model/soc/dm365_blocks.cpp places the blocks. */
#ifndef FOVEA_CONTRACT_MEMORY_MAP_H
#define FOVEA_CONTRACT_MEMORY_MAP_H

#if defined(__ASSEMBLER__) || defined(LINKER_SCRIPT)
#define MAP_WORD(x) x
#else
#define MAP_WORD(x) x##u
#endif

/* The chip (TI boot loader for the DM36x). The core reaches one RAM at two addresses. */
#define INTERNAL_RAM_BASE MAP_WORD(0x00000000)
#define INTERNAL_RAM_DATA_BASE MAP_WORD(0x00010000)
#define INTERNAL_RAM_BYTES MAP_WORD(0x8000)
#define DDR_BASE MAP_WORD(0x80000000)

/* Use of the internal RAM at the start, as offsets that hold at both of its addresses. */
#define BOOT_BYTES MAP_WORD(0x4000) /* vectors and code that runs before DDR2 does */
#define PARAM_PAGE_BASE MAP_WORD(0x4000)
#define PARAM_PAGE_BYTES MAP_WORD(0x3000)
#define BOOT_STACKS_BASE MAP_WORD(0x7000)
#define BOOT_STACK_TOP MAP_WORD(0x7C00)
#define EXCEPTION_STACK_TOP MAP_WORD(0x8000)

/* Use of DDR2 by the firmware: the 16 MiB of the paper's board. */
#define FIRMWARE_DDR_BYTES MAP_WORD(0x01000000)
#define PAGE_TABLE_BASE MAP_WORD(0x80004000) /* 16 KiB, aligned to its size */
#define PROGRAM_BASE MAP_WORD(0x80008000)    /* also of programs that are linked for this board */
#define UNCACHED_BASE MAP_WORD(0x80F00000)   /* variables that a debugger may read at any time */
#define UNCACHED_BYTES MAP_WORD(0x00100000)

#endif
