// What the tests of the caches share: a machine that notes its bus traffic, and the comparison of
// its runs with the functional oracle. Beside a first run, which stops at every instruction, the
// oracle is told what the instruction does; a second runs freely, by the quick ways of the core; a
// third on a memory of uneven latency. All must have put on the bus, in order and with its data,
// what the oracle predicts.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "tb/iss/cache_oracle.h"
#include "tb/iss/machine.h"

namespace fovea::cpu::test {

/// Notes what goes over the bus with its data, and stops the core at each instruction if asked to.
class NotingPort : public FlatPort {
 public:
  using FlatPort::FlatPort;
  Traffic seen;
  std::function<void()> at_boundary;

  void submit(BusAccess& a, Picoseconds t) override {
    FlatPort::submit(a, t);
    if (!a.done) throw std::logic_error("nothing else is going on, so it is decided at once");
    if (a.address >= kTables || a.error) return;  // page walks are not the caches' business
    Transfer out{a.address, {a.data, a.data + a.bytes}};
    const bool line = a.kind == BusAccess::Kind::kWrap8;
    if (a.port == BusAccess::Port::kInstruction) {
      if (line) seen.instruction_fills.push_back(std::move(out));
    } else if (!a.write) {
      (line ? seen.data_fills : seen.reads).push_back(std::move(out));
    } else {
      (a.buffered ? seen.buffered : seen.unbuffered).push_back(std::move(out));
    }
    log.clear();  // it would hold millions
  }
  Picoseconds horizon() override { return at_boundary ? 0 : FlatPort::horizon(); }
  void sleep_until(Picoseconds t) override {
    FlatPort::sleep_until(t);
    if (at_boundary) at_boundary();
  }
};

using NotingMachine = MachineWith<NotingPort>;

struct Outcome {
  std::string difference;  ///< of traffic, loaded values, counters or final contents; empty: none
  std::uint64_t accesses = 0, line_changes = 0, operations = 0;
  CacheCounts counts;
};

/// @param make makes a machine that is ready to run, the same each time
/// @param victims the oracle knows which way is given up
Outcome compare(const std::function<std::unique_ptr<NotingMachine>()>& make,
                CacheOracle::Fault fault, bool victims = true);
/// The figures of a comparison, in a line on the standard output.
void print(const std::string& name, const Outcome& o);

/// Assembly that selects round-robin replacement; r0 is lost.
inline const std::string kRoundRobin =
    " mrc p15, 0, r0, c1, c0, 0\n orr r0, r0, #0x4000\n mcr p15, 0, r0, c1, c0, 0\n";

}  // namespace fovea::cpu::test
