/* Where things lie in the target's memory; firmware.ld holds the same figures and asserts them. */
#ifndef FOVEA_FIRMWARE_MEMORY_MAP_H
#define FOVEA_FIRMWARE_MEMORY_MAP_H

#define INTERNAL_RAM_BASE 0x00000000u
#define INTERNAL_RAM_BYTES 0x8000u
#define DDR_BASE 0x80000000u
#define DDR_BYTES 0x01000000u       /* the paper's 16 MB board */
#define PARAM_PAGE_BASE DDR_BASE    /* 4 KiB, filled by the host or the loader */
#define PAGE_TABLE_BASE 0x80004000u /* 16 KiB, aligned to its size */
#define UNCACHED_BASE 0x80F00000u   /* last MiB: variables that a debugger reads in passing */
#define UNCACHED_BYTES 0x00100000u

#endif
