#include "sw/fovea/points/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::points {
namespace {

/// What the child does between fork and exec: only what a signal handler may do.
[[noreturn]] void become(char* const* arguments, const char* output, const char* messages,
                         pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(128 + SIGTERM);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int flags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW;
  const int in = ::open("/dev/null", O_RDONLY);
  const int out = ::open(output, flags, 0666), err = ::open(messages, flags, 0666);
  if (in < 0 || out < 0 || err < 0 || ::dup2(in, STDIN_FILENO) < 0 ||
      ::dup2(out, STDOUT_FILENO) < 0 || ::dup2(err, STDERR_FILENO) < 0)
    ::_exit(127);
  for (const int fd : {in, out, err})
    if (fd > STDERR_FILENO) ::close(fd);
  ::execv(arguments[0], arguments);
  ::_exit(127);
}

}  // namespace

Child::Child(const std::vector<std::string>& arguments, const std::filesystem::path& output,
             const std::filesystem::path& messages) {
  std::vector<std::string> copies = arguments;  // execv() takes words that are not const
  std::vector<char*> pointers;
  for (std::string& a : copies) pointers.push_back(a.data());
  pointers.push_back(nullptr);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ == 0) become(pointers.data(), output.c_str(), messages.c_str(), parent);
  if (pid_ < 0)
    throw UserError(fmt::format("'{}' cannot be started: {}", app::one_line(arguments[0]),
                                std::strerror(errno)));
}

Child::~Child() {
  if (ended()) return;
  kill();
  int state = 0;
  while (::waitpid(pid_, &state, 0) < 0 && errno == EINTR) {
  }
}

std::optional<Ended> Child::ended() {
  if (ended_) return ended_;
  int state = 0;
  if (::waitpid(pid_, &state, WNOHANG) != pid_) return std::nullopt;
  if (WIFEXITED(state))
    ended_ = Ended{WEXITSTATUS(state), 0};
  else
    ended_ = Ended{128 + WTERMSIG(state), WTERMSIG(state)};
  return ended_;
}

void Child::ask_to_end() { signal(SIGTERM); }
void Child::kill() { signal(SIGKILL); }

/// The number cannot have passed to another process, since this process has not waited for it yet.
void Child::signal(int number) {
  if (!ended()) ::kill(pid_, number);
}

}  // namespace fovea::points
