// A program that this process has started.
#pragma once
#include <sys/types.h>

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

/// One child. It has a process group of its own, so that a Ctrl-C in the terminal reaches only the
/// parent, which then ends its children itself; should the parent die, the kernel sends it SIGTERM.
class Child {
 public:
  /// Starts `arguments[0]`, with nothing on its standard input and the other streams in these files,
  /// which must not exist.
  /// @throws UserError if the host refuses; a program that cannot be executed ends with status 127
  Child(const std::vector<std::string>& arguments, const std::filesystem::path& output,
        const std::filesystem::path& messages);
  /// Kills it if it still runs.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// How it has ended; nothing while it runs. Does not wait.
  std::optional<Ended> ended();
  /// Sends SIGTERM or SIGKILL, if it still runs.
  void ask_to_end();
  void kill();

 private:
  void signal(int number);
  pid_t pid_ = -1;
  std::optional<Ended> ended_;
};

}  // namespace fovea::points
