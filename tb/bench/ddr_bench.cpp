// Host speed of crossbar and controller cores, in requests per second. Not a test.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>

#include "tb/dram/path.h"

namespace fovea::dram {
namespace {

struct NoClient : mem::DdrClient {
  void ddr_accepted(void*, Picoseconds) override {}
  void ddr_read_done(void*, Picoseconds, Picoseconds) override {}
};

/// One request at a time through the controller alone: submit, then its commands.
void controller(benchmark::State& state, bool write, unsigned bytes) {
  mem::DdrParams params;
  mem::BackingStore store(params.size_bytes());
  NoClient client;
  mem::DdrController ddr(params, store, client);
  ddr.set_clocks(Frequency(243'000'000), Frequency(121'500'000), 0);
  std::array<std::uint8_t, 64> data{};
  mem::DdrRequest r;
  r.write = write;
  r.bytes = static_cast<std::uint8_t>(bytes);
  r.data = data.data();
  Picoseconds now = 1'000;
  std::uint32_t address = 0;
  for (auto _ : state) {
    r.address = address;
    address = (address + bytes) & 0xF'FFFFu;
    ddr.submit(r, now);
    Picoseconds t = now;
    while (ddr.next_decision() != kNever) {
      t = ddr.next_decision();
      ddr.step();
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
  struct Door : NoClient {
    bool open = true;
    void ddr_accepted(void*, Picoseconds) override { open = true; }
  } client;
  mem::DdrController ddr(params, store, client);
  ddr.set_clocks(Frequency(243'000'000), Frequency(121'500'000), 0);
  std::array<std::uint8_t, 64> data{};
  mem::DdrRequest r;
  r.bytes = 32;
  r.data = data.data();
  Picoseconds now = 1'000;
  std::uint32_t i = 0;
  for (auto _ : state) {
    ++i;
    r.master = static_cast<Master>(i % 7);
    r.write = i % 3 == 0;
    r.address = (i % 7 << 20) + (i * 32 & 0xFFFFu);
    while (!client.open) {
      now = ddr.next_decision();
      ddr.step();
    }
    client.open = ddr.submit(r, now);
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
