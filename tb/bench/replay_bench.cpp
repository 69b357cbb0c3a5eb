// Host speed of the replay in requests (items of 32 bytes) per second. The counter `rows`, the
// memory rows opened per request, shows how much work the controller had. Not a test.
#include <benchmark/benchmark.h>

#include "sw/fovea/replay/replay_path.h"
#include "tb/bench/synthetic_trace.h"

namespace fovea::app {
namespace {

/// Arguments: masters, requests, reads that each may have in flight.
void replay(benchmark::State& state, Pattern pattern, bool memory_only) {
  ReplayParams params;
  ParamSet set;
  params.declare(set);
  const auto count = static_cast<std::uint64_t>(state.range(1));
  double rows = 0;
  for (auto _ : state) {
    SyntheticTrace source(static_cast<unsigned>(state.range(0)), count, pattern,
                          static_cast<unsigned>(state.range(2)));
    ReplayPath path("synthetic", source.info, source, params, memory_only);
    benchmark::DoNotOptimize(path.run_before(kNever));
    rows = static_cast<double>(path.memory().activates.count());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * count));
  state.counters["rows"] = rows / static_cast<double>(count);
}

void arguments(benchmark::internal::Benchmark* b, int in_flight) {
  b->ArgNames({"masters", "requests", "window"})->Unit(benchmark::kMillisecond);
  for (const int masters : {1, 4, 10})
    for (const int count : {1'000'000, 10'000'000})
      b->Args({masters, count, in_flight ? in_flight / masters : static_cast<int>(kWindow)});
}
/// A window for each master.
void each(benchmark::internal::Benchmark* b) { arguments(b, 0); }
/// As much in flight with one master as with ten.
void equal(benchmark::internal::Benchmark* b) { arguments(b, 40); }

BENCHMARK_CAPTURE(replay, dealt, Pattern::kDealt, false)->Apply(equal);
BENCHMARK_CAPTURE(replay, random_equal, Pattern::kRandom, false)->Apply(equal);
BENCHMARK_CAPTURE(replay, sequential, Pattern::kSequential, false)->Apply(each);
BENCHMARK_CAPTURE(replay, apart, Pattern::kApart, false)->Apply(each);
BENCHMARK_CAPTURE(replay, random, Pattern::kRandom, false)->Apply(each);
BENCHMARK_CAPTURE(replay, sequential_memory_only, Pattern::kSequential, true)->Apply(each);
BENCHMARK_CAPTURE(replay, random_memory_only, Pattern::kRandom, true)->Apply(each);

}  // namespace
}  // namespace fovea::app
