/* State of the firmware for a host that reads target memory by symbol names. */
#ifndef FOVEA_FIRMWARE_STATE_H
#define FOVEA_FIRMWARE_STATE_H

#include <stdint.h>

#include "model/contract/param_page.h"

#define FW_STATE_MAGIC 0x53574656u /* bytes "VFWS" */
#define FW_STATE_VERSION 2u

#define FRAME_WIDTH_MAX 720u
#define FRAME_HEIGHT_MAX 576u
#define LUT_ENTRIES_MAX (FRAME_WIDTH_MAX / 2u * FRAME_HEIGHT_MAX)
/* A frame and a cache line with the black word, rounded up to whole pages. */
#define FRAME_STRIDE_MAX ((FRAME_WIDTH_MAX * 2u * FRAME_HEIGHT_MAX + 32u + 4095u) & ~4095u)

/* As many sources as there are tables, one frame that waits and one that is being captured. */
#ifndef TABLES_MAX
#define TABLES_MAX PARAM_TABLES_MAX
#endif
#ifndef IN_COUNT
#define IN_COUNT (PARAM_TABLES_MAX + 2u)
#endif
#ifndef OUT_COUNT
#define OUT_COUNT 4u
#endif

/** Consists of words only. Located in uncached memory, so that memory always holds the current
 * values. */
typedef struct fw_state {
  uint32_t magic;   /* FW_STATE_MAGIC, written last during start-up */
  uint32_t version; /* FW_STATE_VERSION */
  uint32_t width, height, pitch_bytes;
  uint32_t lut_entries;
  uint32_t in_count, out_count; /* number of frame buffers in use */
  uint32_t lut_time_ticks;      /* duration of the tables' computation, in ticks of 24 MHz */
  uint32_t captured;            /* frames */
  uint32_t remapped;            /* remaps; number n of them (from 0) follows table n mod `tables` */
  uint32_t flipped;             /* number of times that the display was switched to a new frame */
  uint32_t dropped;             /* captured frames that were not remapped */
  uint32_t patched_value;       /* result of PARAM_SELF_PATCH; 0: not run */
  uint32_t dip;                 /* switches as read at the start */
  uint32_t torn;                /* frames whose first source row changed during the remap */
  uint32_t spurious;            /* interrupts without a pending source */
  uint32_t tables;              /* number of look-up tables in use */
  uint32_t table_address[TABLES_MAX]; /* of each one; the first is `lut`; 0: its memory was needed
                                         for the forms that the kernel reads */
} fw_state_t;

extern fw_state_t fw_state;
extern uint32_t frame_stride; /* bytes from one buffer to the next, in frame_in and frame_out */
extern uint32_t lut[LUT_ENTRIES_MAX];
extern uint8_t frame_in[IN_COUNT * FRAME_STRIDE_MAX];
#if OUT_COUNT > 0
extern uint8_t frame_out[OUT_COUNT * FRAME_STRIDE_MAX];
#endif

#endif
