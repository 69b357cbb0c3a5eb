// The remap engine on the chip: registers on the configuration bus, a master of the crossbar, an interrupt.
#pragma once
#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <systemc>
#include <utility>
#include <vector>

#include "model/common/burst_master.h"
#include "model/common/bus_target.h"
#include "model/common/clock.h"
#include "model/common/pulse.h"
#include "model/common/stats.h"
#include "model/common/timed_counter.h"
#include "model/common/timer.h"
#include "model/engine/backends.h"
#include "model/engine/core/engine_backend.h"
#include "model/engine/core/engine_registers.h"
#include "model/engine/engine_params.h"

namespace fovea::engine {

struct EngineStats : StatGroup {
  Counter jobs{*this, "jobs", "1", "jobs that ended, however"};
  Counter interrupts{*this, "interrupts", "1", "rising edges of the interrupt line"};
  TimedCounter map_reads{*this, "map_reads", "1", "bursts of maps that were read"};
  TimedCounter map_bytes{*this, "map_bytes", "B", "bytes of maps that were read"};
  TimedCounter source_reads{*this, "source_reads", "1", "lines of sources that were read"};
  TimedCounter source_bytes{*this, "source_bytes", "B", "bytes of sources that were read"};
  TimedCounter writes{*this, "writes", "1", "bursts of results that were written"};
  TimedCounter write_bytes{*this, "write_bytes", "B", "bytes of results that were written"};
  Counter errors{*this, "errors", "1", "requests that no slave answered"};
  EngineStats() : StatGroup("engine") {}
};

/// How far apart two compared backends were (`engine` = both, both_tlm): requests by clocks, whichever was earlier.
struct PairStats final : StatGroup {
  static constexpr std::array<unsigned, 6> kUpTo{0, 1, 3, 7, 15, 63};
  Counter requests{*this, "requests", "1", "requests that were compared, and equal"};
  Counter skipped{*this, "skipped", "1", "requests behind an error or an abort, which were not compared"};
  Maximum most{*this, "most", "1", "clocks between the same request of both, at most"};
  std::deque<Counter> within;  ///< `within_N`: at most N clocks apart
  PairStats() : StatGroup("engine.pair") {
    for (const unsigned n : kUpTo)
      within.emplace_back(*this, "within_" + std::to_string(n), "1",
                          "of them those at most " + std::to_string(n) + " clocks apart");
  }
  void note(std::int64_t lag) {
    const auto clocks = static_cast<std::uint64_t>(lag < 0 ? -lag : lag);
    ++requests;
    most.note(clocks);
    for (std::size_t n = 0; n < kUpTo.size(); ++n)
      if (clocks <= kUpTo[n]) ++within[n];
  }
};

/// Behind it is a backend: a model or the RTL. Its requests are put on the port at their edges. A burst is handed to
/// the bus when all its data have left the engine. Answers reach the RTL in kernel time, at their first beat; the model
/// takes them within the memory path, as soon as they are decided, and so costs an event of the kernel only where
/// another process could see what it does, or where it has to know that an answer did not come.
class RemapEngine : public WithRegs<EngineRegs>, public BusTarget, private EngineBackend::Host {
 public:
  using Params = EngineParams;
  SC_HAS_PROCESS(RemapEngine);
  EngineStats stats;
  std::optional<PairStats> pair;
  ClockIn clk{"clk"};
  Pulse interrupt_line{"interrupt", kPsPerNs};

  RemapEngine(sc_core::sc_module_name name, const EngineParams& params);

  bool idle() const override { return memory_.idle(); }
  std::string difference() const override { return difference_; }

 protected:
  bool holes_answer() const override { return false; }
  void on_reset(ResetKind kind) override;

 private:
  struct Waiting {
    Burst burst;
    std::vector<std::uint8_t> data;
    Picoseconds at;
  };
  void issue(const Burst& burst, Picoseconds at) override;
  void interrupt(bool level) override;
  void put(const Burst& burst, Picoseconds at);
  void issue_waiting();
  void issue_first_waiting();
  void slot_free();
  void call();
  void report_errors();
  void answered(const BurstMaster::Completion& c);
  void go_on();
  Comparison comparison();
  void count_jobs(std::uint32_t ended);
  void clock_changed();
  void connect(Reg& reg);

  Clock clock_;
  std::unique_ptr<EngineBackend> backend_;
  BurstMaster memory_;
  const bool ahead_;             // answers are reported when they are decided
  Timer call_, slot_free_, failed_;
  Picoseconds next_call_ = kNever;  // to which `call_` is set
  std::deque<Waiting> waiting_;  // for a free slot
  std::deque<std::pair<Picoseconds, bool>> failures_;  // times of errors that lie ahead, and whether of a write
  std::string difference_;       // between the backends that are compared
  std::uint64_t resets_ = 0;
  bool was_busy_ = false;
  std::uint16_t ended_ = 0;      // ENDED.COUNT when it was seen last
};

}  // namespace fovea::engine
