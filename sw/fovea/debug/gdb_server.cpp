// The socket of the GDB server: one listener, one debugger.
#include "sw/fovea/debug/gdb_server.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <charconv>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

constexpr int kPollMs = 100;  // interval in which the process's stop flag is checked, in ms

/// GDB begins with an acknowledgement, a packet or an interrupt byte.
bool begins_like_gdb(char c) { return c == '+' || c == '-' || c == '$' || c == '\x03'; }

bool readable(int fd, int timeout_ms) {
  pollfd p{fd, POLLIN, 0};
  return ::poll(&p, 1, timeout_ms) > 0;
}

}  // namespace

std::uint16_t parse_gdb_port(const std::string& text) {
  const std::string_view digits = std::string_view(text).substr(text.starts_with(':') ? 1 : 0);
  std::uint16_t port = 0;
  const char* const end = digits.data() + digits.size();
  const auto [stopped, error] = std::from_chars(digits.data(), end, port);
  if (error != std::errc() || stopped != end || digits.empty())
    throw UserError(
        fmt::format("--gdb: '{}' is not a valid port; allowed: :0 (any free port) to :65535 "
                    "(localhost only)",
                    one_line(text)));
  return port;
}

GdbServer::GdbServer(std::uint16_t port, GdbTarget& target, const std::atomic<bool>& stop)
    : protocol_(target), target_(target), stop_(stop) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  socklen_t size = sizeof address;
  auto* const a = reinterpret_cast<sockaddr*>(&address);
  const int on = 1;
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (listener_ >= 0) ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (listener_ < 0 || ::bind(listener_, a, size) != 0 || ::listen(listener_, 8) != 0 ||
      ::getsockname(listener_, a, &size) != 0) {
    const std::string why = ::strerror(errno);
    if (listener_ >= 0) ::close(listener_);
    throw UserError(fmt::format("--gdb: cannot listen on 127.0.0.1:{}: {}; :0 takes a free port",
                                port, why));
  }
  port_ = ntohs(address.sin_port);
}

GdbServer::~GdbServer() {
  drop();
  ::close(listener_);
}

void GdbServer::drop() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  running_ = false;
  framer_.clear();
}

bool GdbServer::connect(int timeout_ms) {
  if (!readable(listener_, timeout_ms)) return false;
  socket_ = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  if (socket_ < 0) return false;
  const int on = 1;
  ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  framer_.clear();
  silent_ = true;
  return true;
}

/// Handles connections of further clients: a second debugger would otherwise wait for the first one
/// without a message. It replaces a client that has never sent anything.
void GdbServer::handle_other_clients() {
  if (!readable(listener_, 0)) return;
  if (silent_) {
    drop();
    connect(0);
    return;
  }
  const int other = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  if (other >= 0) ::close(other);
}

/// Further clients are only handled if the connected one has sent nothing: it may have left.
GdbServer::Io GdbServer::receive(int timeout_ms) {
  if (!readable(socket_, timeout_ms)) {
    handle_other_clients();
    return Io::kNothing;
  }
  std::array<char, 4096> bytes;
  const ssize_t n = ::recv(socket_, bytes.data(), bytes.size(), 0);
  if (n < 0 && (errno == EINTR || errno == EAGAIN)) return Io::kNothing;
  if (n <= 0 || (silent_ && !begins_like_gdb(bytes[0]))) return Io::kClosed;
  silent_ = false;
  framer_.feed({bytes.data(), static_cast<std::size_t>(n)});
  return Io::kSome;
}

void GdbServer::send(std::string_view payload) {
  last_sent_ = gdb_frame(payload);
  std::string_view left = last_sent_;
  while (!left.empty()) {
    const ssize_t n = ::send(socket_, left.data(), left.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;  // the next receive() reports the error
    left.remove_prefix(static_cast<std::size_t>(n));
  }
}

GdbResume GdbServer::serve(const GdbStop& stop) {
  if (attached()) {
    protocol_.stopped(stop);
    if (running_) {
      if (!stop.note.empty()) send(GdbProtocol::console(stop.note));
      send(protocol_.stop_reply());
    }
    running_ = false;
  }
  for (;;) {
    if (stop_.load()) return {.kind = GdbResume::Kind::kKill};
    if (socket_ < 0) {
      connect(kPollMs);
      continue;
    }
    const auto event = framer_.next();
    if (!event) {
      const bool newcomer = silent_;
      const Io io = receive(kPollMs);
      if (newcomer && io == Io::kSome) protocol_.begin(stop);
      if (io == Io::kClosed) {
        // A debugger that disconnects without a packet leaves the target as it is, for the next
        // debugger.
        if (!newcomer) target_.clear_all_points();
        drop();
      }
      continue;
    }
    using Kind = GdbFramer::Event::Kind;
    switch (event->kind) {
      case Kind::kAck:
      case Kind::kInterrupt: continue;  // the target is already stopped
      case Kind::kNak:
        if (!protocol_.no_ack() && !last_sent_.empty())
          ::send(socket_, last_sent_.data(), last_sent_.size(), MSG_NOSIGNAL);
        continue;
      case Kind::kBroken:
        if (!protocol_.no_ack()) ::send(socket_, "-", 1, MSG_NOSIGNAL);
        continue;
      case Kind::kPacket: break;
    }
    if (!protocol_.no_ack()) ::send(socket_, "+", 1, MSG_NOSIGNAL);
    const auto answer = protocol_.handle(event->payload);
    for (const auto& text : answer.output) send(text);
    if (answer.payload) send(*answer.payload);
    if (answer.detached) drop();
    if (answer.resume) {
      running_ = socket_ >= 0;
      return *answer.resume;
    }
  }
}

bool GdbServer::wants_halt() {
  if (socket_ < 0 && !connect(0)) return false;
  const bool newcomer = silent_;
  const Io io = receive(0);
  if (newcomer) {
    if (io == Io::kClosed) drop();
    if (io != Io::kSome) return false;
    protocol_.begin({});
    return true;
  }
  if (io == Io::kClosed) {
    target_.clear_all_points();
    drop();
    return false;
  }
  bool halt = false;
  while (const auto event = framer_.next())
    if (event->kind == GdbFramer::Event::Kind::kInterrupt) halt = true;
  return halt;
}

void GdbServer::exited(int status, bool by_signal) {
  if (!attached()) return drop();
  if (running_) send(fmt::format("{}{:02x}", by_signal ? 'X' : 'W', status & 0xFF));
  // A reset of the connection would discard data that are still on their way to the debugger.
  ::shutdown(socket_, SHUT_WR);
  for (int tries = 0; tries < 10; ++tries)
    if (receive(kPollMs) == Io::kClosed) break;
  drop();
}

}  // namespace fovea::app
