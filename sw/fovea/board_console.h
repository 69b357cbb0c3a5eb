// UART0's line on the host: terminal, pipe, or a dialogue that was written before.
#pragma once
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "model/board/board.h"
#include "model/board/serial_sender.h"
#include "sw/fovea/console.h"
#include "sw/fovea/dialogue.h"

namespace fovea::app {

/// What arrives, and when, follows from simulated time alone, unless a person types.
class BoardConsole : public board::SerialInput {
 public:
  /// Before the simulation starts. @param stream null: nothing is shown. @param dialogue what is
  /// typed instead of the stream's input
  BoardConsole(board::Board& board, ConsoleStream* stream, std::optional<Dialogue> dialogue);

  /// Between two slices of the simulation: shows what came, takes keys, and lets a person's time
  /// pass no faster than the clock on the wall. @return true if the person wants to leave
  bool look();
  /// What a person typed, as a dialogue that types the same again.
  const std::string& typed() const { return typed_; }
  /// The step at which a dialogue stands that is not over; else "".
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
};

}  // namespace fovea::app
