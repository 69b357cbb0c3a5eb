// Progress of a run, and limits that end it early.
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "model/common/units.h"

namespace fovea::app {

/// The progress of a run; all counts since its start.
struct Progress {
  Picoseconds simulated = 0;
  std::uint64_t frames_shown = 0;   ///< corrected frames that were displayed
  std::uint64_t frames_wanted = 0;  ///< 0: unknown
  std::uint64_t instructions = 0;   ///< executed by the core
  std::string_view phase = {};      ///< what the program is at, for people; empty: unknown
};

/// Receives the progress. May be called often: the implementation decides when to print.
class ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  virtual void update(const Progress& progress) = 0;
};

/// The limits of `--max-time` and `--max-instructions`.
struct RunLimits {
  Picoseconds time = kNever;  ///< simulated time
  std::uint64_t instructions = ~std::uint64_t{0};

  /// The option whose limit is reached, or "".
  std::string reached(Picoseconds now, std::uint64_t executed) const {
    return now >= time ? "--max-time" : executed >= instructions ? "--max-instructions" : "";
  }
  /// Duration to simulate until the next check, at most `slice`. The limit of time is met exactly,
  /// that of instructions within a microsecond.
  Picoseconds next_slice(Picoseconds slice, Picoseconds now, std::uint64_t executed) const {
    constexpr Picoseconds kInstruction = 2 * kPsPerNs;  // no core executes one in less time
    const std::uint64_t left = instructions > executed ? instructions - executed : 0;
    if (left < slice / kInstruction) slice = std::max(kPsPerUs, left * kInstruction);
    return time > now ? std::min(slice, time - now) : slice;
  }
};

}  // namespace fovea::app
