// The program `fovea`: SystemC's entry point, signals, standard streams and exit status.
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <systemc>

#include "sw/fovea/cli/cli.h"
#include "sw/fovea/probes/tool_rows.h"

namespace {

/// Opens standard streams that were closed when the program was started. Otherwise a result file
/// could get descriptor 1 or 2, and messages would be written into it.
void open_standard_streams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd)
    if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF &&
        ::open("/dev/null", fd == STDIN_FILENO ? O_RDONLY : O_WRONLY) != fd)
      std::_Exit(fovea::app::kExitWrongInput);
}

/// True if the reader of a pipe has closed its end, as `head` does once it has enough.
bool reader_has_left(int fd) {
  pollfd p{fd, POLLOUT, 0};
  return ::poll(&p, 1, 0) > 0 && (p.revents & POLLERR) != 0;
}

/// Standard output that could not be written is an error of the run.
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
                     .make_machine = make_machine,
                     .tools = tool_rows()};
  install_signals(context);
  const int status = check_output(run_cli({argv + 1, argv + argc}, context));
  // Ends without destructors, whose order relative to those of the SystemC kernel is not defined.
  // All files are closed by now.
  std::cerr.flush();
  std::fflush(nullptr);
  std::quick_exit(status);
}

int main(int argc, char** argv) {
  open_standard_streams();
  // Suppresses SystemC's banner, unless the user has set the variable.
  ::setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 0);
  return sc_core::sc_elab_and_sim(argc, argv);
}
