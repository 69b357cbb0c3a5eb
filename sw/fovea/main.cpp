// The program `fovea`. The only file of the host program that knows SystemC.
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <systemc>

#include "sw/fovea/cli.h"

int sc_main(int argc, char** argv) {
  using namespace fovea::app;
  CliContext context{.out = std::cout,
                     .err = std::cerr,
                     .terminal = ::isatty(STDERR_FILENO) == 1,
                     .make_simulation = make_simulation,
                     .make_executor = make_executor};
  install_signals(context);
  const int status = run_cli({argv + 1, argv + argc}, context);
  // Without destructors: the kernel's own state must not outlive or predecease ours in an order
  // that nobody controls, and all files are closed by now.
  std::cout.flush();
  std::cerr.flush();
  std::fflush(nullptr);
  std::quick_exit(status);
}

int main(int argc, char** argv) {
  // SystemC prints a banner from here unless told otherwise.
  ::setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 0);
  return sc_core::sc_elab_and_sim(argc, argv);
}
