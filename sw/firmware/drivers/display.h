/* Display: video window 0 of the OSD, and the encoder in its standard interlaced timings. */
#ifndef FOVEA_FIRMWARE_DISPLAY_H
#define FOVEA_FIRMWARE_DISPLAY_H

#include <stdint.h>

typedef struct display_mode {
  int is_625;             /* 1: 625/50 (720 x 576), 0: 525/60 (720 x 480) */
  uint32_t left, top;     /* of the window in the raster, in pixels and frame lines; top even */
  uint32_t width, height; /* of the window */
  uint32_t pitch_bytes;   /* multiple of 32, below 16 KiB */
} display_mode_t;

typedef enum display_result {
  DISPLAY_OK = 0,
  DISPLAY_BAD_MODE,
  DISPLAY_BAD_ADDRESS
} display_result_t;

/** Starts the raster with the window off, so that the background colour is displayed. */
__attribute__((warn_unused_result)) display_result_t display_start(const display_mode_t *mode);

/** Sets the window to a UYVY frame (32-byte aligned, in DDR2), from the next field on. The function
 * writes three registers one after the other, so it must not be called near the start of a field.
 */
__attribute__((warn_unused_result)) display_result_t display_set_address(uint32_t address,
                                                                         uint32_t pitch_bytes);

/** Enables the window. */
void display_enable_window(void);

/** Returns 1 while the second field of a frame is sent. */
int display_second_field(void);

/** Whether data of the display came too late since the last call: then parts of lines were black. 0 on a chip whose
 * MISCCTL has no such flag. */
int display_take_late(void);

#endif
