#include "sw/lens/region.h"

int lens_region_fits(const lens_region_t *r, uint32_t width, uint32_t height) {
  return r->left >= 0.0 && r->top >= 0.0 && r->width > 0.0 && r->height > 0.0 &&
         r->left + r->width <= (double)width && r->top + r->height <= (double)height &&
         (r->width * LENS_REGION_SCALE_MAX >= (double)width || r->height * LENS_REGION_SCALE_MAX >= (double)height);
}

double lens_region_scale(const lens_region_t *r, uint32_t width, uint32_t height) {
  const double across = (double)width / r->width, down = (double)height / r->height;
  return across < down ? across : down;
}

void lens_show_region(lens_view_t *view, const lens_t *lens, const lens_region_t *r) {
  const double scale = lens_region_scale(r, lens->width, lens->height);
  view->out_focal_px = lens->out_focal * scale;
  view->shift_x = (view->shift_x + r->left + (r->width - (double)lens->width) / 2.0) * scale;
  view->shift_y = (view->shift_y + r->top + (r->height - (double)lens->height) / 2.0) * scale;
}
