// The serial line of UART0 on the host: a terminal, a pipe, or a prepared dialogue.
#pragma once
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "model/board/board.h"
#include "model/board/serial_sender.h"
#include "model/common/observers.h"
#include "sw/fovea/console/console.h"
#include "sw/fovea/console/dialogue.h"

namespace fovea::app {

/// What is received, and when, depends only on simulated time, unless a person types.
class BoardConsole : public board::SerialInput {
 public:
  /// To be constructed before the simulation starts. @param stream shows the output and provides
  /// the input; null: nothing is shown @param dialogue replaces the stream's input
  BoardConsole(board::Board& board, ConsoleStream* stream, std::optional<Dialogue> dialogue);

  /// To be called between two slices of the simulation. Shows output, reads keys, and keeps an
  /// interactive simulation from running faster than wall-clock time. @return true if the user
  /// wants to leave
  bool look();
  /// The keys that a person typed, as a dialogue that repeats them.
  const std::string& typed() const { return typed_; }
  /// The current step of a dialogue that has not ended, otherwise "".
  std::string open_step() const { return dialogue_ ? dialogue_->position() : ""; }

 private:
  std::optional<std::uint8_t> next(Picoseconds now) override;
  Picoseconds ask_again() const override;
  bool interactive() const { return stream_ && stream_->interactive() && !dialogue_; }
  void keep_pace();

  ConsoleStream* stream_;
  std::optional<Dialogue> dialogue_;
  std::unique_ptr<board::SerialSender> sender_;
  std::deque<std::uint8_t> keys_;
  std::string typed_;
  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  Picoseconds simulated_ = 0;
  Subscription sent_;
};

}  // namespace fovea::app
