// `fovea` with a difference between the RTL of the remap engine and its model: its first argument says in which write
// of the twin a bit is wrong; the others are those of the program.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <systemc>

#include "model/engine/backends.h"
#include "sw/fovea/cli/cli.h"
#include "sw/fovea/probes/tool_rows.h"

int sc_main(int argc, char** argv) {
  using namespace fovea::app;
  if (argc < 2) return kExitWrongInput;
  fovea::engine::planted_difference = std::strtoull(argv[1], nullptr, 10);
  const CliContext context{.out = std::cout,
                           .err = std::cerr,
                           .make_machine = make_machine,
                           .tools = tool_rows()};
  const int status = run_cli({argv + 2, argv + argc}, context);
  std::cout.flush();
  std::cerr.flush();
  std::quick_exit(status);
}
