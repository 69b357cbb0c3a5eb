// Loops that only wait: they load from the same address until what they have loaded is as they want it.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "sw/fovea/program/elf_image.h"

namespace fovea::app {

/// Finds such loops in the ARM code of programs: a branch back over at most kMost instructions that load from an
/// address which the loop does not change, compare what was loaded, store nothing and call nothing. It may count its
/// turns, so as to give up, but carries nothing else from one turn into the next. Thumb code is not looked at.
class PollLoops {
 public:
  static constexpr std::uint32_t kMost = 16;
  explicit PollLoops(std::span<const ElfImage* const> programs = {});
  /// True for an instruction of such a loop.
  bool contains(std::uint32_t address) const;

 private:
  std::map<std::uint32_t, std::uint32_t> loops_;  ///< the last instruction by the first one
};

}  // namespace fovea::app
