// `--console`: connects UART0 to the terminal.
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

/// Sets the process's terminal to raw mode: keys arrive when they are pressed, including Ctrl-C.
/// Output is still processed, so that messages look right. The destructor restores the former mode,
/// and so does every other way of ending the process: exit(), quick_exit() and signals.
class RawTerminal {
 public:
  /// @param fd the terminal. Only one object may exist at a time.
  explicit RawTerminal(int fd);
  ~RawTerminal();
  RawTerminal(const RawTerminal&) = delete;
  RawTerminal& operator=(const RawTerminal&) = delete;
  /// Restores the former mode now; safe in a signal handler.
  static void restore();
};

/// The host's side of a serial console: shows bytes from the guest and provides typed bytes.
class ConsoleStream {
 public:
  /// @param out receives what the guest sends. @param in_fd input; -1: none.
  ConsoleStream(std::ostream& out, int in_fd, const std::atomic<bool>& stop);

  /// Shows a byte that the guest has sent.
  void show(std::uint8_t byte);
  void flush();
  /// True if the output cannot be written any more, so the run should end.
  bool lost() const;

  /// True if the input is a terminal, so that a person types at times that cannot be repeated.
  bool interactive() const { return interactive_; }
  /// Interactive input: the keys pressed since the last call, without waiting.
  std::string keys();
  /// True once Ctrl-A x was pressed.
  bool quit() const { return quit_; }
  /// Other input: the next byte, waiting as long as necessary; empty at the end of the input, or if
  /// the run is to stop.
  std::optional<std::uint8_t> next();

 private:
  std::ostream& out_;
  const int in_;
  const std::atomic<bool>& stop_;
  bool interactive_ = false, quit_ = false, escape_ = false, ended_ = false;
  std::string block_;  // bytes read ahead
  std::size_t taken_ = 0;
};

}  // namespace fovea::app
