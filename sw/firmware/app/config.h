/* The configuration, from the DIP switches and the parameter page. */
#ifndef FOVEA_FIRMWARE_CONFIG_H
#define FOVEA_FIRMWARE_CONFIG_H

#include <stdint.h>

#include "model/contract/param_page.h"

/* Cameras that the program serves: with TIME_DIVISION, frames of several in turn. */
#ifdef TIME_DIVISION
#define CAMERAS_MAX PARAM_CAMERAS_MAX
#else
#define CAMERAS_MAX 1u
#endif

typedef struct config {
  uint32_t dip;
  int is_625;
  uint32_t left, top;     /* of the displayed region in the raster */
  uint32_t width, height; /* of the region */
  int digital;            /* a progressive camera at the digital port, of which all is captured */
  uint32_t source_left, source_top, source_width, source_height; /* what is captured of the camera's raster */
  uint32_t pitch_bytes;   /* of captured and displayed frames */
  uint32_t kernel;        /* enum param_kernel */
  uint32_t table_builder; /* enum param_table_builder */
  int serial; /* as in Fig. 6 of the paper: capture, remap, display, then capture the next frame */
  int overlay;
  int self_patch;
  int has_engine;   /* the chip has the remap engine */
#ifdef CONSOLE
  int display_free; /* the display does not start in step with the camera */
  int multiplexer;  /* an analogue multiplexer under GPIO changes between the cameras, not the decoder */
#endif
#ifdef TIME_DIVISION
  int check_capture; /* frames of which a part was not written are left out (capture_check.h) */
  uint32_t watchdog_us; /* the period of the watchdog; 0: off */
#endif
  uint32_t repeats; /* number of remaps for each captured frame, at least 1 */
  uint32_t tables;  /* number of look-up tables, 1 to PARAM_TABLES_MAX */
  uint32_t sources; /* number of captured frames that the remaps read in turn, at least 1 */
  uint32_t vpss_clk_ctrl;
  uint8_t priority[PRIORITY_COUNT];
  lens_view_t view; /* of the camera, modified by the switches; a copy in cached memory */
#ifdef TIME_DIVISION
  uint32_t cameras;                 /* 1 to CAMERAS_MAX */
  uint8_t input[CAMERAS_MAX];       /* of the decoder */
  uint8_t genlocked[CAMERAS_MAX];   /* PARAM_CAMERA_GENLOCKED */
  lens_view_t views[CAMERAS_MAX];   /* as `view`, of each camera */
#endif
} config_t;

typedef enum config_result {
  CONFIG_OK = 0,
  CONFIG_BAD_STANDARDS, /* camera and display differ */
  CONFIG_BAD_SIZES,     /* an unused code, or sizes of a camera behind the decoder and of the display that differ */
  CONFIG_BAD_REGION,    /* region larger than the raster, or a side not a multiple of 4 */
  CONFIG_BAD_SHIFT,     /* unused code */
  CONFIG_BAD_KERNEL,
  CONFIG_BAD_BUILDER,
  CONFIG_BAD_FLOW,
  CONFIG_BAD_TABLES,  /* more than there is memory for */
  CONFIG_BAD_CAMERAS, /* more than this firmware serves */
  CONFIG_BAD_DIGITAL, /* a size that no camera at the digital port has */
#ifdef TIME_DIVISION
  CONFIG_BAD_DIVISION, /* several tables for a camera, or the serial flow */
#endif
  CONFIG_RESULTS
} config_result_t;

/** Derives the configuration from a page that param_page_check() has accepted. */
__attribute__((warn_unused_result)) config_result_t config_read(config_t *config, uint32_t dip,
                                                                const param_page_t *page);

const char *config_result_text(config_result_t result);

#endif
