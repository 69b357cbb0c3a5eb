// Drives the verilated address generator and watches its handshakes.
#pragma once
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <stdexcept>
#include <vector>

#include "tb/rtl/golden.h"

class Vbench_top;

namespace fovea::rtl {

/// How often either side is willing, in a clock, in 1/16. 16 means always.
struct Pace {
  unsigned map = 16, beat = 16;
};

struct Outcome {
  std::vector<Beat> beats;
  std::uint64_t clocks = 0;  ///< from the acceptance of the job to the last beat
  std::size_t map_taken = 0;
};

class AddrgenBench {
 public:
  explicit AddrgenBench(std::uint32_t seed = 1);
  ~AddrgenBench();
  enum class End { kClear, kReset };
  /// Runs a job to its last beat, or abandons it with clear_i, or the reset, after `limit` beats.
  /// @throws std::runtime_error if a stalled beat changes or nothing happens for 10,000 clocks
  Outcome run(const Job& job, std::span<const std::uint32_t> map, Pace pace = {},
              std::size_t limit = ~std::size_t{0}, End end = End::kClear);
  /// Offers a job and says whether it was refused.
  bool refused(const Job& job);

 private:
  void offer(const Job& job);
  void clock();
  void clear();
  void reset();
  Beat beat() const;
  std::unique_ptr<Vbench_top> dut_;
  std::mt19937 random_;
};

}  // namespace fovea::rtl
