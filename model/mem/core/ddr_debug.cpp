// The queue as debuggers see it. Writes are acknowledged when they are taken into the FIFO, so debug
// accesses see the data of queued writes as part of the memory.
#include <algorithm>
#include <cstring>

#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {
namespace {

struct Overlap {
  std::uint32_t from, to;  // addresses
};

Overlap overlap(std::uint32_t a, std::uint32_t a_bytes, std::uint32_t b, std::uint32_t b_bytes) {
  return {std::max(a, b), std::min(a + a_bytes, b + b_bytes)};
}

}  // namespace

const MemRequest* DdrController::newest_read(Master master) const {
  for (unsigned i = queue_.count(); i-- > 0;) {
    const Entry& e = queue_.entry(i);
    const bool answered = in_burst_ && &e == plan_.choice.entry;
    if (e.request.write || e.request.master != master || answered) continue;
    const MemRequest* const younger = returns_.newest_behind(queue_.slot_of(e));
    return younger ? younger : e.request.origin;
  }
  return nullptr;
}

void DdrController::debug_read(std::uint32_t address, std::uint8_t* to, unsigned bytes) const {
  std::memcpy(to, store_.at(address), bytes);
  for (unsigned i = 0; i < queue_.count(); ++i) {  // oldest first
    const Entry& e = queue_.entry(i);
    const auto [a, b] = overlap(address, bytes, e.request.address, e.request.bytes);
    if (e.request.write && a < b)
      std::memcpy(to + (a - address), e.data.data() + (a - e.request.address), b - a);
  }
}

void DdrController::debug_write(std::uint32_t address, const std::uint8_t* from, unsigned bytes) {
  std::memcpy(store_.at(address), from, bytes);
  for (unsigned i = 0; i < queue_.count(); ++i) {
    Entry& e = queue_.entry(i);
    const auto [a, b] = overlap(address, bytes, e.request.address, e.request.bytes);
    if (e.request.write && a < b)
      std::memcpy(e.data.data() + (a - e.request.address), from + (a - address), b - a);
  }
}

DdrController::View DdrController::view() const {
  View v;
  const auto add = [&](const Queued& r, std::uint64_t ready, bool waiting) {
    const auto bank = (r.address >> bank_shift_) & bank_mask_;
    v.items.push_back({r.origin, r.master, r.write, r.bytes, r.address, waiting, false, false,
                       running_ ? ddr_.edge(std::max(ready, first_edge_)) : kNever, bank,
                       (r.address & row_mask_) >> row_shift_, device_.row(bank)});
  };
  for (unsigned i = 0; i < queue_.count(); ++i) {
    const Entry& e = queue_.entry(i);
    add(e.request, e.ready, false);
    if (&e != plan_.choice.entry || next_ == kNever) continue;
    v.next = i;
    v.items.back().moving = in_burst_;
  }
  if (input_taken_) {
    add(input_, input_arrived_, true);
    v.data_full = queue_.count() < fifo_entries_;
  }
  for (const ReadReturn::OutOfOrderRead& h : returns_.waiting()) {
    if (in_burst_ && h.request.origin == plan_.choice.entry->request.origin) continue;  // in the queue
    add(h.request, first_edge_, false);
    v.items.back().out_of_order = true;
  }
  if (attribution_.count()) {
    const IssuedCommand& g = attribution_.newest();
    v.last = in_burst_ ? plan_.choice.cmd : g.cmd;
    if (g.cause < kMasterCount) v.last_master = static_cast<Master>(g.cause);
  }
  v.cmd = plan_.choice.cmd;
  v.next_at = next_;
  v.asleep = power_.mode();
  return v;
}

}  // namespace fovea::mem
