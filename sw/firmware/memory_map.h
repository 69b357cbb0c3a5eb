/* Memory map of the target. firmware.ld contains the same figures and checks them. */
#ifndef FOVEA_FIRMWARE_MEMORY_MAP_H
#define FOVEA_FIRMWARE_MEMORY_MAP_H

#define INTERNAL_RAM_BASE 0x00000000u
#define INTERNAL_RAM_BYTES 0x8000u
#define DDR_BASE 0x80000000u
#define DDR_BYTES 0x01000000u       /* memory of the paper's board, 16 MB */
#define PARAM_PAGE_BASE DDR_BASE    /* 4 KiB, written by the host or the loader */
#define PAGE_TABLE_BASE 0x80004000u /* 16 KiB, aligned to its size */
#define UNCACHED_BASE 0x80F00000u   /* last MiB: variables that a debugger may read at any time */
#define UNCACHED_BYTES 0x00100000u

#endif
