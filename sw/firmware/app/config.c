#include "config.h"

#include "../drivers/isif.h"

config_result_t config_read(config_t *c, uint32_t dip, const param_page_t *page) {
  const uint32_t standard = dip & 3u, mapping = (dip >> 2) & 7u, kernel = (dip >> 6) & 3u;
  *c = (config_t){.dip = dip,
                  .is_625 = standard == 0,
                  .kernel = kernel == 1 ? KERNEL_LDM : KERNEL_PLAIN,
                  .serial = (dip >> 8 & 1u) != 0,
                  .overlay = (dip >> 10 & 1u) != 0,
                  .self_patch = (dip >> 11 & 1u) != 0,
                  .page_valid = param_page_valid(page)};
  if (standard > 2) return CONFIG_BAD_STANDARD;
  if (kernel > 1) return CONFIG_BAD_KERNEL;
  if (mapping > LENS_TABLE) return CONFIG_BAD_MAPPING;

  if (c->page_valid)
    c->page = *page;
  else
    param_page_default(&c->page);
  if (mapping != 0) c->page.mapping = mapping;
  c->repeats = c->page.repeats != 0 ? c->page.repeats : 1u;
  if ((dip >> 5 & 1u) != 0) c->page.flags |= PARAM_PAPER_LITERAL_FOCAL;
  if ((dip >> 9 & 1u) != 0) c->page.flags |= PARAM_PAIR_METHOD_B;

  const uint32_t raster_height = c->is_625 ? 576u : 480u;
  c->width = c->page.width != 0 ? c->page.width : standard == 2 ? 640u : 720u;
  c->height = c->page.height != 0 ? c->page.height : raster_height;
  /* With multiples of 4, the centred region begins at a whole pair and a whole line of a field. */
  if (c->width > 720u || c->width % 4u != 0 || c->height > raster_height || c->height % 4u != 0)
    return CONFIG_BAD_SIZE;
  c->left = (720u - c->width) / 2u;
  c->top = (raster_height - c->height) / 2u;
  c->pitch_bytes = isif_pitch(c->width);
  return CONFIG_OK;
}

const char *config_result_text(config_result_t result) {
  switch (result) {
    case CONFIG_OK:
      return "ok";
    case CONFIG_BAD_STANDARD:
      return "switches 0-1: 0 PAL, 1 NTSC, 2 VGA";
    case CONFIG_BAD_KERNEL:
      return "switches 6-7: 0 plain, 1 LDM/STM";
    case CONFIG_BAD_MAPPING:
      return "switches 2-4: 0 as page, 1 to 6 mapping";
    case CONFIG_BAD_SIZE:
      return "region: multiples of 4, within the raster";
  }
  return "unknown";
}
