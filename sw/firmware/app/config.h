/* The configuration, from the DIP switches and the parameter page. */
#ifndef FOVEA_FIRMWARE_CONFIG_H
#define FOVEA_FIRMWARE_CONFIG_H

#include <stdint.h>

#include "sw/lens/lens.h"

enum kernel { KERNEL_PLAIN, KERNEL_LDM };

typedef struct config {
  uint32_t dip;
  int is_625;
  uint32_t left, top;     /* of the captured and displayed region in the raster */
  uint32_t width, height; /* of the region */
  uint32_t pitch_bytes;
  enum kernel kernel;
  int serial; /* as in Fig. 6 of the paper: capture, remap, display, then capture the next frame */
  int overlay;
  int self_patch;
  uint32_t repeats; /* number of remaps of each captured frame, at least 1 */
  int page_valid;    /* 0: the page was invalid, defaults are used */
  param_page_t page; /* a copy, modified by the switches */
} config_t;

typedef enum config_result {
  CONFIG_OK = 0,
  CONFIG_BAD_STANDARD, /* switch code 3 */
  CONFIG_BAD_KERNEL,   /* switch codes 2 and 3 */
  CONFIG_BAD_MAPPING,  /* switch code 7 */
  CONFIG_BAD_SIZE      /* region larger than the raster, or a side not a multiple of 4 */
} config_result_t;

/** Derives the configuration. An invalid page is replaced by the defaults. */
__attribute__((warn_unused_result)) config_result_t config_read(config_t *config, uint32_t dip,
                                                                const param_page_t *page);

const char *config_result_text(config_result_t result);

#endif
