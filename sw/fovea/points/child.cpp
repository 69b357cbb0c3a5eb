#include "sw/fovea/points/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::points {
namespace {

/// SIGKILL ends a process at once, unless it waits for a device.
constexpr auto kDying = std::chrono::seconds(5);

std::uint64_t size_of(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  return error ? 0 : bytes;
}

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
             const std::filesystem::path& messages)
    : output_(output), messages_(messages) {
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
  for (const auto until = std::chrono::steady_clock::now() + kDying; std::chrono::steady_clock::now() < until;) {
    if (ended()) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
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

/// proc(5): the name in parentheses may contain anything; then state, ten fields, and the times in clock ticks: in user
/// and kernel mode, and those of children that were waited for.
std::optional<std::uint64_t> Child::activity() const {
  std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
  std::string text;
  std::getline(file, text);
  const auto name_end = text.rfind(')');
  if (name_end == text.npos) return std::nullopt;
  std::istringstream fields(text.substr(name_end + 1));
  char state = 0;
  fields >> state;
  std::string skipped;
  for (unsigned n = 0; n < 10; ++n) fields >> skipped;
  std::uint64_t sum = size_of(output_) + size_of(messages_);
  for (unsigned n = 0; n < 4; ++n) {
    std::uint64_t ticks = 0;
    if (!(fields >> ticks)) return std::nullopt;
    sum += ticks;
  }
  return state == 'T' || state == 't' ? std::nullopt : std::optional(sum);
}

bool Silence::too_long(const Child& child) {
  const auto now = Clock::now();
  if (now - looked_ < std::min<std::chrono::milliseconds>(longest_ / 8, std::chrono::seconds(1))) return false;
  looked_ = now;
  const auto activity = child.activity();
  if (!activity || activity != activity_) since_ = now;
  activity_ = activity;
  return now - since_ > longest_;
}

void Child::ask_to_end() { signal(SIGTERM); }
void Child::kill() { signal(SIGKILL); }

/// The number cannot have passed to another process, since nobody has waited for it yet.
void Child::signal(int number) {
  if (!ended()) ::kill(pid_, number);
}

}  // namespace fovea::points
