// A defect in each reader's way, for a build that is to show that the fuzzer reaches it (FOVEA_FUZZ_PLANTED).
#pragma once
#include <cstdio>

namespace fovea::fuzz {

/// Ends the process in such a build if `found`: a property that no file of the corpus has, and that only an input has
/// that the reader took. Otherwise without effect.
inline void planted([[maybe_unused]] bool found) {
#ifdef FOVEA_FUZZ_PLANTED
  if (!found) return;
  std::fputs("planted defect\n", stderr);
  __builtin_trap();
#endif
}

}  // namespace fovea::fuzz
