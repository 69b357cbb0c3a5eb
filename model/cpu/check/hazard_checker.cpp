#include "model/cpu/check/hazard_checker.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace fovea::cpu {

HazardChecker::HazardChecker(Core& core)
    : core_(core),
      observing_(core.observe_lines(*this)),
      code_(core, [this](const Hazard& h) { report(h); }),
      lines_(core.view().data.lines()),
      bus_(core.view().bus),
      held_(lines_.lines()) {}

HazardChecker::~HazardChecker() {
  for (unsigned n = 0; n < held_.size(); ++n)
    if (held_[n].foreign.bytes && lines_.line(n).tag != 1) core_.watch_line(n, false);
}

std::uint64_t HazardChecker::total() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

/// Calls f(line, held) for each valid line with this physical address. Observers are not told
/// that a line becomes invalid, so the cache is asked.
template <class F>
void HazardChecker::each_holder(std::uint32_t line_pa, F f) {
  if (!holders_[bucket(line_pa)]) return;
  for (unsigned n = 0; n < held_.size(); ++n)
    if (held_[n].pa == line_pa && lines_.line(n).tag != 1) f(n, held_[n]);
}

void HazardChecker::arrived(const MemRequest& r, Picoseconds at) {
  if (r.master == Master::kArmI) {
    if (r.bytes == kLineBytes) code_.requested(r.address, at);
    return;
  }
  if (r.master == Master::kArmD) {
    if (r.write || r.bytes != kLineBytes) return;
    filling_ = r.address;
    requested_ = at;
    meanwhile_ = {};
    return;
  }
  if (r.write && follows_) waiting_.push_back({r.master, r.address, r.bytes, at});
  for (std::uint32_t from = r.address; from != r.address + r.bytes;) {
    const std::uint32_t line = from & ~(kLineBytes - 1u);
    const std::uint32_t to = std::min(line + kLineBytes, r.address + r.bytes);
    const std::uint32_t bytes = bits(from - line, to - from);
    if (r.write)
      written_by(r, line, bytes, at);
    else
      read_by(r, line, bytes, at);
    from = to;
  }
}

/// `ti` serves a read before another master's older write, even one to the same address.
void HazardChecker::moved(Master master, bool write, std::uint32_t address, unsigned bytes) {
  if (is_core(master)) {
    if (write || bytes != kLineBytes) return;
    for (const Waiting& w : waiting_)
      if (w.address < address + kLineBytes && address < w.address + w.bytes) passed(master, w, address);
    return;
  }
  if (!write) return;
  const auto w = std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& x) {
    return x.master == master && x.address == address && x.bytes == bytes;
  });
  if (w != waiting_.end()) waiting_.erase(w);
}

/// The line that is being filled lacks these bytes, as if they had been written after its fill.
void HazardChecker::passed(Master by, const Waiting& w, std::uint32_t line_pa) {
  const std::uint32_t from = std::max(w.address, line_pa), to = std::min(w.address + w.bytes, line_pa + kLineBytes);
  const std::uint32_t bytes = bits(from - line_pa, to - from);
  if (by == Master::kArmI)
    code_.written(w.master, line_pa, bytes, w.at);
  else if (filling_ == line_pa)
    meanwhile_ = {meanwhile_.bytes | bytes, w.master, w.at};
}

void HazardChecker::read_by(const MemRequest& r, std::uint32_t line_pa, std::uint32_t bytes,
                            Picoseconds at) {
  each_holder(line_pa, [&](unsigned n, const Held& held) {
    for (unsigned half = 0; half < 2; ++half) {
      const std::uint32_t hit = bytes & bits(half * kHalfBytes, kHalfBytes);
      if (!hit || !(lines_.line(n).dirty >> half & 1u)) continue;
      const Store& s = held.stores[half];
      report({HazardKind::kDirtyRead, r.master, s.pc, first_of(line_pa, hit), s.at, at});
    }
  });
  in_buffer(HazardKind::kBufferedRead, r, line_pa, bytes, at);
}

/// A hazard if the core's buffers hold some of these bytes.
void HazardChecker::in_buffer(HazardKind kind, const MemRequest& r, std::uint32_t line_pa, std::uint32_t bytes,
                              Picoseconds at) {
  if (!bus_.unsent(first_of(line_pa, bytes), static_cast<unsigned>(std::popcount(bytes)))) return;
  const Store s = waiting_store(line_pa, bytes);
  report({kind, r.master, s.at ? s.pc : core_.current_pc(), first_of(line_pa, bytes), at, at, 0, s.at});
}

