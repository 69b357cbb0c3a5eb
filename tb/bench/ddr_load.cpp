// Executes one kind of load on the DDR controller's core for a given number of requests, to be run
// under an instruction counter:
//   valgrind --tool=callgrind --callgrind-out-file=/dev/null bench_ddr_load KIND COUNT
// The difference between two runs, divided by the difference of their counts, is the cost of one
// request without start-up.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "model/mem/core/ddr_controller.h"

namespace fovea::dram {
namespace {

class Load {
 public:
  Load() : store_(params_.size_bytes()), ddr_(params_, store_, {}) {
    ddr_.set_clocks(Frequency(243'000'000), Frequency(121'500'000), 0);
  }

  /// One request, `gap` after the one before it was submitted, and what is due until then.
  void request(Master master, unsigned priority, bool write, unsigned bytes, std::uint32_t address,
               Picoseconds gap) {
    now_ += gap;
    run_before(now_);
    while (!input_free_) step();
    MemRequest& r = requests_[next_++ % requests_.size()];
    r.master = master;
    r.in_path.priority = static_cast<std::uint8_t>(priority);
    r.write = write;
    r.bytes = static_cast<std::uint8_t>(bytes);
    r.data = data_.data();
    input_free_ = ddr_.submit(r, address, now_);
  }
  void drain() { run_before(kNever); }
  std::uint64_t commands() const {
    return ddr_.stats.bursts.count() + ddr_.stats.activates.count() + ddr_.stats.refreshes.count();
  }

 private:
  void run_before(Picoseconds at) {
    while (ddr_.next_decision() < at) take_step();
  }
  void step() {
    now_ = ddr_.next_decision();
    take_step();
  }
  void take_step() {
    ddr_.step();
    if (!ddr_.news().any) return;
    if (ddr_.news().accepted) input_free_ = true;
    ddr_.news().clear();
  }

  mem::DdrParams params_;
  mem::BackingStore store_;
  mem::DdrController ddr_;
  std::array<std::uint8_t, 64> data_{};
  std::array<MemRequest, 32> requests_;  // more than the controller holds
  unsigned next_ = 0;
  Picoseconds now_ = 1'000;
  bool input_free_ = true;
};

int play(std::string_view kind, unsigned long count) {
  Load load;
  std::uint32_t random = 1;
  for (unsigned long n = 0; n < count; ++n) {
    const auto i = static_cast<std::uint32_t>(n);
    random = random * 1664525u + 1013904223u;
    if (kind == "writes_4") {
      load.request(Master::kArmD, 1, true, 4, i * 4 & 0xF'FFFFu, 190'000);
    } else if (kind == "reads_32") {
      load.request(Master::kArmD, 1, false, 32, i * 32 & 0xF'FFFFu, 190'000);
    } else if (kind == "remap") {  // one line of the table or the source for four pixels out
      if (i % 5 == 0)
        load.request(Master::kArmD, 1, false, 32,
                     (i % 2 ? 0x10'0800u : 0x20'1000u) + (i * 8 & 0x7'FFE0u), 190'000);
      else
        load.request(Master::kArmD, 1, true, 4, 0x30'2000u + (i * 4 & 0x7'FFFFu), 190'000);
    } else if (kind == "random_64") {
      load.request(Master::kArmD, 1, false, 64, random >> 5 & 0x3FF'FFC0u, 190'000);
    } else if (kind == "contended") {  // ten masters as fast as the controller takes them
      load.request(static_cast<Master>(i % 10), i % 10 % 8, i % 3 == 0, 32,
                   (i % 10 << 20) + (i * 32 & 0xFFFFu), 1'000);
    } else {
      std::fprintf(stderr, "no load '%.*s': writes_4 reads_32 remap random_64 contended\n",
                   static_cast<int>(kind.size()), kind.data());
      return 2;
    }
  }
  load.drain();
  std::printf("%lu requests, %lu commands without PRE\n", count,
              static_cast<unsigned long>(load.commands()));
  return 0;
}

}  // namespace
}  // namespace fovea::dram

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bench_ddr_load KIND COUNT\n");
    return 2;
  }
  return fovea::dram::play(argv[1], std::strtoul(argv[2], nullptr, 10));
}
