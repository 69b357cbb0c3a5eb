// Line and toggle counts of a verilated model, for scripts/rtl-coverage; nothing in other builds.
#pragma once
#ifdef FOVEA_RTL_COVERAGE
#include <verilated_cov.h>

#include <cstdlib>
#include <string>
#endif

namespace fovea::rtl {

/// To be called before a model is deleted, while no other one exists. Writes what it has executed to a new file in the
/// folder RTL_COVERAGE.
inline void keep_coverage() {
#ifdef FOVEA_RTL_COVERAGE
  static unsigned number = 0;
  VerilatedCovContext* counts = Verilated::threadContextp()->coveragep();
  if (const char* folder = std::getenv("RTL_COVERAGE"))
    counts->write((std::string(folder) + "/" + std::to_string(++number) + ".dat").c_str());
  counts->clear();
#endif
}

}  // namespace fovea::rtl
