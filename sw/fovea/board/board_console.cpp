#include "sw/fovea/board/board_console.h"

#include <thread>

namespace fovea::app {

BoardConsole::BoardConsole(board::Board& board, ConsoleStream* stream,
                           std::optional<Dialogue> dialogue)
    : stream_(stream), dialogue_(std::move(dialogue)) {
  sent_ = board.observe_uart([this](std::uint8_t byte) {
    if (stream_) stream_->show(byte);
    if (!dialogue_) return;
    const bool before = dialogue_->over();
    dialogue_->received(byte);
    if (!before) sender_->kick();
  });
  sender_ = std::make_unique<board::SerialSender>("uart0_input", board.dm365.uart0, *this);
}

std::optional<std::uint8_t> BoardConsole::next(Picoseconds now) {
  if (dialogue_) return dialogue_->next(now);
  if (!stream_) return std::nullopt;
  if (!interactive()) return stream_->next();
  if (keys_.empty()) return std::nullopt;
  const std::uint8_t key = keys_.front();
  keys_.pop_front();
  return key;
}

Picoseconds BoardConsole::ask_again() const {
  return dialogue_ ? dialogue_->waits_until().value_or(kNever) : kNever;
}

bool BoardConsole::look() {
  if (!stream_) return false;
  stream_->flush();
  if (!interactive()) return false;
  keep_pace();
  const std::string pressed = stream_->keys();
  if (!pressed.empty()) {
    typed_ += dialogue_lines(kernel_time(), pressed);
    keys_.insert(keys_.end(), pressed.begin(), pressed.end());
    sender_->kick();
  }
  return stream_->quit();
}

/// Limits the speed to real time for an interactive user: an idle board would simulate an hour per
/// minute.
void BoardConsole::keep_pace() {
  using std::chrono::nanoseconds;
  constexpr nanoseconds kSlack = std::chrono::milliseconds(20);
  const auto ahead = nanoseconds((kernel_time() - simulated_) / kPsPerNs) -
                     (std::chrono::steady_clock::now() - wall_);
  if (ahead > kSlack) {
    std::this_thread::sleep_for(ahead - kSlack / 2);
  } else if (ahead < -kSlack) {
    wall_ = std::chrono::steady_clock::now();  // a busy board falls behind; it must not catch up
                                               // later
    simulated_ = kernel_time();
  }
}

}  // namespace fovea::app
