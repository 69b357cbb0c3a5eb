// EDMA3 channel controller at 0x01C00000.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <queue>
#include <systemc>
#include <tuple>
#include <vector>

#include "model/common/bus_target.h"
#include "model/common/clock.h"
#include "model/common/masters.h"
#include "model/common/observers.h"
#include "model/common/pulse.h"
#include "model/common/stats.h"
#include "model/common/timer.h"
#include "model/dma/core/channel_controller.h"
#include "model/dma/core/edma_registers.h"
#include "model/dma/edma_params.h"

namespace fovea::dma {

/// Width of an interrupt's pulse: seen by the interrupt controller, and over before the next edge.
inline constexpr Picoseconds kInterruptPulse = kPsPerNs;

/// A transfer controller, as the channel controller sees it.
class TransferPort {
 public:
  virtual ~TransferPort() = default;
  /// From when on its program register is free; kNever while that is not known.
  virtual Picoseconds program_free() const = 0;
  virtual bool has_clock() const = 0;
  /// Default burst size of the next request, bytes.
  virtual unsigned burst() const = 0;
  virtual void submit(const TransferRequest& request) = 0;
};

struct EdmaStats : StatGroup {
  Counter requests{*this, "requests", "1", "transfer requests submitted"};
  Counter events{*this, "events", "1", "events that entered a queue"};
  Counter missed{*this, "missed_events", "1", "events lost, and events of null sets"};
  Counter links{*this, "links", "1", "parameter sets replaced by a link"};
  Counter interrupts{*this, "interrupts", "1", "pulses of completion interrupts"};
  Counter errors{*this, "errors", "1", "pulses of the error interrupt"};
  // Activity of the parameter RAM. A set is eight words.
  Formula sets_read{*this, "param_sets_read", "1", "parameter sets read to serve a channel or to link",
                    [this] { return since(&Counts::sets_read); }};
  Formula sets_written{*this, "param_sets_written", "1", "parameter sets updated or replaced after their service",
                       [this] { return since(&Counts::sets_written); }};
  Formula words_read{*this, "param_words_read", "1", "words of parameter sets read over the configuration bus",
                     [this] { return since(&Counts::words_read); }};
  Formula words_written{*this, "param_words_written", "1",
                        "words of parameter sets written over the configuration bus",
                        [this] { return since(&Counts::words_written); }};
  /// @param counts the controller's, which outlive the statistics
  explicit EdmaStats(const ChannelController::Counts& counts) : StatGroup("edma"), counts_(counts) {}

 private:
  using Counts = ChannelController::Counts;
  std::uint64_t since(std::uint64_t Counts::*n) const { return counts_.*n - before_.*n; }
  void on_reset() override { before_ = counts_; }
  const Counts& counts_;
  Counts before_;
};

/// Works at the edges of the EDMA's clock. What happens at a time (an event, a register access, a
/// completion) counts from the next edge on, so that the order of processes within an instant does
/// not matter. A transfer controller has the priority of the queue that is mapped to it; if several
/// are, the most urgent of them; if none is, the lowest priority.
class EdmaCc : public WithRegs<EdmaRegs>, public BusTarget, private ChannelController::Host {
  ChannelController core_;  // before the statistics, which refer to its counts

 public:
  using Params = EdmaParams;
  SC_HAS_PROCESS(EdmaCc);
  EdmaStats stats{core_.counts()};
  ClockIn clk{"clk"};
  sc_core::sc_in<bool> lpsc{"lpsc"};
  Pulse completion{"completion", kInterruptPulse};  ///< of shadow region 0 (CCINT0)
  Pulse error{"error", kInterruptPulse};            ///< CCERRINT
  /// Priority of each transfer controller, for its read and its write port.
  sc_core::sc_vector<sc_core::sc_out<std::uint32_t>> priority{"priority", kTransferControllers};
  /// Software has enabled these hardware events, one bit each.
  std::function<void(std::uint64_t events)> on_events_enabled;
  /// Whose access is at a register, for observers of transfers.
  std::function<Master()> accessing = [] { return Master::kCount; };
  /// A transfer has been triggered whose completion code, if it has one, has not come.
  bool active() const { return core_.status() != 0; }
  /// Adds an observer of all transfers.
  Subscription observe(TransferObserver& observer) { return observers_.add(&observer); }

  EdmaCc(sc_core::sc_module_name name, const EdmaParams& params);

  void attach(unsigned controller, TransferPort& port) { controllers_.at(controller) = &port; }
  /// A rising edge of a hardware event, 0 .. 63, now.
  void event(unsigned channel);
  /// From a transfer controller: its program register is free from `at` on.
  void program_free(Picoseconds at) {
    if (core_.next_turn() != kNever) wake_.at(at);  // only queued requests wait for it
  }
  /// From a transfer controller: the request ends at `at`, now or later.
  void completed(const TransferRequest& request, Picoseconds at);
  /// From a transfer controller: it has dropped the request, whose completion code never arrives.
  void dropped(const TransferRequest& request);
  void leave_reset() override;

 protected:
  bool clocked() const override { return lpsc.read(); }
  void on_reset(ResetKind kind) override;

 private:
  struct Completion {
    Picoseconds at;     // when the code arrives
    Picoseconds ended;  // the last acknowledgement
    std::uint64_t order;
    TransferRequest request;
    bool operator>(const Completion& o) const {
      return std::tie(at, ended, order) > std::tie(o.at, o.ended, o.order);
    }
  };
  bool can_submit(unsigned controller) const override;
  void submit(unsigned controller, const TransferRequest& request) override;
  bool forms_request() const override { return kernel_time() < next_request_; }
  void pulse_completion(unsigned region) override;
  void pulse_error() override;
  void work_arrived() override;
  void events_enabled(std::uint64_t events) override;
  void warn(const std::string& what) override;
  TransferTrigger trigger() const override;
  void trigger_written() override;
  void requested(const TransferRequest&, const TransferTrigger&, Picoseconds ready) override;
  void coded(const TransferTrigger&) override;
  void update_priorities();
  void work();
  void wait_for_controllers(Picoseconds now);
  void count();
  void clock_changed();
  bool has_clock() const { return clock_.running() && lpsc.read(); }
  bool running() const { return has_clock() && !in_reset_; }
  Picoseconds edge(Picoseconds t, std::uint64_t clocks) const;

  const EdmaParams& params_;
  std::array<TransferPort*, kTransferControllers> controllers_{};
  Clock clock_;
  struct Latched {
    Picoseconds at;
    std::uint8_t channel;
  };
  std::vector<Latched> events_;
  std::priority_queue<Completion, std::vector<Completion>, std::greater<>> completions_;
  std::uint64_t completion_count_ = 0;
  Picoseconds next_request_ = 0;
  /// Transfer controllers without a clock for which a request waits, one bit each: told once for each wait.
  mutable std::uint32_t waits_for_clock_ = 0;
  bool in_reset_ = false;
  ChannelController::Counts reported_;
  Observers<TransferObserver*> observers_;
  Timer wake_, written_;
};

}  // namespace fovea::dma
