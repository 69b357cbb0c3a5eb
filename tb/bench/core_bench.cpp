// Host speed of the core alone, in guest instructions per second of host CPU time. Not a test.
#include <benchmark/benchmark.h>

#include <ctime>

#include "tb/bench/core_rig.h"

namespace fovea::cpu {
namespace {

/// Five million core clocks of a program a turn, its start-up included once.
void program(benchmark::State& state, const char* file) {
  constexpr std::uint64_t kTurn = 5'000'000;
  std::uint64_t instructions = 0, clocks = 0;
  for (auto _ : state) {
    state.PauseTiming();
    CoreRig rig(file, kTurn);
    state.ResumeTiming();
    rig.run();
    instructions += rig.core.counts().instructions;
    clocks += rig.core.clock_count();
  }
  state.counters["guest_ips"] =
      benchmark::Counter(static_cast<double>(instructions), benchmark::Counter::kIsRate);
  state.counters["CPI"] = static_cast<double>(clocks) / static_cast<double>(instructions);
}

BENCHMARK_CAPTURE(program, soft_float, PROGRAM_DIR "/soft_float.elf");
BENCHMARK_CAPTURE(program, integer, PROGRAM_DIR "/integer.elf");
BENCHMARK_CAPTURE(program, block_copy, PROGRAM_DIR "/block_copy.elf");
BENCHMARK_CAPTURE(program, remap, PROGRAM_DIR "/remap.elf");

}  // namespace
}  // namespace fovea::cpu
