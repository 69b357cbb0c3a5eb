// The GDB server over real connections: one debugger, acknowledgements, and anything else that may
// arrive.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <random>
#include <thread>

#include "model/common/check.h"
#include "tb/unit/gdb_fake_target.h"

namespace fovea::app {
namespace {

constexpr const char* kWhy = "$?#3f";
constexpr const char* kStopped = "$T02thread:1;#";

class Client {
 public:
  explicit Client(std::uint16_t port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in a{};
    a.sin_family = AF_INET;
    a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    a.sin_port = htons(port);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<sockaddr*>(&a), sizeof a), 0);
  }
  ~Client() { ::close(fd_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  void say(std::string_view text) {
    while (!text.empty()) {
      const ssize_t n = ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL);
      if (n <= 0) return;
      text.remove_prefix(static_cast<std::size_t>(n));
    }
  }
  /// What comes until `end` is in it, the connection ends or a second has passed.
  std::string hear(std::string_view end) {
    std::string out;
    pollfd p{fd_, POLLIN, 0};
    while (out.find(end) == std::string::npos && ::poll(&p, 1, 1000) > 0) {
      std::array<char, 4096> bytes;
      const ssize_t n = ::recv(fd_, bytes.data(), bytes.size(), 0);
      if (n <= 0) {
        closed = true;
        break;
      }
      out.append(bytes.data(), static_cast<std::size_t>(n));
    }
    return out;
  }
  std::string ask(std::string_view text, std::string_view end) { return say(text), hear(end); }
  /// Leaves, and waits until the server has seen it.
  void leave() {
    ::shutdown(fd_, SHUT_WR);
    while (!closed && !hear("#").empty()) {
    }
  }
  bool closed = false;

 private:
  int fd_;
};

struct GdbServerTest : testing::Test {
  test::FakeGdbTarget target;
  std::atomic<bool> stop{false};
  GdbServer server{0, target, stop};
  std::vector<GdbResume::Kind> resumed;
  std::thread thread{[this] {
    do resumed.push_back(server.serve({}).kind);
    while (resumed.back() != GdbResume::Kind::kKill);
  }};
  /// Ends the server; `resumed` may be looked at.
  void end() {
    stop = true;
    if (thread.joinable()) thread.join();
  }
  ~GdbServerTest() override { end(); }
};

TEST_F(GdbServerTest, ASecondDebuggerIsRefusedAndTheFirstGoesOn) {
  Client first(server.port());
  EXPECT_NE(first.ask(kWhy, "#").find(kStopped), std::string::npos);
  Client second(server.port());
  EXPECT_EQ(second.ask(kWhy, "#"), "");
  EXPECT_TRUE(second.closed);
  EXPECT_NE(first.ask(kWhy, "#").find(kStopped), std::string::npos);
}

// Programs that Fovea starts (ffmpeg, children of a study) must not keep the port or a debugger's connection.
TEST_F(GdbServerTest, ItsSocketsEndWithAnExec) {
  Client client(server.port());
  EXPECT_NE(client.ask(kWhy, "#").find(kStopped), std::string::npos);
  unsigned sockets = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    if (!std::filesystem::read_symlink(entry, gone).string().starts_with("socket:")) continue;
    const int fd = std::stoi(entry.path().filename());
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    if (::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0 || address.ss_family != AF_INET)
      continue;  // what the test was started with
    ++sockets;
    EXPECT_TRUE(::fcntl(fd, F_GETFD) & FD_CLOEXEC) << entry;
  }
  EXPECT_GE(sockets, 3u) << "the listener's, the connection's, and the client's here";
}

TEST_F(GdbServerTest, APortThatIsTakenIsSaidAndLeavesNothingOpen) {
  const auto open_files = [] {
    const auto begin = std::filesystem::directory_iterator("/proc/self/fd");
    return std::distance(begin, std::filesystem::directory_iterator());
  };
  const auto before = open_files();
  try {
    GdbServer second(server.port(), target, stop);
    FAIL() << "two servers on one port";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find(std::to_string(server.port()) + ": Address already in use"),
              std::string::npos)
        << error.what();
  }
  EXPECT_EQ(open_files(), before);
}

