#include "config.h"

#include "../drivers/isif.h"
#include "model/contract/switches.h"

static const struct {
  uint16_t width, height;
} kSizes[] = {[SWITCH_720X576] = {720, 576},
              [SWITCH_720X480] = {720, 480},
              [SWITCH_720X486] = {720, 486},
              [SWITCH_640X480] = {640, 480},
              [SWITCH_800X600] = {800, 600}};

/* What is captured: the displayed region, or all of a camera at the digital port. */
static config_result_t read_source(config_t *c) {
  c->source_left = c->left;
  c->source_top = c->top;
  c->source_width = c->width;
  c->source_height = c->height;
  c->pitch_bytes = isif_pitch(c->width);
  if (!c->digital) return CONFIG_OK;
#ifdef TIME_DIVISION
  return CONFIG_BAD_DIGITAL;
#else
  const uint32_t size = SWITCH_GET(c->dip, SWITCH_SIZE_IN);
  if (size != SWITCH_640X480 && size != SWITCH_800X600) return CONFIG_BAD_DIGITAL;
  c->source_left = c->source_top = 0;
  c->source_width = kSizes[size].width;
  c->source_height = kSizes[size].height;
  if (c->source_width > c->width) c->pitch_bytes = isif_pitch(c->source_width);
  return CONFIG_OK;
#endif
}

static config_result_t read_region(config_t *c, const param_page_t *page) {
  const uint32_t size = SWITCH_GET(c->dip, SWITCH_SIZE_OUT);
  if (size > SWITCH_800X600 || (!c->digital && SWITCH_GET(c->dip, SWITCH_SIZE_IN) != size)) return CONFIG_BAD_SIZES;
  const uint32_t raster_height = c->is_625 ? 576u : size == SWITCH_720X486 ? 486u : 480u;
  c->width = size != SWITCH_SIZE_OF_PAGE ? kSizes[size].width
             : page->width != 0          ? page->width
                                         : 720u;
  c->height = size != SWITCH_SIZE_OF_PAGE ? kSizes[size].height
              : page->height != 0         ? page->height
                                          : raster_height;
  /* With multiples of 4, the centred region begins at a whole pair and a whole line of a field. All lines do too. */
  if (c->width > 720u || c->width % 4u != 0 || c->height > raster_height ||
      (c->height % 4u != 0 && c->height != raster_height))
    return CONFIG_BAD_REGION;
  c->left = (720u - c->width) / 2u;
  c->top = (raster_height - c->height) / 2u;
  return read_source(c);
}

/* Returns 0 for an unused code. */
static int add_shift(double *shift, uint32_t code) {
  if (code == SWITCH_FORWARD) *shift += SWITCH_SHIFT_PIXELS;
  if (code == SWITCH_BACK) *shift -= SWITCH_SHIFT_PIXELS;
  return code <= SWITCH_BACK;
}

static config_result_t read_view(config_t *c, const lens_view_t *view) {
  c->view = *view;
  const uint32_t mapping = SWITCH_GET(c->dip, SWITCH_MAPPING);
  if (mapping != 0) c->view.mapping = mapping - 1u;
  if (!add_shift(&c->view.shift_x, SWITCH_GET(c->dip, SWITCH_SHIFT_X)) ||
      !add_shift(&c->view.shift_y, SWITCH_GET(c->dip, SWITCH_SHIFT_Y)))
    return CONFIG_BAD_SHIFT;
  return CONFIG_OK;
}

#ifdef TIME_DIVISION
static config_result_t read_cameras(config_t *c, const param_page_t *page) {
  c->cameras = c->tables = page->camera_count;
  for (uint32_t n = c->cameras; n-- != 0;) { /* the last one read is that of camera 0 */
    const config_result_t result = read_view(c, &page->camera[n].view);
    if (result != CONFIG_OK) return result;
    c->views[n] = c->view;
    c->input[n] = (uint8_t)page->camera[n].input;
    c->genlocked[n] = (page->camera[n].flags & PARAM_CAMERA_GENLOCKED) != 0;
  }
  return CONFIG_OK;
}
#endif

