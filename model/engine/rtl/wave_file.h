// Waveforms of the verilated RTL as an FST file (the format of GTKWave).
#pragma once
#include <cstdint>
#include <memory>

#include "model/common/units.h"
#include "model/engine/rtl/rtl_backend.h"

class Vremap_top;

namespace fovea::rtl {

/// Records from the trigger on, for the length that is asked for. Edges are at their simulated time; a falling
/// edge lies half way between two rising ones, or shortly before one that ends a pause. In a pause, in which
/// nothing is clocked, all signals stay.
class WaveFile {
 public:
  struct Events {
    bool job = false, interrupt = false, error = false;  ///< at an edge
  };
  /// @throws UserError if the file cannot be written
  WaveFile(const Waves& options, Vremap_top& top);
  ~WaveFile();
  void low(Picoseconds next_edge);
  void high(Picoseconds edge, const Events& events);
  void close();
  void close_at(Picoseconds at) { end_ = at; }  ///< at a time that lies ahead

 private:
  struct File;
  bool triggered(Picoseconds edge, const Events& events);
  void dump(Picoseconds at);
  Waves options_;
  std::unique_ptr<File> file_;
  std::uint64_t left_;
  Picoseconds begin_ = kNever, end_ = kNever, dumped_ = 0, edge_ = 0;
};

}  // namespace fovea::rtl
