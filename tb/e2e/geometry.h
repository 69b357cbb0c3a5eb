// The oracle's geometry of a lens as the keys describe it.
#pragma once
#include "model/board/board_params.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::e2e {

oracle::Geometry geometry_of(const board::BoardParams& params, const board::LensParams& lens);

/// The view of the region of interest: left, top, width and height in pixels of what `g` shows.
void show_region(oracle::Geometry& g, double left, double top, double width, double height);

}  // namespace fovea::e2e
