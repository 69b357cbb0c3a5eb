// What `--perfetto` and its companions ask for.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "model/common/units.h"

namespace fovea::app {

struct PerfettoRequest {
  std::filesystem::path file = {};  ///< empty: no trace
  std::string tracks = ".";         ///< regular expression (RE2); part of GROUP/TRACK
  /// When the recording begins: a time since power-up, or with the window.
  std::string from = "window";
  Picoseconds duration = kNever;    ///< and for how long
  /// "": records until the duration is over. Otherwise the recording ends `duration` after the first
  /// displayed frame that was dropped before, repeated, or had an underflow: the file then holds what led
  /// there.
  std::string trigger = "";
  std::uint64_t megabytes = 64;     ///< of events that are kept: the first ones, with a trigger the newest
};

}  // namespace fovea::app
