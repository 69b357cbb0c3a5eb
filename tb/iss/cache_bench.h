// Shared code of the cache tests: a machine that records its bus traffic, and the comparison of its
// runs with the functional oracle. The first run stops at every instruction, which is passed to the
// oracle. The second runs freely and uses the core's fast paths, and the third uses a memory of
// varying latency. All of them must produce the bus traffic that the oracle predicts, in order and
// with its data.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "tb/iss/cache_oracle.h"
#include "tb/iss/machine.h"

namespace fovea::cpu::test {

/// Records the bus traffic with its data, and stops the core at each instruction if requested.
class NotingPort : public FlatPort {
 public:
  using FlatPort::FlatPort;
  Traffic seen;
  std::function<void()> at_boundary;

  void submit(BusAccess& a, Picoseconds t) override {
    FlatPort::submit(a, t);
    if (!a.done) throw std::logic_error("nothing else is going on, so it is decided at once");
    if (a.address >= kTables || a.error) return;  // page walks do not concern the caches
    Transfer out{a.address, {a.data, a.data + a.bytes}};
    const bool line = a.kind == BusAccess::Kind::kWrap8;
    if (a.port == BusAccess::Port::kInstruction) {
      if (line) seen.instruction_fills.push_back(std::move(out));
    } else if (!a.write) {
      (line ? seen.data_fills : seen.reads).push_back(std::move(out));
    } else {
      (a.buffered ? seen.buffered : seen.unbuffered).push_back(std::move(out));
    }
    log.clear();  // otherwise it would hold millions of entries
  }
  Picoseconds horizon() override { return at_boundary ? 0 : FlatPort::horizon(); }
  void sleep_until(Picoseconds t) override {
    FlatPort::sleep_until(t);
    if (at_boundary) at_boundary();
  }
};

using NotingMachine = MachineWith<NotingPort>;

struct Outcome {
  std::string difference;  ///< in traffic, loaded values, counters or final contents; empty: none
  std::uint64_t accesses = 0, line_changes = 0, operations = 0;
  CacheCounts counts;
};

/// @param make creates a machine that is ready to run, the same for each call
/// @param victims the oracle predicts which way is replaced
Outcome compare(const std::function<std::unique_ptr<NotingMachine>()>& make,
                CacheOracle::Fault fault, bool victims = true);
/// Prints the figures of a comparison on one line.
void print(const std::string& name, const Outcome& o);

/// Assembly that selects round-robin replacement; changes r0.
inline const std::string kRoundRobin =
    " mrc p15, 0, r0, c1, c0, 0\n orr r0, r0, #0x4000\n mcr p15, 0, r0, c1, c0, 0\n";

}  // namespace fovea::cpu::test