/// The store of the first of these bytes that waits in a buffer; none if no line held it. Stores that miss the D-cache
/// are not announced, as that would cost each of them time.
HazardChecker::Store HazardChecker::waiting_store(std::uint32_t line_pa, std::uint32_t bytes) {
  const WriteBuffer& w = bus_.writes();
  Store found;
  for (unsigned word = 0; word < kLineBytes / 4 && !found.at; ++word) {
    const std::uint32_t hit = bytes & bits(4 * word, 4);
    if (!hit || !bus_.unsent(first_of(line_pa, hit), static_cast<unsigned>(std::popcount(hit)))) continue;
    const std::uint32_t address = line_pa + 4 * word;
    if (victim_.pa == line_pa && address - w.victim_address < w.victim_bytes)
      found = victim_.stores[4 * word / kHalfBytes];
    else
      each_holder(line_pa, [&](unsigned, const Held& held) { found = held.through[word]; });
  }
  return found;
}

void HazardChecker::written_by(const MemRequest& r, std::uint32_t line_pa, std::uint32_t bytes,
                               Picoseconds at) {
  code_.written(r.master, line_pa, bytes, at);
  const auto note = [&](Foreign& f) { f = {f.bytes | bytes, r.master, at}; };
  if (filling_ == line_pa) note(meanwhile_);
  each_holder(line_pa, [&](unsigned n, Held& held) {
    if (!held.foreign.bytes) core_.watch_line(n, true);
    note(held.foreign);
  });
  in_buffer(HazardKind::kOverwrite, r, line_pa, bytes, at);
}

void HazardChecker::filled(unsigned line) {
  Held& held = held_[line];
  if (held.pa != kNone) --holders_[bucket(held.pa)];
  held = {lines_.line(line).pa, requested_, core_.boundary_time(), {}, {}, {}};
  ++holders_[bucket(held.pa)];
  if (filling_ == held.pa) held.foreign = meanwhile_;
  filling_ = kNone;
  if (held.foreign.bytes) core_.watch_line(line, true);
}

void HazardChecker::loaded(unsigned line, unsigned offset, unsigned bytes) {
  const Held& held = held_[line];
  const std::uint32_t hit = held.foreign.bytes & bits(offset, bytes);
  const Picoseconds now = core_.boundary_time();
  // The load for which the line was filled was served in the memory's order.
  if (!hit || now == held.there) return;
  report({HazardKind::kStaleLoad, held.foreign.master, core_.current_pc(), first_of(held.pa, hit),
          held.foreign.at, now, held.filled});
}

void HazardChecker::stored(unsigned line, unsigned offset, unsigned bytes) {
  Held& held = held_[line];
  const unsigned half = offset / kHalfBytes;
  const Store now{core_.current_pc(), core_.boundary_time()};
  if (!(lines_.line(line).dirty >> half & 1u)) held.stores[half] = now;
  if (!lines_.line(line).write_back)
    for (unsigned word = offset / 4; word <= (offset + bytes - 1) / 4; ++word) held.through[word] = now;
  forget_foreign(line, bits(offset, bytes));
}

void HazardChecker::written_back(unsigned line, unsigned halves) {
  Held& held = held_[line];
  victim_ = held;
  for (unsigned half = 0; half < 2; ++half) {
    const std::uint32_t whole = bits(half * kHalfBytes, kHalfBytes), hit = held.foreign.bytes & whole;
    if (!hit || !(halves >> half & 1u)) continue;
    report({HazardKind::kOverwrite, held.foreign.master, held.stores[half].pc, first_of(held.pa, hit),
            held.foreign.at, core_.boundary_time()});
    forget_foreign(line, whole);  // memory will hold what the line holds
  }
}

void HazardChecker::forget_foreign(unsigned line, std::uint32_t bytes) {
  Foreign& f = held_[line].foreign;
  if (!(f.bytes & bytes)) return;
  f.bytes &= ~bytes;
  if (!f.bytes) core_.watch_line(line, false);
}

void HazardChecker::settle(Picoseconds t) {
  // In which order hazards of one time are found may depend on who works ahead.
  const auto key = [](const Hazard& h) { return std::tuple(h.after, h.kind, h.pc, h.master, h.address); };
  std::sort(found_.begin(), found_.end(),
            [&](const Hazard& a, const Hazard& b) { return key(a) < key(b); });
  const auto end = std::find_if(found_.begin(), found_.end(), [t](const Hazard& h) { return h.after > t; });
  std::for_each(found_.begin(), end, [this](const Hazard& h) {
    ++counts_[static_cast<std::size_t>(h.kind)];
    if (places_.emplace(h.kind, h.pc, h.master).second && on_place) on_place(h);
  });
  found_.erase(found_.begin(), end);
}

}  // namespace fovea::cpu
