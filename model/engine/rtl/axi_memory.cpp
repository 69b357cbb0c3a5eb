#include "model/engine/rtl/axi_memory.h"

#include <algorithm>

#include "model/common/check.h"

namespace fovea::rtl {

AxiMemory::AxiMemory(unsigned slots, Issue issue) : slots_(slots), issue_(std::move(issue)) {
  FOVEA_CHECK(slots > 0, "a memory port without a slot");
}

void AxiMemory::reset() {
  waiting_.clear();
  taken_.clear();
  reads_.clear();
  writes_.clear();
  beats_.clear();
  r_ = {};
  b_ = {};
}

void AxiMemory::drive(Picoseconds edge, AxiWires& wires) {
  std::erase_if(taken_, [edge](const Slot& p) { return p.free < edge; });
  const bool room = waiting_.empty();
  wires.ar.ready = room && taken_.size() < slots_;
  wires.aw.ready = room && writes_.size() < kWrites;
  wires.w.ready = beats_.size() < kWrites * kMaxBurstBytes / 8;
  if (!r_.valid) offer_read(edge);
  if (!b_.valid) offer_answer(edge);
  wires.r.valid = r_.valid;
  wires.r.id = r_.id;
  wires.r.data = r_.data;
  wires.r.response = r_.response;
  wires.r.last = r_.last;
  wires.b.valid = b_.valid;
  wires.b.response = b_.response;
}

/// Beats are spread evenly from the first to the last.
Picoseconds AxiMemory::beat_time(const Read& r) const {
  if (r.beats == 1) return r.last;
  return r.first + (r.last - r.first) * r.next / (r.beats - 1);
}

/// The oldest request whose next beat is there, if no older one of its identifier is open.
void AxiMemory::offer_read(Picoseconds edge) {
  r_ = {};
  unsigned seen = 0;  // identifiers of older requests
  for (const Read& r : reads_) {
    if (!(seen >> r.id & 1u) && r.known && beat_time(r) < edge) {
      std::uint64_t word = 0;
      if (!r.error)
        for (unsigned n = 8; n-- > 0;) word = word << 8 | r.data[8 * r.next + n];
      r_ = {true, false, r.id, word, r.error ? kDecodeError : kOkay, r.next + 1 == r.beats};
      reading_ = r.tag;
      return;
    }
    seen |= 1u << r.id;
  }
}

void AxiMemory::offer_answer(Picoseconds edge) {
  b_ = {};
  if (writes_.empty()) return;
  const Write& w = writes_.front();
  if (w.complete && w.open.empty() && w.last < edge)
    b_ = {true, false, w.error ? kDecodeError : kOkay};
}

void AxiMemory::sample(Picoseconds edge, const AxiWires& wires) {
  if (wires.r.valid && wires.r.ready) {
    const auto r = std::find_if(reads_.begin(), reads_.end(),
                                [this](const Read& x) { return x.tag == reading_; });
    if (++r->next == r->beats) reads_.erase(r);
    r_.valid = false;
  }
  if (wires.b.valid && wires.b.ready) {
    writes_.pop_front();
    b_.valid = false;
  }
  if (wires.ar.valid && wires.ar.ready) {
    const unsigned beats = wires.ar.length + 1, bytes = 8 * beats;
    FOVEA_CHECK(bytes <= kMaxBurstBytes && wires.ar.address % kMaxBurstBytes + bytes <= kMaxBurstBytes &&
                    wires.ar.id < 32,
                "a read that is no request to memory");
    reads_.push_back({++tags_, wires.ar.id, beats, 0, false, false, {}, 0, 0});
    waiting_.push_back({tags_, false, wires.ar.id, wires.ar.address, {}, bytes});
  }
  if (wires.aw.valid && wires.aw.ready) {
    const unsigned bytes = 8 * (wires.aw.length + 1);
    FOVEA_CHECK(bytes <= kMaxBurstBytes && wires.aw.address % kMaxBurstBytes + bytes <= kMaxBurstBytes,
                "a write that is no request to memory");
    writes_.push_back({wires.aw, false, {}, false, 0});
  }
  if (wires.w.valid && wires.w.ready) beats_.push_back(wires.w);
  collect_write(edge);
  issue_waiting(edge);
}

/// Data of the oldest burst without them. Each run of bytes is a request of its own.
void AxiMemory::collect_write(Picoseconds edge) {
  for (Write& w : writes_) {
    if (w.complete) continue;
    if (beats_.size() <= w.address.length) return;
    w.complete = true;
    w.last = edge;  // of a burst without a byte
    Part run{0, true, w.address.id, 0, {}, 0};
    const auto close = [&] {
      if (run.data.empty()) return;
      run.tag = ++tags_;
      run.bytes = static_cast<unsigned>(run.data.size());
      w.open.push_back(run.tag);
      waiting_.push_back(run);
      run.data.clear();
    };
    for (unsigned n = 0; n <= w.address.length; ++n, beats_.pop_front())
      for (unsigned byte = 0; byte < 8; ++byte) {
        if (!(beats_.front().strobes >> byte & 1u)) {
          close();
          continue;
        }
        if (run.data.empty()) run.address = w.address.address + 8 * n + byte;
        run.data.push_back(static_cast<std::uint8_t>(beats_.front().data >> 8 * byte));
      }
    close();
  }
}

void AxiMemory::issue_waiting(Picoseconds edge) {
  while (!waiting_.empty() && taken_.size() < slots_) {
    const Part p = std::move(waiting_.front());
    waiting_.pop_front();
    taken_.push_back({p.tag, kNever});
    issue_({p.tag, p.write, p.id, p.address, p.bytes, p.data}, edge);
  }
}

void AxiMemory::answered(std::uint64_t tag, bool error, std::span<const std::uint8_t> data,
                         Picoseconds first, Picoseconds last) {
  for (Slot& p : taken_)
    if (p.tag == tag) p.free = last;
  for (Read& r : reads_)
    if (r.tag == tag) {
      FOVEA_CHECK(!r.known && (error || data.size() == 8 * r.beats), "not the answer to this read");
      r.known = true;
      r.error = error;
      r.data.assign(data.begin(), data.end());
      r.first = first;
      r.last = last;
      return;
    }
  for (Write& w : writes_)
    if (std::erase(w.open, tag)) {
      w.error |= error;
      w.last = std::max(w.last, last);
      return;
    }
}

}  // namespace fovea::rtl
