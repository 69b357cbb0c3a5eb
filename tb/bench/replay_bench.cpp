// Host speed of the replay: requests a second. Items are requests of 32 bytes. Not a test.
#include <benchmark/benchmark.h>

#include "sw/fovea/replay_path.h"
#include "tb/bench/synthetic_trace.h"

namespace fovea::app {
namespace {

/// Arguments: masters, requests.
void replay(benchmark::State& state, Pattern pattern, bool memory_only) {
  ReplayParams params;
  ParamSet set;
  params.declare(set);
  const auto count = static_cast<std::uint64_t>(state.range(1));
  for (auto _ : state) {
    SyntheticTrace source(static_cast<unsigned>(state.range(0)), count, pattern);
    ReplayPath path("synthetic", source.info, source, params, memory_only);
    benchmark::DoNotOptimize(path.run_before(kNever));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * count));
}

void arguments(benchmark::internal::Benchmark* b) {
  b->ArgNames({"masters", "requests"})->Unit(benchmark::kMillisecond);
  for (const int masters : {1, 4, 10})
    for (const int count : {1'000'000, 10'000'000}) b->Args({masters, count});
}

BENCHMARK_CAPTURE(replay, sequential, Pattern::kSequential, false)->Apply(arguments);
BENCHMARK_CAPTURE(replay, apart, Pattern::kApart, false)->Apply(arguments);
BENCHMARK_CAPTURE(replay, random, Pattern::kRandom, false)->Apply(arguments);
BENCHMARK_CAPTURE(replay, sequential_memory_only, Pattern::kSequential, true)->Apply(arguments);
BENCHMARK_CAPTURE(replay, random_memory_only, Pattern::kRandom, true)->Apply(arguments);

}  // namespace
}  // namespace fovea::app
