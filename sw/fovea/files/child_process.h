// A program in a process of its own, connected by pipes. Each wait for it has a limit.
#pragma once
#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace fovea::app {

/// Thrown if a signal requests a stop while a child works.
struct Stopped : std::runtime_error {
  explicit Stopped(const std::string& what = "stopped before the simulation began") : std::runtime_error(what) {}
};

/// How long a child is waited for.
struct Patience {
  const std::atomic<bool>* stop = nullptr;  ///< set by a signal; nullptr: never
  /// The longest time in which it neither takes nor gives a byte; then it counts as hanging. Host time.
  std::chrono::milliseconds silence{120'000};
  /// The same once `stop` is set; 0: it is not waited for at all.
  std::chrono::milliseconds silence_after_stop{0};
};

/// A child process whose standard streams are sockets or pipes. It is started without a shell, in
/// its own process group, so that Ctrl-C in the terminal does not truncate its output.
class ChildProcess {
 public:
  enum class Stream { kInput, kOutput };  ///< the stream that `data` is connected to
  /// @param purpose for the message of the error @param stdin_fd with Stream::kOutput, a descriptor
  /// that becomes the standard input; -1: none
  /// @throws UserError if the program cannot be started
  ChildProcess(const std::vector<std::string>& command, Stream data, const std::string& purpose,
               const Patience& patience, int stdin_fd = -1);
  /// Kills the child, and what it has started, if it is still running.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Each of these throws Stopped, or a UserError if the child hangs.

  /// Reads more of the child's output, and collects its messages. Returns false at the end of the
  /// output.
  bool read_some(std::string& buffer);
  /// Sends all of `bytes`. Returns false if the child has closed its input.
  bool write_all(const std::uint8_t* bytes, std::size_t size);
  /// Closes the data stream, waits, and returns the exit status (128 + signal if killed).
  int finish();
  /// The first kilobytes of the child's standard error.
  const std::string& messages() const { return messages_; }

 private:
  using Clock = std::chrono::steady_clock;
  void read_messages();
  void wait(short events, short& ready);
  void check_patience() const;
  bool ended();

  std::string purpose_, program_;
  Patience patience_;
  Clock::time_point last_;  ///< when the child took or gave something
  pid_t pid_ = -1;
  int data_ = -1, error_ = -1, status_ = 0;
  std::string messages_;
};

/// Kills all children of this kind that run, and what they have started. A signal handler may call it: no other code
/// ends them when a signal is about to end this process.
void kill_children();

}  // namespace fovea::app