TEST_F(GdbServerTest, TheNextOneComesWhenTheFirstIsGone) {
  for (const char* last : {"", "$D#44", "$Z0,80"}) {
    Client client(server.port());
    EXPECT_NE(client.ask(kWhy, "#").find(kStopped), std::string::npos) << last;
    client.say("$Z0,8000,4#de");
    client.say(last);
  }
  Client client(server.port());
  EXPECT_NE(client.ask(kWhy, "#").find(kStopped), std::string::npos);
  client.ask("$k#6b", "#");
  end();
  EXPECT_EQ(resumed,
            (std::vector<GdbResume::Kind>{GdbResume::Kind::kContinue, GdbResume::Kind::kKill}));
  EXPECT_TRUE(target.points.empty()) << "they go with their debugger";
}

/// What a page in a browser can send: the packets are in the body.
TEST_F(GdbServerTest, ARequestOfABrowserIsCutOffUnheard) {
  for (const char* first : {"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", "GET / HTTP/1.1\r\n\r\n",
                            "\x16\x03\x01", " ", "\n"}) {
    Client browser(server.port());
    EXPECT_EQ(browser.ask(std::string(first) + "$P0=dead0000#0b" + kWhy, "#"), "") << first;
    EXPECT_TRUE(browser.closed) << first;
  }
  EXPECT_EQ(target.values[0], 0x11223344u);
  for (const char* first : {"+", "-", "\x03", ""}) {
    Client client(server.port());
    EXPECT_NE(client.ask(std::string(first) + kWhy, "#").find(kStopped), std::string::npos);
  }
}

TEST_F(GdbServerTest, WhoSaysNothingDoesNotKeepADebuggerAway) {
  Client silent(server.port());
  Client client(server.port());
  EXPECT_NE(client.ask(kWhy, "#").find(kStopped), std::string::npos);
  EXPECT_EQ(silent.hear("#"), "");
  EXPECT_TRUE(silent.closed);
}

TEST(GdbServerRunningTest, OnlyADebuggerHaltsARunningTarget) {
  test::FakeGdbTarget target;
  std::atomic<bool> stop{false};
  GdbServer server(0, target, stop);
  const auto halts = [&] {
    for (int i = 0; i < 20; ++i) {
      if (server.wants_halt()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  };
  {
    Client silent(server.port());
    EXPECT_FALSE(halts());
    EXPECT_FALSE(server.attached());
    Client browser(server.port());
    browser.say("POST / HTTP/1.1\r\n\r\n$P0=dead0000#0b");
    EXPECT_FALSE(halts());
    EXPECT_FALSE(server.attached());
  }
  Client client(server.port());
  client.say(kWhy);
  EXPECT_TRUE(halts());
  EXPECT_TRUE(server.attached());
}

TEST_F(GdbServerTest, AcknowledgementsAndRepeats) {
  Client c(server.port());
  const std::string answer = c.ask(kWhy, "#d4");
  EXPECT_EQ(answer, std::string("+") + kStopped + "d4");
  EXPECT_EQ(c.ask("-", "#d4"), answer.substr(1));
  EXPECT_EQ(c.ask("$?#00", "-"), "-");
  EXPECT_EQ(c.ask("$QStartNoAckMode#b0", "#9a"), "+$OK#9a");
  EXPECT_EQ(c.ask(std::string("+-$?#00") + kWhy, "#d4"), answer.substr(1))
      << "neither repeats nor complaints where nothing is acknowledged";
}

/// Noise, cut packets and packets that never end, each from a debugger of its own.
TEST_F(GdbServerTest, NothingThatArrivesEndsIt) {
  std::mt19937 rng(11);
  const std::string pieces[] = {
      "$", "#", "}",           "*",        "\x03",   "+",         "-",      "00",
      "?", "g", "m0,ffffffff", "X1000,4:", "qRcmd,", "vCont;s:1", "Z9,0,0", "qXfer:features:read:"};
  for (unsigned k = 0; k < 200; ++k) {
    Client c(server.port());
    std::string text;
    for (unsigned n = rng() % 60; n; --n) {
      text += pieces[rng() % std::size(pieces)];
      if (rng() % 4 == 0) text += static_cast<char>(rng());
    }
    if (k % 50 == 0) text = "$" + std::string(1u << 20, "x}*$"[k / 50]);
    c.say(text);
    c.leave();
    EXPECT_TRUE(c.closed) << k;
  }
  Client c(server.port());
  EXPECT_EQ(c.ask(kWhy, "#d4"), std::string("+") + kStopped + "d4");
}

}  // namespace
}  // namespace fovea::app
