// `--console`: UART0 in the terminal.
#pragma once
#include <atomic>
#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "model/common/units.h"

namespace fovea::app {

inline constexpr std::string_view kConsoleHelp =
    "fovea: console: Ctrl-A x ends the run, Ctrl-A Ctrl-A types a Ctrl-A\n";

/// The process's terminal in raw mode: keys come as they are pressed, Ctrl-C among them. Output is
/// still processed, so that messages of ours look right. The former mode comes back with the
/// destructor, and on every other way out of the process: exit(), quick_exit() and signals.
class RawTerminal {
 public:
  /// @param fd the terminal. At most one at a time.
  explicit RawTerminal(int fd);
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;
  /// Gives the former mode back now; safe in a signal handler.
  static void restore();
};

/// What the host's side of a serial console does: shows bytes, and has the bytes that are typed.
class ConsoleStream {
 public:
  /// @param out takes what the guest sends. @param in_fd -1: nothing is typed.
  ConsoleStream(std::ostream& out, int in_fd, const std::atomic<bool>& stop);

  /// Shows a byte that the guest has sent.
  void show(std::uint8_t byte);
  void flush();
  /// What is shown does not arrive anywhere: the run is to end.
  bool lost() const;

  /// Input comes from a terminal: typed when a person likes to, in no repeatable way.
  bool interactive() const { return interactive_; }
  /// Interactive: the keys pressed since the last call, without waiting.
  std::string keys();
  /// Ctrl-A x was pressed.
  bool quit() const { return quit_; }
  /// Not interactive: the next byte of the input, waited for as long as it takes; nothing at its end,
  /// or if the run is to stop.
  std::optional<std::uint8_t> next();

 private:
  std::ostream& out_;
  const int in_;
  const std::atomic<bool>& stop_;
  bool interactive_ = false, quit_ = false, escape_ = false, ended_ = false;
  std::string block_;  // read ahead
  std::size_t taken_ = 0;
};

}  // namespace fovea::app
