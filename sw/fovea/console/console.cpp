#include "sw/fovea/console/console.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <ostream>

namespace fovea::app {
namespace {

// Used by signal handlers: plain objects that are written before the flag is set.
termios g_former;
int g_fd = -1;
volatile sig_atomic_t g_raw = 0;

/// Signals that end the process and are not handled elsewhere.
constexpr int kDeadly[] = {SIGHUP, SIGQUIT, SIGILL, SIGABRT, SIGBUS, SIGFPE, SIGSEGV};

void restore_and_die(int signal) {
  RawTerminal::restore();
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

}  // namespace

RawTerminal::RawTerminal(int fd) {
  if (::tcgetattr(fd, &g_former) != 0) return;
  g_fd = fd;
  static const bool once = [] {
    std::atexit(restore);
    std::at_quick_exit(restore);
    return true;
  }();
  (void)once;
  for (const int s : kDeadly) {
    struct sigaction action {};
    action.sa_handler = restore_and_die;
    sigemptyset(&action.sa_mask);
    ::sigaction(s, &action, nullptr);
  }
  termios raw = g_former;
  raw.c_iflag &= ~static_cast<tcflag_t>(IGNBRK | BRKINT | PARMRK | ISTRIP | INLCR | IGNCR | ICRNL |
                                        IXON);
  raw.c_lflag &= ~static_cast<tcflag_t>(ECHO | ECHONL | ICANON | ISIG | IEXTEN);
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  g_raw = 1;
  ::tcsetattr(fd, TCSANOW, &raw);
}

RawTerminal::~RawTerminal() { restore(); }

void RawTerminal::restore() {
  if (!g_raw) return;
  g_raw = 0;
  const int error = errno;
  ::tcsetattr(g_fd, TCSANOW, &g_former);
  errno = error;
}

ConsoleStream::ConsoleStream(std::ostream& out, int in_fd, const std::atomic<bool>& stop)
    : out_(out), in_(in_fd), stop_(stop), interactive_(in_fd >= 0 && ::isatty(in_fd) == 1) {}

void ConsoleStream::show(std::uint8_t byte) { out_.put(static_cast<char>(byte)); }

void ConsoleStream::flush() { out_.flush(); }

bool ConsoleStream::lost() const { return !out_; }

std::string ConsoleStream::keys() {
  constexpr char kCtrlA = 1;
  std::string out;
  for (;;) {
    pollfd p{in_, POLLIN, 0};
    if (ended_ || ::poll(&p, 1, 0) <= 0) return out;
    char key = 0;
    const ssize_t n = ::read(in_, &key, 1);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      ended_ = true;
      return out;
    }
    if (escape_) {
      escape_ = false;
      if (key == 'x' || key == 'X') quit_ = true;
      else if (key == kCtrlA) out += key;
    } else if (key == kCtrlA) {
      escape_ = true;
    } else {
      out += key;
    }
  }
}

std::optional<std::uint8_t> ConsoleStream::next() {
  while (taken_ == block_.size()) {
    if (in_ < 0 || ended_) return std::nullopt;
    out_.flush();
    pollfd p{in_, POLLIN, 0};
    const int ready = ::poll(&p, 1, 100);
    if (stop_.load()) return std::nullopt;
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    block_.resize(4096);
    const ssize_t n = ready < 0 ? -1 : ::read(in_, block_.data(), block_.size());
    taken_ = 0;
    block_.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    if (n < 0 && errno == EINTR) continue;
    ended_ = n <= 0;
  }
  return static_cast<std::uint8_t>(block_[taken_++]);
}

}  // namespace fovea::app
