// The verilated RTL behind the registers and the memory port of the remap engine. Knows no SystemC; its
// implementation knows Verilator.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "model/common/clock.h"
#include "model/engine/core/engine_backend.h"

namespace fovea::rtl {

/// Waveforms of all signals below `remap_top`, as an FST file whose times are those of the simulation.
struct Waves {
  /// What begins the recording.
  enum class Trigger { kBusy, kJob, kInterrupt, kError };
  std::filesystem::path file{};  ///< empty: none
  Trigger trigger = Trigger::kBusy;
  /// Events of the trigger that are let pass.
  std::uint64_t skip = 0;
  Picoseconds from = 0;          ///< earlier events of the trigger do not count
  Picoseconds length = kNever;   ///< from the trigger on
};

/// Clocked only while there is something to do: an access to a register, a request without an answer, or what
/// remap_top's busy_o says. A write is posted: it is on the register port from the next edge on. A read has the
/// next edge at once, ahead of the clock, so that it returns the registers as they are before that edge; what
/// comes from memory between now and that edge reaches the engine an edge later.
///
/// Each clock passes the protocol checkers of both ports; a broken rule is an own defect.
class RtlBackend : public engine::EngineBackend {
 public:
  struct Options {
    Waves waves{};
    /// For registers without a reset value; another seed, other bits. 0: all bits are 0.
    unsigned random_start = 0;
    /// Called with what a protocol checker has found. By default the process ends with status 4.
    std::function<void(const std::string&)> on_defect{};
  };
  /// @param clock may change between calls; it belongs to the owner
  RtlBackend(Host& host, const Clock& clock, const Options& options);
  RtlBackend(Host& host, const Clock& clock) : RtlBackend(host, clock, Options{}) {}
  ~RtlBackend() override;

  Picoseconds run(Picoseconds now) override;
  std::uint32_t read(std::uint32_t offset, Picoseconds now) override;
  void write(std::uint32_t offset, std::uint32_t word, unsigned strobes, Picoseconds now) override;
  void answer(const engine::Answer& answer) override;
  bool busy() const override;
  void reset() override;
  /// Clock edges that were evaluated.
  std::uint64_t clocks() const;
  /// Ends the file of waveforms, if there is one.
  void finish();
  /// The same at a time that lies ahead, or with the backend.
  void finish_at(Picoseconds at);

 private:
  struct State;
  std::unique_ptr<State> s_;
};

}  // namespace fovea::rtl
