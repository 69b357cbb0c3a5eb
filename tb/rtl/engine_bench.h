// Runs the verilated device, programmed through its registers, on a memory with random latencies;
// every clock goes through the protocol checkers.
#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "model/engine/rtl/axi_checker.h"
#include "model/engine/rtl/slave_checker.h"
#include "tb/rtl/golden.h"

class Vremap_top;

namespace fovea::rtl {

/// How the memory answers.
struct Memory {
  unsigned latency = 8;   ///< least clocks from a request to its first data
  unsigned spread = 0;    ///< up to this many more, at random
  unsigned willing = 16;  ///< how often a channel is ready or has data, in 1/16
  bool swaps = false;     ///< answers of different identifiers overtake each other
  unsigned writes_from = 0;  ///< for so many clocks of the job no write is taken
  std::optional<std::uint32_t> read_fault{}, write_fault{};  ///< bursts with this byte address fail
};

struct Result {
  bool refused = false, read_error = false, write_error = false, aborted = false;
  std::uint32_t clocks = 0, lines = 0, writes = 0, bad = 0;
  std::uint64_t read_bytes = 0, written_bytes = 0;
};

/// Byte offsets of the registers, from the table of rtl/README.md.
struct Offset {
  static constexpr unsigned kId = 0x00, kCtrl = 0x04, kStatus = 0x08, kEvents = 0x0C,
                            kEnables = 0x10, kSubmit = 0x14, kEnded = 0x18, kClocks = 0x20,
                            kLines = 0x24, kWrites = 0x28, kBad = 0x2C, kMode = 0x40;
};

struct RegisterWrite {
  unsigned offset;
  std::uint32_t value;
  unsigned strobes = 15;
};

/// What the slave answered; what was not asked is 0.
struct RegisterAnswer {
  unsigned write_response = 0, read_response = 0;
  std::uint32_t data = 0;
};

class EngineBench {
 public:
  static constexpr std::uint32_t kBase = 0x8000'0000;  ///< byte address of the memory
  explicit EngineBench(std::size_t bytes, std::uint32_t seed = 1);
  ~EngineBench();
  /// @throws std::runtime_error for an address beyond the memory, unless it `repeats`
  std::uint32_t& word(std::uint32_t word_address);
  bool repeats = false;  ///< all of the address space is copies of the memory
  std::uint32_t more_map_words = 0;  ///< in MAP_WORDS beyond what the job reads
  /// Runs a job and clears its events. The queue is empty before and after.
  /// @param abort_after clocks until ABORT is written; empty: never
  /// @throws std::runtime_error for a broken rule of AXI, an access beyond the memory, or an engine
  /// that stands still
  Result run(const Job& job, std::uint32_t map_base, std::uint32_t border, Memory memory = {},
             std::optional<unsigned> abort_after = {});

  /// A write, a read, or both at once, each with its channels at any distance.
  RegisterAnswer access(std::optional<RegisterWrite> write, std::optional<unsigned> read);
  /// Two writes, or two reads, that are offered together from the first clock on, one behind the other. The first
  /// answer is left on the bus for `hold` clocks, in which it must not change. @throws std::runtime_error if it does
  std::array<RegisterAnswer, 2> read_two(unsigned first, unsigned second, unsigned hold);
  std::array<RegisterAnswer, 2> write_two(const RegisterWrite& first, const RegisterWrite& second, unsigned hold);
  /// @throws std::runtime_error for an answer that is an error
  void write(unsigned offset, std::uint32_t value, unsigned strobes = 15);
  std::uint32_t read(unsigned offset);
  /// Writes a job into the window, and pushes it into the queue.
  void submit(const Job& job, std::uint32_t map_base, std::uint32_t border, std::uint8_t tag);
  void clock();  ///< one clock of device and memory
  /// The reset of device and memory, asserted between two edges for `clocks` clocks: what was under way is forgotten.
  void reset(unsigned clocks = 2);
  void until_interrupt(std::uint64_t most_clocks);
  bool interrupt() const;
  bool busy() const;
  bool quiet() const { return checker_.quiet(); }  ///< nothing is under way on the memory's bus
  std::vector<Request> reads_asked, writes_asked;  ///< on the memory's bus since run() began
  std::vector<std::uint64_t> read_clocks;  ///< when reads_asked were taken
  Memory memory{};
  unsigned bus_willing = 16;  ///< how soon the master of the registers gives a channel, in 1/16

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
  void tick();
  void drive();
  void sample();
  bool chance() { return random_() % 16 < memory.willing; }
  std::unique_ptr<Vremap_top> dut_;
  std::mt19937 random_;
  std::vector<std::uint32_t> words_;
  AxiChecker checker_{4 + 8, 4};  // four bursts of the map reader's buffer, eight lines
  RegisterPortChecker port_checker_{false};  ///< the tests use addresses between words too
  std::uint64_t now_ = 0, writes_from_ = 0;
  std::deque<Read> reads_;
  std::size_t reading_ = 0;  ///< whose beat is on the wires
  std::deque<Request> addresses_;
  std::deque<WriteData> beats_;
  std::deque<Answer> answers_;
  Result result_;
};

}  // namespace fovea::rtl
