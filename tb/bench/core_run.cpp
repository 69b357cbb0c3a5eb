// core_run FILE [CLOCKS [profile]]: runs a program on the core alone, with a profile or without, and
// prints instructions, clocks and seconds.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>

#include "model/cpu/core/isa.h"
#include "tb/bench/core_rig.h"

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "core_run FILE [CLOCKS [profile]]\n");
    return 2;
  }
  fovea::cpu::CoreRig rig(argv[1], argc > 2 ? std::strtoull(argv[2], nullptr, 0) : 0);
  if (argc > 3 && std::strcmp(argv[3], "profile") == 0) rig.core.start_profile();
  fovea::cpu::isa_row(0, false);  // the first look-up builds the decoder's tables
  const std::clock_t begin = std::clock();
  rig.run();
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const auto n = static_cast<unsigned long long>(rig.core.counts().instructions);
  const auto clocks = static_cast<unsigned long long>(rig.core.clock_count());
  std::printf("%llu instructions %llu clocks %.3f s %.1f MIPS\n", n, clocks, seconds,
              static_cast<double>(n) / seconds / 1e6);
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "core_run: %s\n", e.what());
  return 2;
}
