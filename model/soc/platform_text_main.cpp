// Prints the text that is named by its argument.
#include <cstdio>
#include <string>
#include <systemc>

#include "model/soc/platform_text.h"
#include "model/soc/rtl_text.h"

int sc_main(int argc, char** argv) {
  const std::string which = argc == 2 ? argv[1] : "";
  std::string text;
  if (which == "registers.h") {
    text = fovea::soc::platform_text().registers_h;
  } else if (which == "BLOCKS.md") {
    text = fovea::soc::platform_text().blocks_md;
  } else if (which == "remap_regs_pkg.sv") {
    text = fovea::soc::rtl_text().package;
  } else if (which == "rtl-registers") {
    text = fovea::soc::rtl_text().table;
  } else {
    std::fputs("usage: platform_text registers.h | BLOCKS.md | remap_regs_pkg.sv | rtl-registers\n", stderr);
    return 2;
  }
  std::fputs(text.c_str(), stdout);
  return 0;
}
