#include "sw/fovea/files/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

extern char** environ;

namespace fovea::app {
namespace {

constexpr std::size_t kKeptMessageBytes = 4096;
/// Interval in which the stop flag and the time are looked at.
constexpr std::chrono::milliseconds kLook{100};
/// The same where the child is about to end: it has closed its streams.
constexpr std::chrono::milliseconds kEndLook{2};

/// The process groups of the children that run; 0: free. More at once than a run has: footage is decoded one after the
/// other. One for which there is no place is only missed by kill_children().
std::array<std::atomic<pid_t>, 16> g_groups{};
static_assert(std::atomic<pid_t>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

void replace_group(pid_t was, pid_t now) {
  for (auto& group : g_groups)
    if (pid_t expected = was; group.compare_exchange_strong(expected, now)) return;
}

void close_fd(int& fd) {
  if (fd >= 0) ::close(std::exchange(fd, -1));
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, Stream data,
                           const std::string& purpose, const Patience& patience, int stdin_fd)
    : purpose_(purpose), program_(one_line(command[0])), patience_(patience), last_(Clock::now()) {
  std::vector<std::string> words = command;  // posix_spawnp() takes words that are not const
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  // A socket instead of a pipe, because send() can be told not to raise SIGPIPE.
  std::array<int, 2> stream{}, errors{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, stream.data()) != 0)
    throw UserError(fmt::format("{}: {}", purpose, std::strerror(errno)));
  if (::pipe2(errors.data(), O_CLOEXEC) != 0) {
    const int reason = errno;
    ::close(stream[0]);
    ::close(stream[1]);
    throw UserError(fmt::format("{}: {}", purpose, std::strerror(reason)));
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const bool input = data == Stream::kInput;
  if (stdin_fd >= 0)
    posix_spawn_file_actions_adddup2(&actions, stdin_fd, 0);
  else
    posix_spawn_file_actions_addopen(&actions, input ? 1 : 0, "/dev/null", O_RDWR, 0);
  posix_spawn_file_actions_adddup2(&actions, stream[1], input ? 0 : 1);
  posix_spawn_file_actions_adddup2(&actions, errors[1], 2);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults, mask;
  sigemptyset(&mask);
  sigemptyset(&defaults);
  for (const int signal : {SIGPIPE, SIGXFSZ, SIGINT, SIGTERM}) sigaddset(&defaults, signal);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setsigmask(&attributes, &mask);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  const int result = ::posix_spawnp(&pid_, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  ::close(stream[1]);
  ::close(errors[1]);
  data_ = stream[0];
  error_ = errors[0];
  if (result != 0) {
    pid_ = -1;
    close_fd(data_);
    close_fd(error_);
    throw UserError(fmt::format(
        "{}: the program '{}' {}", purpose, program_,
        result == ENOENT ? "was not found; install it (package ffmpeg), or use PNG pictures"
                         : std::string("cannot be started: ") + std::strerror(result)));
  }
  replace_group(0, pid_);
  // Messages are read while data are transferred; neither stream may block because of the other.
  ::fcntl(error_, F_SETFL, O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
  close_fd(data_);
  close_fd(error_);
  if (pid_ <= 0) return;
  // The child leads a process group of its own: kill everything that it has started, too.
  ::kill(-pid_, SIGKILL);
  replace_group(pid_, 0);
  while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
  }
}

void ChildProcess::read_messages() {
  std::array<char, 1024> chunk{};
  while (error_ >= 0) {
    const ssize_t n = ::read(error_, chunk.data(), chunk.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) return;
    if (n <= 0) {
      close_fd(error_);
      return;
    }
    const std::size_t room = kKeptMessageBytes - std::min(kKeptMessageBytes, messages_.size());
    messages_.append(chunk.data(), std::min(room, static_cast<std::size_t>(n)));
  }
}

/// @throws Stopped or UserError if the child is waited for no longer
void ChildProcess::check_patience() const {
  const auto silent = Clock::now() - last_;
  if (patience_.stop && patience_.stop->load() && silent >= patience_.silence_after_stop) throw Stopped();
  if (silent < patience_.silence) return;
  throw UserError(fmt::format("{}: '{}' has not gone on for {} s; is its input or output on a disk that does not "
                              "answer?",
                              purpose_, program_,
                              std::chrono::duration_cast<std::chrono::seconds>(patience_.silence).count()));
}

/// Waits for one of `events` on the data stream, collects messages, and says in `ready` what there is. 0: nothing yet.
void ChildProcess::wait(short events, short& ready) {
  check_patience();
  std::array<pollfd, 2> fds{{{data_, events, 0}, {error_, POLLIN, 0}}};
  const int count = ::poll(fds.data(), fds.size(), static_cast<int>(kLook.count()));
  ready = count > 0 ? fds[0].revents : static_cast<short>(0);
  if (count < 0 && errno != EINTR) ready = POLLERR;
  if (count > 0 && fds[1].revents != 0) read_messages();
}

bool ChildProcess::read_some(std::string& buffer) {
  std::array<char, 64 * 1024> chunk;
  for (;;) {
    short ready = 0;
    wait(POLLIN, ready);
    if (ready == 0) continue;
    const ssize_t n = ::recv(data_, chunk.data(), chunk.size(), MSG_DONTWAIT);
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    last_ = Clock::now();
    if (n <= 0) return false;
    buffer.append(chunk.data(), static_cast<std::size_t>(n));
    return true;
  }
}

bool ChildProcess::write_all(const std::uint8_t* bytes, std::size_t size) {
  last_ = Clock::now();  // until now it had nothing to do
  while (size > 0) {
    short ready = 0;
    wait(POLLOUT, ready);
    if (ready == 0) continue;
    const ssize_t n = ::send(data_, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (n < 0) return false;
    last_ = Clock::now();
    bytes += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

bool ChildProcess::ended() {
  if (pid_ > 0 && ::waitpid(pid_, &status_, WNOHANG) == pid_) replace_group(std::exchange(pid_, -1), 0);
  return pid_ <= 0;
}

int ChildProcess::finish() {
  close_fd(data_);
  last_ = Clock::now();
  // Its messages are read meanwhile, so that it never blocks on one. A process that keeps its streams open beyond its
  // end, such as a program that it has started, is not waited for.
  while (!ended()) {
    check_patience();
    pollfd fd{error_, POLLIN, 0};
    ::poll(&fd, 1, static_cast<int>((error_ >= 0 ? kLook : kEndLook).count()));
    read_messages();
  }
  read_messages();
  close_fd(error_);
  return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
}

void kill_children() {
  for (const auto& group : g_groups)
    if (const pid_t leader = group; leader > 0) ::kill(-leader, SIGKILL);
}

}  // namespace fovea::app
