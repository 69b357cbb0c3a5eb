// Jobs and maps that make the engine follow a lens of sw/lens.
#pragma once
#include <cstdint>
#include <vector>

#include "sw/lens/lens.h"
#include "tb/rtl/golden.h"

namespace fovea::rtl {

struct MappedJob {
  Job job;
  std::vector<std::uint32_t> map;
};

/// The firmware's own table; the pitch is that of a picture without padding.
MappedJob table_job(const lens_t& lens);
/// A node every 2^grid_log2 pixels. @pre the lens has no theta_max
MappedJob grid_job(const lens_t& lens, unsigned grid_log2);
/// Pieces of 2^piece_log2 square pixels, as narrow as MaxPieces allow.
MappedJob radial_job(const lens_t& lens);

}  // namespace fovea::rtl
