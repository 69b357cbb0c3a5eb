// What the rows and declarations of the platform say, as text: a C header for target programs and a page
// for people.
#pragma once
#include <string>

#include "model/soc/placement.h"

namespace fovea::soc {

struct PlatformText {
  /// sw/firmware/registers.h: addresses and fields from the declarations of the blocks, power gates and
  /// interrupt numbers from their rows.
  std::string registers_h;
  /// model/soc/BLOCKS.md: tables of the blocks, of what is not modelled, of the memory masters,
  /// and of the EDMA's events.
  std::string blocks_md;
};

/// Makes the blocks, so it may be called once in a process.
PlatformText platform_text(const Placements& rows = dm365_blocks());

}  // namespace fovea::soc
