// Runs the verilated engine on a memory with random latencies; every clock goes through the
// protocol checker.
#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "tb/rtl/axi_checker.h"
#include "tb/rtl/golden.h"

class Vbench_top;

namespace fovea::rtl {

/// How the memory answers.
struct Memory {
  unsigned latency = 8;   ///< least clocks from a request to its first data
  unsigned spread = 0;    ///< up to this many more, at random
  unsigned willing = 16;  ///< how often a channel is ready or has data, in 1/16
  bool swaps = false;     ///< answers of different identifiers overtake each other
  std::optional<std::uint32_t> read_fault{}, write_fault{};  ///< bursts with this byte address fail
};

struct Result {
  bool refused = false, read_error = false, write_error = false, aborted = false;
  std::uint32_t clocks = 0, lines = 0, writes = 0, bad = 0;
  std::uint64_t read_bytes = 0, written_bytes = 0;
};

class EngineBench {
 public:
  static constexpr std::uint32_t kBase = 0x8000'0000;  ///< byte address of the memory
  explicit EngineBench(std::size_t bytes, std::uint32_t seed = 1);
  ~EngineBench();
  std::uint32_t& word(std::uint32_t word_address);
  /// @param abort_after clocks until abort_i; empty: never
  /// @throws std::runtime_error for a broken rule of AXI, an access beyond the memory, or an engine
  /// that stands still
  Result run(const Job& job, std::uint32_t map_base, std::uint32_t border, Memory memory = {},
             std::optional<unsigned> abort_after = {});
  std::vector<Request> reads_asked, writes_asked;  ///< by the last run()
  std::vector<std::uint64_t> read_clocks;          ///< when reads_asked were taken

 private:
  struct Read {
    unsigned id, left;
    std::uint32_t address;
    std::uint64_t due;
    bool fault;
  };
  struct Answer {
    std::uint64_t due;
    bool fault;
  };
  void drive(const Memory& memory);
  void sample(const Memory& memory);
  void clock();
  bool chance(const Memory& memory) { return random_() % 16 < memory.willing; }
  std::unique_ptr<Vbench_top> dut_;
  std::mt19937 random_;
  std::vector<std::uint32_t> words_;
  AxiChecker checker_{4 + 8, 4};  // four bursts of the map reader's buffer, eight lines
  std::uint64_t now_ = 0;
  std::deque<Read> reads_;
  std::size_t reading_ = 0;  ///< whose beat is on the wires
  std::deque<Request> addresses_;
  std::deque<WriteData> beats_;
  std::deque<Answer> answers_;
  Result result_;
};

}  // namespace fovea::rtl
