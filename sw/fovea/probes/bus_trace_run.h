// `fovea run --bus-trace`: records the bus traffic of the measurement window of a board.
#pragma once
#include <filesystem>
#include <memory>

#include "model/board/board.h"
#include "model/trace/core/recorder.h"
#include "sw/fovea/files/output_file.h"

namespace fovea::app {

/// To be constructed before the run, so that a file that cannot be written is reported at once.
/// open() and close() mark the start and end of the window. Without both no trace is written, and
/// an earlier file is kept.
class BusTraceRun {
 public:
  BusTraceRun(const std::filesystem::path& file, const ParamSet& params, board::Board& board);
  void open();
  void close();
  /// @return why there is no trace; "" if there is one @throws UserError if the file cannot be written
  std::string finish();

 private:
  OutputFile file_;
  const ParamSet& params_;
  board::Board& board_;
  soc::Dm365::Recording recorder_;
  Subscription pins_;
  trace::ClockInfo core_, scr_, ddr_;
  Picoseconds refresh_ = 0;
  bool opened_ = false, closed_ = false;
};

}  // namespace fovea::app
