// The remap engine as a transaction-level model: registers, queue of jobs, events, and RemapModel behind them.
#pragma once
#include <array>
#include <cstdint>

#include "model/engine/core/engine_backend.h"
#include "model/engine/core/engine_registers.h"
#include "model/engine/core/remap_model.h"

namespace fovea::engine {

class TlmBackend : public EngineBackend, private RemapModel::Port {
 public:
  /// @param clock the engine's; the code that changes its frequency calls run() before and after
  TlmBackend(const Clock& clock, Host& host, Geometry geometry = {})
      : clock_(clock), host_(host), model_(*this, geometry) {}

  Picoseconds run(Picoseconds now) override;
  std::uint32_t read(std::uint32_t offset, Picoseconds now) override;
  void write(std::uint32_t offset, std::uint32_t word, unsigned strobes, Picoseconds now) override;
  void answer(const Answer& answer) override;
  bool takes_answers_ahead() const override { return true; }
  JobPlace job() const override;
  bool busy() const override { return running_ || (enabled() && !queue_.empty()); }
  void reset() override;

 private:
  struct Entry {
    Job job;
    std::uint8_t tag;
    std::uint64_t there;  ///< clock from which on it can be taken
  };

  void issue(const Burst& burst, std::uint64_t clock) override;
  std::uint32_t& cell(std::uint32_t offset) { return registers_[offset / 4]; }
  std::uint32_t value(std::uint32_t offset) const { return registers_[offset / 4]; }
  bool enabled() const;
  std::uint64_t take_at() const;
  void take(std::uint64_t clock);
  void end_job();
  void submit(std::uint8_t tag, std::uint64_t clock);
  void abort(std::uint64_t clock);
  void raise(std::uint32_t events);
  void update_interrupt();
  Job window() const;
  Picoseconds time_before(std::uint64_t clock) const;

  const Clock& clock_;
  Host& host_;
  RemapModel model_;
  std::array<std::uint32_t, at::kRegisterWords> registers_{};
  Ring<Entry, kQueueDepth> queue_;
  std::uint64_t enabled_from_ = 0, idle_from_ = 0, beat_free_ = 0, answer_free_ = 0;
  bool running_ = false, interrupt_ = false;
  std::uint8_t tag_ = 0;
};

}  // namespace fovea::engine
