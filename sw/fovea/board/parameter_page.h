// The parameter page of an experiment.
#pragma once
#include <cstdint>
#include <vector>

#include "model/board/board_params.h"
#include "model/video/scene/sources.h"

namespace fovea::app {

/// The bytes of the page (model/contract/param_page.h) that a loader puts at PARAM_PAGE_BASE; for a composed
/// view, with the view page behind it.
/// @throws UserError for clocks or a lens that cannot be
std::vector<std::uint8_t> parameter_page(const board::BoardParams& params,
                                         const std::vector<const video::StampedSource*>& sources);
inline std::vector<std::uint8_t> parameter_page(const board::BoardParams& params,
                                                const video::StampedSource& source) {
  return parameter_page(params, std::vector<const video::StampedSource*>{&source});
}

}  // namespace fovea::app