config_result_t config_read(config_t *c, uint32_t dip, const param_page_t *page) {
  const uint32_t standard = SWITCH_GET(dip, SWITCH_STANDARD_IN);
  *c = (config_t){.dip = dip,
                  .is_625 = standard == SWITCH_PAL,
                  .kernel = page->kernel,
                  .table_builder = page->table_builder,
                  .serial = page->flow == FLOW_SERIAL,
                  .overlay = (page->flags & PARAM_OVERLAY) != 0,
                  .self_patch = (page->flags & PARAM_SELF_PATCH) != 0,
                  .has_engine = (page->flags & PARAM_ENGINE) != 0,
                  .digital = (page->flags & PARAM_DIGITAL) != 0,
#ifdef CONSOLE
                  .display_free = (page->flags & PARAM_DISPLAY_FREE) != 0,
                  .multiplexer = (page->flags & PARAM_MULTIPLEXER) != 0,
#endif
#ifdef TIME_DIVISION
                  .check_capture = (page->flags & PARAM_CHECK_CAPTURE) != 0,
                  .watchdog_us = page->watchdog_us,
#endif
                  .repeats = page->repeats != 0 ? page->repeats : 1u,
                  .tables = page->tables != 0 ? page->tables : 1u,
                  .vpss_clk_ctrl = page->clocks.vpss_clk_ctrl};
  for (uint32_t i = 0; i < PRIORITY_COUNT; ++i) c->priority[i] = page->priority[i];
  if (SWITCH_GET(dip, SWITCH_STANDARD_OUT) != standard) return CONFIG_BAD_STANDARDS;
  if (page->kernel >= KERNEL_COUNT) return CONFIG_BAD_KERNEL;
  if (page->table_builder > BUILDER_FIXED) return CONFIG_BAD_BUILDER;
  if (page->flow > FLOW_SERIAL) return CONFIG_BAD_FLOW;
  if (c->tables > PARAM_TABLES_MAX) return CONFIG_BAD_TABLES;
#ifdef TIME_DIVISION
  if (c->tables != 1u || c->serial) return CONFIG_BAD_DIVISION;
#endif
  /* The serial flow has one input buffer. */
  c->sources = c->serial ? 1u : c->tables;
  if (page->camera_count == 0 || page->camera_count > CAMERAS_MAX) return CONFIG_BAD_CAMERAS;
  const config_result_t result = read_region(c, page);
#ifdef TIME_DIVISION
  return result != CONFIG_OK ? result : read_cameras(c, page);
#else
  return result != CONFIG_OK ? result : read_view(c, &page->camera[0].view);
#endif
}

const char *config_result_text(config_result_t result) {
  switch (result) {
    case CONFIG_OK:
      return "ok";
    case CONFIG_BAD_STANDARDS:
      return "switches 0 and 1: camera and display must have the same standard";
    case CONFIG_BAD_SIZES:
      return "switches 2-4 and 5-7: codes 0 to 5; without a digital camera, the same size twice";
    case CONFIG_BAD_REGION:
      return "size: multiples of 4 or all lines, within the raster of the standard";
    case CONFIG_BAD_SHIFT:
      return "switches 11-12 and 13-14: 0 centred, 1 right or down, 2 left or up";
    case CONFIG_BAD_KERNEL:
      return "parameter page: unknown kernel; this firmware has 0 (plain) to 13 "
             "(engine_radial)";
    case CONFIG_BAD_BUILDER:
      return "parameter page: unknown table builder; this firmware has 0 double precision, 1 fixed "
             "point";
    case CONFIG_BAD_FLOW:
      return "parameter page: unknown flow; this firmware has 0 double buffering, 1 serial";
    case CONFIG_BAD_TABLES:
      return "parameter page: too many look-up tables; this firmware has memory for 4";
    case CONFIG_BAD_CAMERAS:
      return "parameter page: several cameras; this firmware serves one";
    case CONFIG_BAD_DIGITAL:
      return "a digital camera: 640x480 or 800x600 (switches 2-4), in the program for one camera";
#ifdef TIME_DIVISION
    case CONFIG_BAD_DIVISION:
      return "parameter page: with several cameras, one table for each and double buffering";
#endif
    case CONFIG_RESULTS:
      break;
  }
  return "unknown";
}
