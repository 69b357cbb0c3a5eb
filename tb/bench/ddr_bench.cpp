// Host speed of crossbar and controller cores, in requests per second. Not a test.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>

#include "tb/dram/path.h"

namespace fovea::dram {
namespace {

/// One request at a time through the controller alone: submit, then its commands.
void controller(benchmark::State& state, bool write, unsigned bytes) {
  mem::DdrParams params;
  mem::BackingStore store(params.size_bytes());
  mem::DdrController ddr(params, store, {});
  ddr.set_clocks(Frequency(243'000'000), Frequency(121'500'000), 0);
  std::array<std::uint8_t, 64> data{};
  MemRequest r;
  r.write = write;
  r.bytes = static_cast<std::uint8_t>(bytes);
  r.data = data.data();
  Picoseconds now = 1'000;
  std::uint32_t address = 0;
  for (auto _ : state) {
    ddr.submit(r, address, now);
    address = (address + bytes) & 0xF'FFFFu;
    Picoseconds t = now;
    while (ddr.next_decision() != kNever) {
      t = ddr.next_decision();
      ddr.step();
      ddr.news().clear();
    }
    now = t;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
}

/// The same with the crossbar before it.
void path(benchmark::State& state, bool write, unsigned bytes) {
  Path p(Frequency(243'000'000), Frequency(121'500'000));
  std::array<std::uint8_t, 64> data{};
  PathRequest r;
  r.write = write;
  r.bytes = static_cast<std::uint8_t>(bytes);
  r.data = data.data();
  Picoseconds now = 1'000;
  std::uint32_t address = 0;
  for (auto _ : state) {
    r.address = address;
    address = (address + bytes) & 0xF'FFFFu;
    p.submit(r, now);
    Picoseconds t = now;
    while (p.next_decision() != kNever) {
      t = p.next_decision();
      p.step();
    }
    now = t;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
}

/// Seven masters keep the command FIFO full: the scheduler has a choice each time.
void saturated(benchmark::State& state) {
  mem::DdrParams params;
  mem::BackingStore store(params.size_bytes());
  bool open = true;
  mem::DdrController ddr(params, store, {});
  ddr.set_clocks(Frequency(243'000'000), Frequency(121'500'000), 0);
  std::array<std::uint8_t, 64> data{};
  std::array<MemRequest, 32> requests;  // more than the controller holds
  Picoseconds now = 1'000;
  std::uint32_t i = 0;
  for (auto _ : state) {
    ++i;
    MemRequest& r = requests[i % requests.size()];
    r.bytes = 32;
    r.data = data.data();
    r.master = static_cast<Master>(i % 7);
    r.write = i % 3 == 0;
    while (!open) {
      now = ddr.next_decision();
      ddr.step();
      open = ddr.news().accepted.has_value();
      ddr.news().clear();
    }
    open = ddr.submit(r, (i % 7 << 20) + (i * 32 & 0xFFFFu), now);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
}

BENCHMARK_CAPTURE(controller, single_word_write, true, 4);
BENCHMARK_CAPTURE(controller, read_32_bytes, false, 32);
BENCHMARK_CAPTURE(path, single_word_write, true, 4);
BENCHMARK_CAPTURE(path, read_32_bytes, false, 32);
BENCHMARK(saturated);

}  // namespace
}  // namespace fovea::dram
