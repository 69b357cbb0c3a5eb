// Host speed of the replay: requests a second. Items are requests of 32 bytes. Not a test.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "sw/fovea/replay_path.h"

namespace fovea::app {
namespace {

/// Requests without a file: what is measured is the player and the path.
class Synthetic : public trace::RecordSource {
 public:
  Synthetic(unsigned masters, std::uint64_t count, bool random) : random_(random) {
    for (unsigned m = 0; m < masters; ++m) {
      info.streams.emplace_back();
      info.masters.push_back(
          {port(m), std::string(kMasterNames[index(port(m))]), m, 8, 8, false});
      left_.push_back(count / masters);
      seeds_.push_back(m * 77 + 1);
    }
  }
  bool next(unsigned stream, trace::Record& r) override {
    if (left_[stream] == 0) return false;
    const std::uint64_t n = left_[stream]--;
    r = trace::Record{};
    r.master = port(stream);
    r.bytes = 32;
    std::uint32_t& seed = seeds_[stream];
    seed = seed * 1664525u + 1013904223u;
    r.write = random_ && seed >> 30 == 0;
    r.address = random_ ? (seed >> 8 & 0x1F'FFFFu) * 32u
                        : stream << 20 | static_cast<std::uint32_t>(n * 32 & 0xF'FFFFu);
    return true;
  }
  trace::TraceInfo info;

 private:
  /// Behind the core's: those of 64 bits.
  static Master port(unsigned n) { return static_cast<Master>(index(Master::kEdmaTc0Read) + n); }
  bool random_;
  std::vector<std::uint64_t> left_;
  std::vector<std::uint32_t> seeds_;
};

/// Arguments: masters, requests.
void replay(benchmark::State& state, bool random, bool memory_only) {
  ReplayParams params;
  ParamSet set;
  params.declare(set);
  const auto count = static_cast<std::uint64_t>(state.range(1));
  for (auto _ : state) {
    Synthetic source(static_cast<unsigned>(state.range(0)), count, random);
    ReplayPath path("synthetic", source.info, source, params, memory_only);
    benchmark::DoNotOptimize(path.run_before(kNever));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * count));
}

void arguments(benchmark::internal::Benchmark* b) {
  for (const int masters : {1, 4, 10}) b->Args({masters, 1'000'000});
  b->Args({4, 10'000'000})->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(replay, sequential, false, false)->Apply(arguments);
BENCHMARK_CAPTURE(replay, random, true, false)->Apply(arguments);
BENCHMARK_CAPTURE(replay, sequential_memory_only, false, true)->Apply(arguments);
BENCHMARK_CAPTURE(replay, random_memory_only, true, true)->Apply(arguments);

}  // namespace
}  // namespace fovea::app
