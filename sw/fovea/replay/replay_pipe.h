// One transfer controller of a replay: its requests come from a trace, its bursts follow from them.
#pragma once
#include <array>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "model/common/clock.h"
#include "model/common/mem_request.h"
#include "model/dma/core/transfer_controller.h"

namespace fovea::app {

/// The ports of a transfer controller without SystemC: bursts go out when the controller's rules let them, and
/// end in order within a direction, as on the chip (common/burst_master.h).
class ReplayPipe final : private dma::TransferController::Host {
 public:
  struct Burst : MemRequest {
    Picoseconds free = 0;        // kNever: taken, and its end is not known
    Picoseconds delivered = 0;   // when a slave other than the SDRAM has done it
    bool due = false;            // decided, but an older one of its direction is not
    alignas(16) std::array<std::uint8_t, kMaxBurstBytes> bytes_{};
  };
  /// What becomes of a transfer, by its TransferRequest::number.
  struct Events {
    std::function<void(Burst&)> submit;                      ///< the burst is on its port at `issued`
    std::function<void(std::uint64_t number, Picoseconds at, Picoseconds delivered)> ended;
    std::function<void()> program_free;                      ///< program_free_from() is known
  };

  ReplayPipe(Master read, Master write, unsigned outstanding, dma::TransferController::Sizes sizes,
             const Clock& clock, Events events);

  /// From when on the controller takes another request; kNever while that is not known.
  Picoseconds program_free_from() const { return core_.program_busy() ? kNever : program_free_; }
  void submit(const TransferRequest& request, unsigned burst, Picoseconds at);
  /// The outcome of a burst is in it.
  void completed(Burst& burst);
  bool idle() const { return core_.idle(); }

 private:
  struct Port {
    std::vector<Burst> bursts;
    std::deque<Burst*> under_way;  // in the order in which they went out
    Picoseconds newest = 0, ended = 0;
    Picoseconds free_from() const;
  };
  Picoseconds edge(Picoseconds t, unsigned clocks) const override {
    return clock_.edge(clock_.edge_at_or_after(t) + clocks);
  }
  Picoseconds read_free() const override { return reads_.free_from(); }
  Picoseconds write_free() const override { return writes_.free_from(); }
  void read(dma::Command burst, Picoseconds at) override { send(reads_, burst, at); }
  void write(dma::Command burst, std::span<const std::uint8_t>, Picoseconds at) override {
    send(writes_, burst, at);
  }
  void program_free(Picoseconds at) override {
    program_free_ = at;
    events_.program_free();
  }
  void completed(const TransferRequest& request, Picoseconds at) override {
    events_.ended(request.number, at, delivered_);
  }
  void failed(const TransferRequest& request, dma::TransferController::Failure, Picoseconds at) override {
    events_.ended(request.number, at, at);
  }
  void send(Port& port, dma::Command command, Picoseconds at);

  const Clock& clock_;
  Events events_;
  Port reads_, writes_;
  Picoseconds program_free_ = 0, delivered_ = 0;
  dma::TransferController core_;
};

}  // namespace fovea::app
