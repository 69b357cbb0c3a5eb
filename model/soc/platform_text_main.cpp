// Prints the file that is named by its argument: registers.h or BLOCKS.md.
#include <cstdio>
#include <string>
#include <systemc>

#include "model/soc/platform_text.h"

int sc_main(int argc, char** argv) {
  const std::string which = argc == 2 ? argv[1] : "";
  if (which != "registers.h" && which != "BLOCKS.md") {
    std::fputs("usage: platform_text registers.h | BLOCKS.md\n", stderr);
    return 2;
  }
  const fovea::soc::PlatformText text = fovea::soc::platform_text();
  std::fputs((which == "registers.h" ? text.registers_h : text.blocks_md).c_str(), stdout);
  return 0;
}
