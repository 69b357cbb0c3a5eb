// The firmware's functions as slices of a Perfetto trace.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "model/common/units.h"
#include "model/cpu/core/call_stacks.h"
#include "sw/fovea/probes/perfetto_file.h"

namespace fovea::app {

/// Follows the active functions. There is a track for each depth: below a function lie those that it
/// calls, and the handlers of exceptions that interrupt it. A function that is active for less than
/// kShortest is left out, so that the number of slices is bounded by the simulated time, and so is what
/// lies deeper than kDeepest.
class PerfettoFunctions final : public cpu::CallStacks::Watcher {
 public:
  static constexpr Picoseconds kShortest = kPsPerUs;
  static constexpr std::size_t kDeepest = 32;

  using Name = std::function<std::string(std::uint32_t address)>;
  using Time = std::function<Picoseconds(std::uint64_t cycle)>;
  /// @param name of the function that begins at an address
  /// @param time of the core's present clock
  /// @param settle makes the call stacks tell what is active at a clock
  PerfettoFunctions(PerfettoFile& file, Name name, Time time, std::function<void(std::uint64_t cycle)> settle)
      : file_(file), name_(std::move(name)), time_(std::move(time)), settle_(std::move(settle)) {}

  void ran(std::span<const std::uint32_t> functions, std::size_t same, std::uint64_t begin,
           std::uint64_t end) override;
  /// What lies behind `from`, the present time, is recorded.
  void start(Picoseconds from) { from_ = from; }
  /// Writes the slices that are over by `until`. The core may be ahead of the present time; what it did
  /// later is kept.
  void flush(Picoseconds until);
  /// Writes everything until then, with the functions that are still active, and records no more.
  void finish(Picoseconds until);

 private:
  struct Active {
    std::uint32_t function;
    Picoseconds since;
  };
  struct Slice {
    std::uint32_t function;
    std::size_t depth;
    Picoseconds begin, end;
  };
  void write(const Slice& slice, Picoseconds until);

  PerfettoFile& file_;
  Name name_;
  Time time_;
  std::function<void(std::uint64_t)> settle_;
  std::unordered_map<std::uint32_t, std::string> names_;
  Picoseconds from_ = kNever;
  std::uint64_t told_ = 0;           // the end of the stretch before
  std::optional<Picoseconds> last_;  // when that was
  std::vector<PerfettoFile::Track> tracks_;  // by depth
  std::vector<Active> active_;  // outermost first
  std::deque<Slice> over_;      // in the order of their ends
};

}  // namespace fovea::app
