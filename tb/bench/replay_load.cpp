// Plays one kind of synthetic trace, for an instruction counter: see replay_instructions.sh.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "sw/fovea/replay_path.h"
#include "tb/bench/synthetic_trace.h"

int main(int argc, char** argv) {
  using namespace fovea;
  using namespace fovea::app;
  const std::string_view kind = argc == 4 ? argv[1] : "";
  const unsigned long masters = argc == 4 ? std::strtoul(argv[2], nullptr, 10) : 0;
  if ((kind != "sequential" && kind != "apart" && kind != "random") || masters == 0 ||
      masters > kMasterCount) {
    std::fprintf(stderr, "usage: bench_replay_load sequential|apart|random MASTERS REQUESTS\n");
    return 2;
  }
  ReplayParams params;
  ParamSet set;
  params.declare(set);
  SyntheticTrace source(static_cast<unsigned>(masters), std::strtoul(argv[3], nullptr, 10),
                        kind == "random"  ? Pattern::kRandom
                        : kind == "apart" ? Pattern::kApart
                                          : Pattern::kSequential);
  ReplayPath path("synthetic", source.info, source, params, false);
  path.run_before(kNever);
  path.finish();
  std::printf("%llu requests in %llu ps\n", static_cast<unsigned long long>(path.requests()),
              static_cast<unsigned long long>(path.duration()));
}
