#include "sw/fovea/console/host_console.h"

#include <errno.h>
#include <poll.h>
#include <unistd.h>

#include <ostream>

namespace fovea::app {

std::size_t HostConsole::read(std::span<std::uint8_t> to) {
  out_.flush();
  for (;;) {
    pollfd p{STDIN_FILENO, POLLIN, 0};
    const int ready = ::poll(&p, 1, 100);
    if (stop_ && stop_->load()) return 0;
    if (ready <= 0) {
      if (go_on && !go_on()) return 0;
      continue;
    }
    const ssize_t n = ::read(STDIN_FILENO, to.data(), to.size());
    if (n < 0 && errno == EINTR) continue;
    return n < 0 ? 0 : static_cast<std::size_t>(n);
  }
}

bool HostConsole::write(bool error_stream, std::string_view text) {
  if (error_stream) {
    out_.flush();
    err_ << text << std::flush;
  } else {
    out_ << text;
    if (text.find('\n') != std::string_view::npos) out_.flush();
  }
  if (!out_) lost_ = true;
  return !lost_;
}

}  // namespace fovea::app
