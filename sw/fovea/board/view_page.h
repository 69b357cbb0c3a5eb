// The view page of an experiment.
#pragma once
#include "model/board/board_params.h"
#include "model/contract/view_page.h"

namespace fovea::app {

/// The sealed page (model/contract/view_page.h) of a composed view.
view_page_t view_page(const board::BoardParams& params);

}  // namespace fovea::app
