#include "sw/fovea/board/view_page.h"

#include <algorithm>

namespace fovea::app {

view_page_t view_page(const board::BoardParams& params) {
  const board::BirdsEyeParams& ground = params.birds_eye;
  view_page_t page{};
  page.view = contract::code_of(board::kViews, params.firmware.view());
  page.source = params.cameras.quad() ? VIEW_QUAD : VIEW_INPUTS;
  const double x = (params.width() - 1) / 2.0, y = (params.height() - 1) / 2.0;
  const double across = ground.car_width() / 2 / ground.width() * params.width();
  const double along = ground.car_length() / 2 / ground.height() * params.height();
  page.car = {x - across, y - along, x + across, y + along};
  const video::GroundPicture picture{params.width(), params.height(), ground.width(), ground.height()};
  for (unsigned n = 0; n < VIEW_CAMERAS; ++n)
    std::ranges::copy(video::ray_matrix(picture, params.mounts[n].mount()), page.ground[n]);
  view_page_seal(&page);
  return page;
}

}  // namespace fovea::app
