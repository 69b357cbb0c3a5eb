// A program that this process has started.
#pragma once
#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fovea::points {

/// How a program ended: by its own status, or by a signal (its number; the status is then 128 more).
struct Ended {
  int status = 0;
  int signal = 0;
};

/// How long a child may neither use the processor nor write before it counts as hanging. A run may take hours, and
/// computes all that time; what it waits for itself (ffmpeg) it gives up earlier.
inline constexpr std::chrono::milliseconds kLongestSilence{600'000};

/// One child. It has a process group of its own, so that a Ctrl-C in the terminal reaches only the
/// parent, which then ends its children itself; should the parent die, the kernel sends it SIGTERM.
class Child {
 public:
  /// Starts `arguments[0]`, with nothing on its standard input and the other streams in these files,
  /// which must not exist.
  /// @throws UserError if the host refuses; a program that cannot be executed ends with status 127
  Child(const std::vector<std::string>& arguments, const std::filesystem::path& output,
        const std::filesystem::path& messages);
  /// Kills it if it still runs. What the kernel does not end at once, because it waits for a disk, is left to it.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// How it has ended; nothing while it runs. Does not wait.
  std::optional<Ended> ended();
  /// Another number with each sign of life: processor time of the child and of what it has started and waited for, and
  /// bytes in its files. Nothing: it cannot be known, or somebody has stopped the child (SIGSTOP).
  std::optional<std::uint64_t> activity() const;
  /// Sends SIGTERM or SIGKILL, if it still runs.
  void ask_to_end();
  void kill();

 private:
  void signal(int number);
  pid_t pid_ = -1;
  std::filesystem::path output_, messages_;
  std::optional<Ended> ended_;
};

/// Watches a child for signs of life.
class Silence {
 public:
  explicit Silence(std::chrono::milliseconds longest) : longest_(longest) {}
  /// Asked often; looks a few times in each span of `longest`, and once a second at most.
  bool too_long(const Child& child);
  std::chrono::milliseconds longest() const { return longest_; }

 private:
  using Clock = std::chrono::steady_clock;
  std::chrono::milliseconds longest_;
  Clock::time_point since_ = Clock::now(), looked_ = since_;
  std::optional<std::uint64_t> activity_;
};

}  // namespace fovea::points
