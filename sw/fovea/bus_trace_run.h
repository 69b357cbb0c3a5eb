// `fovea run --bus-trace`: records the measured window of a board.
#pragma once
#include <filesystem>
#include <memory>

#include "model/board/board.h"
#include "model/trace/core/recorder.h"
#include "sw/fovea/output_file.h"

namespace fovea::app {

/// Made before the run, so that a file that cannot be written shows at once. open() and close() are
/// the window's edges; without both there is no trace, and an earlier one stays.
class BusTraceRun {
 public:
  BusTraceRun(const std::filesystem::path& file, const ParamSet& params, board::Board& board);
  ~BusTraceRun();
  void open();
  void close();
  /// @throws UserError when the file cannot be written
  void finish();

 private:
  OutputFile file_;
  const ParamSet& params_;
  board::Board& board_;
  std::unique_ptr<trace::BusRecorder> recorder_;
  trace::ClockInfo core_, scr_, ddr_;
  Picoseconds refresh_ = 0;
  bool opened_ = false, closed_ = false;
};

}  // namespace fovea::app
