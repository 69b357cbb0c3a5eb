#include "sw/fovea/machine/host_instructions.h"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace fovea::app {

HostInstructions::HostInstructions() {
  perf_event_attr what{};
  what.size = sizeof what;
  what.type = PERF_TYPE_HARDWARE;
  what.config = PERF_COUNT_HW_INSTRUCTIONS;
  what.exclude_kernel = 1;
  what.exclude_hv = 1;
  file_ = static_cast<int>(::syscall(SYS_perf_event_open, &what, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
}

HostInstructions::~HostInstructions() {
  if (file_ >= 0) ::close(file_);
}

std::optional<std::uint64_t> HostInstructions::count() const {
  std::uint64_t n = 0;
  if (file_ < 0 || ::read(file_, &n, sizeof n) != static_cast<ssize_t>(sizeof n)) return std::nullopt;
  return n;
}

}  // namespace fovea::app
