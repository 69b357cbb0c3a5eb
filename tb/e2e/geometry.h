// The oracle's geometry of a lens as the keys describe it.
#pragma once
#include "model/board/board_params.h"
#include "tb/oracle/lens_oracle.h"

namespace fovea::e2e {

oracle::Geometry geometry_of(const board::BoardParams& params, const board::LensParams& lens);

}  // namespace fovea::e2e
