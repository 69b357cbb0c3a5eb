#include "model/common/check.h"

#include <cstdio>
#include <cstdlib>

namespace fovea {

void check_failed(const char* expression, const char* file, int line, const std::string& what) {
  std::fprintf(stderr, "fovea: own defect: %s (%s) at %s:%d\n", what.c_str(), expression, file,
               line);
  std::fflush(nullptr);
  // quick_exit: no destructor of a half-consistent model runs; status 4 is the contract.
  std::quick_exit(4);
}

Diagnostics& Diagnostics::instance() {
  static Diagnostics d;
  return d;
}

void Diagnostics::not_modelled(const std::string& what) {
  note(Kind::kNotModelled, what);
  if (strict_) throw NotModelled("not modelled: " + what);
}

void Diagnostics::note(Kind kind, const std::string& what) {
  if (++counts_[{kind, what}] == 1 && sink_) sink_(kind, what);
}

}  // namespace fovea
