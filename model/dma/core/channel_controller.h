// The EDMA3 channel controller: events, queues, parameter RAM, completion, interrupts. Knows no
// SystemC; its owner says when it may act, and carries its interrupts and requests away.
// Behaviour: SPRUEE4A (DM35x) and SPRUH82C (AM1808), the guides of sister chips.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "model/common/transfer_request.h"
#include "model/common/units.h"
#include "model/dma/core/edma_registers.h"

namespace fovea::dma {

class ChannelController {
 public:
  class Host {
   public:
    virtual ~Host() = default;
    /// The transfer controller's program register is free.
    virtual bool can_submit(unsigned controller) const = 0;
    virtual void submit(unsigned controller, const TransferRequest& request) = 0;
    /// The logic that reads a set and submits its request is at work now.
    virtual bool forms_request() const = 0;
    /// One pulse of a shadow region's completion interrupt, or of the error interrupt.
    virtual void pulse_completion(unsigned region) = 0;
    virtual void pulse_error() = 0;
    /// An event waits that prioritise() or process() may take now.
    virtual void work_arrived() = 0;
    /// Software has enabled these hardware events, one bit each.
    virtual void events_enabled(std::uint64_t events) = 0;
    /// What a programmer should learn, in one line.
    virtual void warn(const std::string& what) = 0;

    // For a recorder of traffic.
    /// What is happening in the channel controller's registers now, as what it may start.
    virtual TransferTrigger trigger() const { return {}; }
    /// A write sets a trigger.
    virtual void trigger_written() {}
    /// A request leaves its queue, whose turn came at `ready`; submit() follows if it moves anything.
    virtual void requested(const TransferRequest&, const TransferTrigger&, Picoseconds /*ready*/) {}
    /// A completion code is set.
    virtual void coded(const TransferTrigger&) {}
  };

  /// Installs the behaviour of the registers, which must outlive it.
  ChannelController(EdmaRegs& regs, Host& host);
  ChannelController(const ChannelController&) = delete;
  ChannelController& operator=(const ChannelController&) = delete;

  /// A hardware event, 0 .. 63, that came at `at`.
  void event(unsigned channel, Picoseconds at = 0);
  /// Moves the most urgent event that waits into its queue, where its turn comes at `ready` at the
  /// earliest. False: there is none, or its queue is full.
  bool prioritise(Picoseconds ready);
  /// Takes the head of the most urgent queue whose transfer controller is ready, and submits its
  /// request. False: there is none.
  bool process(Picoseconds now);
  /// The earliest time at which the turn of a queue's head comes; kNever: all queues are empty.
  Picoseconds next_turn() const;
  /// The same among the turns that come behind `now`: heads whose turn has come may wait for their controllers.
  Picoseconds next_turn_after(Picoseconds now) const;
  /// A transfer controller has ended a request that reports, at `ended`: its code arrives here.
  void completed(const TransferRequest& request, Picoseconds ended = 0);
  /// A transfer controller has dropped a request (TRERR): no code arrives for it.
  void dropped(const TransferRequest& request);
  /// Back to the state after a hardware reset. The registers are reset by their owner.
  void reset();

  struct Counts {
    std::uint64_t events = 0, requests = 0, missed = 0, links = 0;
    std::uint64_t sets_read = 0, sets_written = 0;    ///< by the controller: whole parameter sets
    std::uint64_t words_read = 0, words_written = 0;  ///< of parameter sets, over the configuration bus
  };
  const Counts& counts() const { return counts_; }
  /// CCSTAT, its ACTV included.
  std::uint32_t status() const;

 private:
  enum class Trigger : std::uint8_t { kEvent, kManual, kChain, kQdma };  // ETYPE of QxEy
  struct Entry {
    Trigger trigger;
    std::uint8_t channel;
    Picoseconds ready;
    TransferTrigger by;
  };
  struct Queue {
    std::array<Entry, kQueueDepth> entry{};
    unsigned head = 0, count = 0;
  };

  void install_global();
  void install_region(unsigned region);
  void install(ChannelRegs& regs, std::function<std::uint64_t()> mask,
               std::function<std::uint32_t()> qdma_mask);
  void set_manual(std::uint64_t bits);
  void set_chained(unsigned channel, const TransferTrigger& by);
  void miss(std::uint64_t bits);
  void miss_qdma(std::uint32_t bits);
  void set_error(std::uint32_t threshold, bool codes);
  template <class Change>
  void change_interrupts(Change change);
  bool push(unsigned queue, const Entry& e);
  void show(unsigned queue);
  void serve(unsigned queue, unsigned controller, Picoseconds now);
  ParamSet load(unsigned set);
  void store(unsigned set, const ParamSet& value);
  void exhausted(unsigned set, const TransferTrigger& by);
  void write_trigger(unsigned set, unsigned word, const TransferTrigger& by);
  void check_width(unsigned index, const ParamSet& set);
  void report(const ParamSet& set, bool final, const TransferTrigger& by);
  std::uint64_t pending() const;
  bool errors() const;

  EdmaRegs& regs_;
  Host& host_;
  std::array<Queue, kQueues> queues_{};
  unsigned outstanding_codes_ = 0;
  Counts counts_;
  /// What set the pending bit of each channel, by Trigger.
  std::array<std::array<TransferTrigger, 64>, 4> by_{};
  TransferTrigger& by(Trigger trigger, unsigned channel) {
    return by_[static_cast<std::size_t>(trigger)][channel];
  }
  std::array<std::uint64_t, kTransferControllers> requested_{};  // of each transfer controller, since the start
};

}  // namespace fovea::dma
