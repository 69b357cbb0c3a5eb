// Random traffic for the test of the time rule: masters that run ahead, a register block that
// starts timers and transfers, and interrupts that change what a master does next.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <systemc>
#include <vector>

#include "model/bus/lookahead_initiator.h"
#include "model/bus/config_bus.h"
#include "model/bus/scr.h"
#include "model/common/burst_master.h"
#include "model/common/bus_target.h"
#include "model/common/end_of_instant.h"
#include "model/common/timer.h"
#include "model/mem/ddr_module.h"

namespace fovea::sync {

/// Random numbers that do not depend on a library's distributions.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : s_(seed * 0x9E3779B97F4A7C15ull + 0x1234567) { next(); }
  std::uint64_t next() {
    s_ ^= s_ << 13;
    s_ ^= s_ >> 7;
    s_ ^= s_ << 17;
    return s_;
  }
  std::uint64_t below(std::uint64_t n) { return (next() >> 11) % n; }

 private:
  std::uint64_t s_;
};

/// The record of everything observable, compared as text.
class Log {
 public:
  void add(const std::string& line) { lines_.push_back(line); }
  std::string sorted() const;

 private:
  std::vector<std::string> lines_;
};

/// Registers: TIMER (write n: interrupt after n ns and 1 ps; if n is odd, at the next multiple of 64 ns
/// that is so far away, where masters look for it one picosecond later), COPY (write address: a DMA master reads 64
/// bytes there and writes them 4 KiB further, then interrupts), COUNT (reads: expiries so far),
/// PRIORITY (write master<<8|level: a crossbar priority changes), STREAM (write address: a passive
/// DMA master, which reacts to outcomes ahead of the kernel as the video ports do, moves twelve
/// bursts in places of three; unless address bit 6 is set, it then interrupts: no burst of such a
/// stream is passive, as each lets the next one follow), TRANSFER (write random bits: the EDMA copies; see EdmaBlock).
struct TestRegs : RegBank {
  Reg timer{*this, "TIMER", 0x0, Mode::kRw, "ns until the interrupt"};
  Reg copy{*this, "COPY", 0x4, Mode::kRw, "address"};
  Reg count{*this, "COUNT", 0x8, Mode::kRo, "expiries"};
  Reg priority{*this, "PRIORITY", 0xC, Mode::kRw, "master<<8|level"};
  Reg stream{*this, "STREAM", 0x10, Mode::kRw, "address"};
  Reg transfer{*this, "TRANSFER", 0x14, Mode::kRw, "random bits"};
  TestRegs() : RegBank("TEST") {}
};

class TestBlock : public WithRegs<TestRegs>, public BusTarget {
 public:
  BurstMaster dma{"dma", Master::kEdmaTc0Read, 4};
  BurstMaster stream{"stream", Master::kLoad, 3, BurstMaster::Report::kWhenDecided};
  sc_core::sc_vector<sc_core::sc_signal<std::uint32_t>> priority{"priority", kMasterCount};
  Picoseconds irq_at = 0, irq_before = 0;  // last and last-but-one interrupt

  std::function<void(std::uint32_t)> on_transfer;  ///< TRANSFER is written

  TestBlock(sc_core::sc_module_name name, Log& log);
  void raise();  ///< an interrupt, now

 private:
  void expire();
  void move_stream();
  Log& log_;
  Timer due_, stream_end_;
  unsigned stream_left_ = 0;
  bool stream_no_side_effects_ = false;
  std::uint32_t stream_address_ = 0;
  Picoseconds stream_start_ = 0;
};

/// One master of a random program: sleeps until the program starts, executes it, and logs the
/// results.
class TrafficMaster : public bus::LookaheadInitiator<TrafficMaster> {
 public:
  TrafficMaster(sc_core::sc_module_name name, unsigned number, unsigned ports, Log& log,
                TestBlock& block);
  struct Program {
    std::uint64_t seed = 0;
    Picoseconds start = 0;
    unsigned operations = 0;
  };
  std::vector<Program> programs;
  bool finished = false;

 private:
  friend bus::LookaheadInitiator<TrafficMaster>;
  static constexpr unsigned kSlots = 6;
  struct Op {
    Transaction tx;
    std::array<std::uint8_t, kMaxBurstBytes> data{};
    bool used = false;
    unsigned serial = 0;
  };
  void run();
  void execute(const Program& p);
  void retire(Op& op, std::uint64_t seed, Picoseconds& now);

  unsigned number_, ports_;
  Log& log_;
  TestBlock& block_;
  std::array<Op, kSlots> ops_;
};

/// Runs `programs` random programs and returns the record. Only one call per process.
struct Outcome {
  std::string record;
  std::uint64_t direct = 0, queued = 0;
};
Outcome run_programs(std::uint64_t first_seed, unsigned programs, bool strict);

}  // namespace fovea::sync
