#include "sw/fovea/replay/replay_pipe.h"

#include <algorithm>

#include "model/common/check.h"

namespace fovea::app {

ReplayPipe::ReplayPipe(Master read, Master write, unsigned outstanding, dma::TransferController::Sizes sizes,
                       const Clock& clock, Events events)
    : clock_(clock), events_(std::move(events)), core_(*this, sizes) {
  for (Port* port : {&reads_, &writes_}) {
    port->bursts = std::vector<Burst>(outstanding);
    for (Burst& b : port->bursts) {
      b.owner = this;
      b.master = port == &reads_ ? read : write;
      b.write = port == &writes_;
      b.data = b.bytes_.data();
    }
  }
}

Picoseconds ReplayPipe::Port::free_from() const {
  Picoseconds t = kNever;
  for (const Burst& b : bursts) t = std::min(t, b.free);
  return t;
}

void ReplayPipe::submit(const TransferRequest& request, unsigned burst, Picoseconds at) {
  core_.set_burst(burst);
  core_.submit(request, at);
}

void ReplayPipe::send(Port& port, dma::Command command, Picoseconds at) {
  Burst* b = nullptr;
  for (Burst& one : port.bursts)
    if (one.free <= at && (!b || one.free < b->free)) b = &one;
  FOVEA_CHECK(b, "a burst beyond the outstanding limit");
  port.newest = std::max(port.newest, at);
  b->free = kNever;
  b->address = command.address;
  b->bytes = static_cast<std::uint8_t>(command.bytes);
  b->issued = port.newest;
  b->delivered = 0;
  b->error = false;
  port.under_way.push_back(b);
  events_.submit(*b);
}

void ReplayPipe::completed(Burst& burst) {
  burst.due = true;
  Port& port = burst.write ? writes_ : reads_;
  while (!port.under_way.empty() && port.under_way.front()->due) {
    Burst& b = *port.under_way.front();
    port.under_way.pop_front();
    b.due = false;
    b.last = port.ended = std::max(b.last, port.ended);
    b.free = b.last;
    if (b.write) {
      delivered_ = b.delivered ? b.delivered : b.last;
      core_.write_done(b.error, b.last);
    } else {
      core_.read_done({b.bytes_.data(), b.bytes}, b.error, b.last);
    }
  }
}

}  // namespace fovea::app
