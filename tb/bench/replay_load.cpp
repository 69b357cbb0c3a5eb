// Replays one kind of synthetic trace, for an instruction counter: see replay_instructions.sh.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "sw/fovea/replay/replay_path.h"
#include "tb/bench/synthetic_trace.h"

int main(int argc, char** argv) {
  using namespace fovea;
  using namespace fovea::app;
  const bool counted = argc == 4 || argc == 5;
  const std::string_view kind = counted ? argv[1] : "";
  const auto number = [&](int i) {
    return i < argc ? static_cast<unsigned>(std::strtoul(argv[i], nullptr, 10)) : 0u;
  };
  constexpr std::array<std::pair<std::string_view, Pattern>, 4> kKinds{
      {{"sequential", Pattern::kSequential},
       {"apart", Pattern::kApart},
       {"dealt", Pattern::kDealt},
       {"random", Pattern::kRandom}}};
  const auto* const pattern =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& k) { return k.first == kind; });
  const unsigned masters = counted ? number(2) : 0;
  const unsigned window = argc == 5 ? number(4) : kWindow;
  if (pattern == kKinds.end() || masters == 0 || masters > 10 || window == 0 || window > 48) {
    std::fprintf(stderr,
                 "usage: bench_replay_load sequential|apart|dealt|random MASTERS REQUESTS [WINDOW]\n");
    return 2;
  }
  ReplayParams params;
  ParamSet set;
  params.declare(set);
  SyntheticTrace source(masters, number(3), pattern->second, window);
  ReplayPath path("synthetic", source.info, source, params, false);
  path.run_before(kNever);
  path.finish();
  const mem::DdrStats& ddr = path.memory();
  std::printf("%llu requests in %llu ps, %llu activates\n",
              static_cast<unsigned long long>(path.requests()),
              static_cast<unsigned long long>(path.duration()),
              static_cast<unsigned long long>(ddr.activates.count()));
}
