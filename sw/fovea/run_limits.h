// What the host watches while a program runs: how far it is, and limits that are none of its aims.
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>

#include "model/common/units.h"

namespace fovea::app {

/// How far a run is; all counts since the start of the run.
struct Progress {
  Picoseconds simulated = 0;
  std::uint64_t frames_shown = 0;   ///< corrected frames displayed
  std::uint64_t frames_wanted = 0;  ///< 0: unknown
  std::uint64_t instructions = 0;   ///< executed by the core
};

/// Takes progress; cheap enough to be called at every field (it decides when to print).
class ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  virtual void update(const Progress& progress) = 0;
};

/// `--max-time` and `--max-instructions`.
struct RunLimits {
  Picoseconds time = kNever;  ///< simulated
  std::uint64_t instructions = ~std::uint64_t{0};

  /// The option whose limit is reached, or "".
  std::string reached(Picoseconds now, std::uint64_t executed) const {
    return now >= time ? "--max-time" : executed >= instructions ? "--max-instructions" : "";
  }
  /// How long to simulate until the next look, at most `slice`: the limit of time is met exactly, that
  /// of instructions within a microsecond.
  Picoseconds next_slice(Picoseconds slice, Picoseconds now, std::uint64_t executed) const {
    constexpr Picoseconds kInstruction = 2 * kPsPerNs;  // no core here executes one in less
    const std::uint64_t left = instructions > executed ? instructions - executed : 0;
    if (left < slice / kInstruction) slice = std::max(kPsPerUs, left * kInstruction);
    return time > now ? std::min(slice, time - now) : slice;
  }
};

}  // namespace fovea::app
