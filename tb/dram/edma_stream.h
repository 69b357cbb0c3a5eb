// Requests of EDMA transfer controllers to the SDRAM controller, in a closed loop: each read and each
// acknowledgement decides when the next commands come. Runs over any controller of the comparison.
#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "model/dma/core/transfer_controller.h"
#include "tb/dram/bench.h"
#include "tb/dram/reference_controller.h"

namespace fovea::dram {

/// Up to four transfer controllers with random requests behind one port, which takes their commands in the order of
/// their times. A read master has the number of its transfer controller, a write master that and 10.
/// Controller: submit(), next(), step(), and `accepted` and `reads`, events with the request's id in `a`.
template <class Controller>
class EdmaStream {
 public:
  /// A submission, and whether it was accepted at once.
  struct Submitted {
    std::size_t id;
    bool taken;
    Picoseconds at;
  };

  EdmaStream(Controller& memory, Rng& rng, std::uint64_t size) : memory_(memory), rng_(rng), size_(size) {
    static constexpr unsigned kBursts[] = {16, 32, 64};
    const unsigned count = 1 + below(4);
    for (unsigned n = 0; n < count; ++n)
      tcs_.push_back(std::make_unique<Tc>(*this, n, kBursts[below(3)], 128u << below(2), 1 + below(4)));
  }

  /// Until so many requests have been made and all have ended.
  std::vector<Submitted> run(unsigned requests) {
    for (auto& tc : tcs_) offer(*tc, 10'000);
    while (made_ < requests || !waiting_.empty() || busy()) {
      if (made_ < requests)
        for (auto& tc : tcs_)
          if (!tc->core.program_busy()) offer(*tc, now_);
      const bool ready = !waiting_.empty() && !input_taken_;
      if (ready && memory_.next() >= waiting_.front().at) {
        submit();
      } else if (memory_.next() != kNever) {
        now_ = std::max(now_, memory_.next());
        memory_.step();
      } else {
        throw std::runtime_error("no request is served");
      }
      settle();
    }
    return std::move(submitted_);
  }
  std::size_t transfers() const { return ended_; }

 private:
  static constexpr Picoseconds kClock = 8'230;

  struct Tc final : dma::TransferController::Host {
    EdmaStream& s;
    const unsigned number;
    dma::TransferController core;
    Tc(EdmaStream& stream, unsigned n, unsigned burst, unsigned fifo, unsigned depth)
        : s(stream), number(n), core(*this, {burst, fifo, depth}) {}
    Picoseconds edge(Picoseconds t, unsigned clocks) const override {
      return ((t + kClock - 1) / kClock + clocks) * kClock;
    }
    Picoseconds read_free() const override { return s.now_; }
    Picoseconds write_free() const override { return s.now_; }
    void read(dma::Command c, Picoseconds at) override { s.issue(*this, c, at, false); }
    void write(dma::Command c, std::span<const std::uint8_t>, Picoseconds at) override { s.issue(*this, c, at, true); }
    void program_free(Picoseconds) override {}
    void completed(const TransferRequest&, Picoseconds) override { ++s.ended_; }
    void failed(const TransferRequest&, dma::TransferController::Failure, Picoseconds) override {}
  };
  struct Waiting {
    ReferenceRequest request;
    Picoseconds at;
  };

  unsigned below(unsigned n) { return static_cast<unsigned>(rng_.below(n)); }
  bool busy() const {
    for (const auto& tc : tcs_)
      if (!tc->core.idle()) return true;
    return false;
  }
  /// Two regions whose rows meet in the banks; arrays of all lengths and alignments.
  void offer(Tc& tc, Picoseconds at) {
    TransferRequest r;
    r.acnt = static_cast<std::uint16_t>(below(3) ? 1u << below(8) : 1 + below(200));
    r.bcnt = static_cast<std::uint16_t>(1 + below(6));
    const int step = static_cast<int>(below(4) ? r.acnt : below(4'000));
    r.source.address = below(1u << 15);
    r.source.index = step;
    r.destination.address = static_cast<std::uint32_t>(size_ / 2) + below(1u << 15);
    r.destination.index = below(2) ? step : static_cast<int>(below(4'000));
    ++made_;
    tc.core.submit(r, at);
  }
  void issue(const Tc& tc, dma::Command c, Picoseconds at, bool write) {
    ReferenceRequest r;
    r.id = owner_.size();
    r.master = tc.number + (write ? 10 : 0);
    r.priority = tc.number;
    r.write = write;
    r.bytes = c.bytes;
    r.address = c.address;
    owner_.push_back({tc.number, c.bytes, write});
    auto place = waiting_.end();
    while (place != waiting_.begin() && (place - 1)->at > at) --place;
    waiting_.insert(place, {r, at});
  }
  void submit() {
    const Waiting w = waiting_.front();
    waiting_.pop_front();
    now_ = std::max(now_, w.at);
    const bool taken = memory_.submit(w.request, now_);
    submitted_.push_back({w.request.id, taken, now_});
    input_taken_ = !taken;
    in_input_ = w.request.id;
    if (taken && w.request.write) tc_of(w.request.id).write_done(false, now_);
  }
  void settle() {
    for (; accepted_ < memory_.accepted.size(); ++accepted_) {
      const auto e = memory_.accepted[accepted_];
      if (e.a == in_input_) input_taken_ = false;
      now_ = std::max<Picoseconds>(now_, e.b);
      if (owner_[e.a].write) tc_of(e.a).write_done(false, e.b);
    }
    for (; read_ < memory_.reads.size(); ++read_) {
      const auto e = memory_.reads[read_];
      static constexpr std::uint8_t kData[64] = {};
      tc_of(e.a).read_done({kData, owner_[e.a].bytes}, false, e.c);
    }
  }
  dma::TransferController& tc_of(std::size_t id) { return tcs_[owner_[id].tc]->core; }

  struct Owner {
    unsigned tc, bytes;
    bool write;
  };
  Controller& memory_;
  Rng& rng_;
  const std::uint64_t size_;
  std::vector<std::unique_ptr<Tc>> tcs_;
  std::vector<Owner> owner_;  // by id
  std::deque<Waiting> waiting_;
  std::vector<Submitted> submitted_;
  Picoseconds now_ = 0;
  unsigned made_ = 0;
  std::size_t ended_ = 0, accepted_ = 0, read_ = 0, in_input_ = 0;
  bool input_taken_ = false;
};

}  // namespace fovea::dram
