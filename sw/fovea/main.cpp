// The program `fovea`. The only file of the host program that knows SystemC.
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <systemc>

#include "sw/fovea/cli.h"

namespace {

/// A file that is opened takes the lowest free descriptor. If that is 1 or 2, since the program was
/// started with a closed stream, messages would go into a file of results.
void open_standard_streams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd)
    if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF &&
        ::open("/dev/null", fd == STDIN_FILENO ? O_RDONLY : O_WRONLY) != fd)
      std::_Exit(fovea::app::kExitWrongInput);
}

/// True if a reader has closed its end of the pipe, as `head` does: it has all it wants.
bool reader_has_left(int fd) {
  pollfd p{fd, POLLOUT, 0};
  return ::poll(&p, 1, 0) > 0 && (p.revents & POLLERR) != 0;
}

/// Text that did not reach the standard output is an error of the run.
int check_output(int status) {
  std::cout.flush();
  if (std::cout || reader_has_left(STDOUT_FILENO)) return status;
  std::cerr << "fovea: error: the standard output cannot be written, its text is lost\n";
  return status == fovea::app::kExitDone ? fovea::app::kExitWrongInput : status;
}

}  // namespace

int sc_main(int argc, char** argv) {
  using namespace fovea::app;
  CliContext context{.out = std::cout,
                     .err = std::cerr,
                     .terminal = ::isatty(STDERR_FILENO) == 1,
                     .make_simulation = make_simulation,
                     .make_executor = make_executor};
  install_signals(context);
  const int status = check_output(run_cli({argv + 1, argv + argc}, context));
  // Without destructors: the kernel's own state must not outlive or predecease ours in an order
  // that nobody controls, and all files are closed by now.
  std::cerr.flush();
  std::fflush(nullptr);
  std::quick_exit(status);
}

int main(int argc, char** argv) {
  open_standard_streams();
  // SystemC prints a banner from here unless told otherwise.
  ::setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 0);
  return sc_core::sc_elab_and_sim(argc, argv);
}
