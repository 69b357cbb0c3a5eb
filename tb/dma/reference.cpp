#include "tb/dma/reference.h"

namespace fovea::reference {
namespace {

unsigned low(std::uint32_t w) { return w & 0xFFFF; }
unsigned high(std::uint32_t w) { return w >> 16; }
int index_of(unsigned half) {
  return half < 0x8000 ? static_cast<int>(half) : static_cast<int>(half) - 0x10000;
}
bool bit(std::uint32_t w, unsigned n) { return (w >> n) % 2 == 1; }

/// The parts of a parameter set.
struct Fields {
  bool fixed_source, fixed_destination, frames, is_static, early;
  unsigned width, code, a, b, c, link, reload;
  int source_b, destination_b, source_c, destination_c;
  bool raise_last, raise_others, chain_last, chain_others;
};
Fields decode(const std::array<std::uint32_t, 8>& w) {
  Fields f;
  const std::uint32_t opt = w[0];
  f.fixed_source = bit(opt, 0);
  f.fixed_destination = bit(opt, 1);
  f.frames = bit(opt, 2);  // SYNCDIM: AB-synchronised
  f.is_static = bit(opt, 3);
  f.width = 1u << (opt >> 8) % 8;
  f.early = bit(opt, 11);
  f.code = (opt >> 12) % 64;
  f.raise_last = bit(opt, 20);
  f.raise_others = bit(opt, 21);
  f.chain_last = bit(opt, 22);
  f.chain_others = bit(opt, 23);
  f.a = low(w[2]);
  f.b = high(w[2]);
  f.c = low(w[7]);
  f.source_b = index_of(low(w[4]));
  f.destination_b = index_of(high(w[4]));
  f.link = low(w[5]);
  f.reload = high(w[5]);
  f.source_c = index_of(low(w[6]));
  f.destination_c = index_of(high(w[6]));
  return f;
}

constexpr int kGlobalRegion = -1;

}  // namespace

bool refused(const Request& r) {
  const auto breaks = [&](bool fixed, std::uint32_t address, int step) {
    if (!fixed) return false;
    return address % 32 != 0 || (r.arrays > 1 && step % 32 != 0);
  };
  return breaks(r.source_fixed, r.source, r.source_step) ||
         breaks(r.destination_fixed, r.destination, r.destination_step);
}

void transfer(const Request& r, const std::function<std::uint8_t(std::uint32_t)>& read,
              const std::function<void(std::uint32_t, std::uint8_t)>& write) {
  std::uint32_t from = r.source, to = r.destination;
  for (unsigned array = 0; array < r.arrays; ++array) {
    for (unsigned i = 0; i < r.array_bytes; ++i)
      write(to + (r.destination_fixed ? i % r.width : i),
            read(from + (r.source_fixed ? i % r.width : i)));
    from += static_cast<std::uint32_t>(r.source_step);
    to += static_cast<std::uint32_t>(r.destination_step);
  }
}

Interpreter::Interpreter() {
  for (unsigned q = 0; q < 4; ++q) queues_[q].controller = q;
}

bool Interpreter::owns(int region, unsigned channel) const {
  return region == kGlobalRegion || region_[static_cast<unsigned>(region)][channel];
}
bool Interpreter::owns_qdma(int region, unsigned channel) const {
  return region == kGlobalRegion || region_qdma_[static_cast<unsigned>(region)][channel];
}

bool Interpreter::line(unsigned region) const {
  for (unsigned c = 0; c < 64; ++c)
    if (dma_[c].interrupt && dma_[c].interrupt_enabled && region_[region][c]) return true;
  return false;
}

bool Interpreter::any_error() const {
  for (const DmaChannel& c : dma_)
    if (c.missed) return true;
  for (const QdmaChannel& c : qdma_)
    if (c.missed) return true;
  for (const EventQueue& q : queues_)
    if (q.error) return true;
  return too_many_codes_;
}

template <class Action>
void Interpreter::watching_interrupts(Action action) {
  std::array<bool, 4> before;
  for (unsigned r = 0; r < 4; ++r) before[r] = line(r);
  action();
  for (unsigned r = 0; r < 4; ++r)
    if (!before[r] && line(r)) ++region_pulses_[r];
}

template <class Action>
void Interpreter::watching_errors(Action action) {
  const bool before = any_error();
  action();
  if (!before && any_error()) ++error_pulses_;
}

void Interpreter::hardware_event(unsigned channel) {
  DmaChannel& c = dma_[channel];
  watching_errors([&] {
    if (c.event && c.enabled) c.missed = true;
    c.event = true;
  });
}

/// Completion codes count at once: as an interrupt, as the event of another channel, or both.
void Interpreter::report(unsigned code, bool raises, bool chains) {
  DmaChannel& c = dma_[code];
  if (raises) watching_interrupts([&] { c.interrupt = true; });
  if (chains)
    watching_errors([&] {
      if (c.chained) c.missed = true;
      c.chained = true;
    });
}

void Interpreter::finished(const Request& r) {
  if (r.raises || r.chains) --outstanding_;
  report(r.code, r.raises, r.chains);
}

void Interpreter::abandoned(const Request& r) {
  if (r.raises || r.chains) --outstanding_;
}

void Interpreter::store(unsigned set, unsigned word, std::uint32_t value) {
  param_[set][word] = value;
  for (QdmaChannel& q : qdma_) {
    if (!q.enabled || q.set != set || q.word != word) continue;
    watching_errors([&] {
      if (q.event) q.missed = true;
      q.event = true;
    });
  }
}

void Interpreter::note_size(EventQueue& q) {
  const auto size = static_cast<unsigned>(q.entries.size());
  if (size > q.mark) q.mark = size;
  if (size > q.threshold && !q.exceeded) watching_errors([&] { q.exceeded = q.error = true; });
}

bool Interpreter::enter(unsigned queue, Entry e) {
  EventQueue& q = queues_[queue];
  if (q.entries.size() == 16) return false;
  q.slots[(q.start + q.entries.size()) % 16] = e.kind * 64 + e.number;
  q.entries.push_back(e);
  note_size(q);
  return true;
}

bool Interpreter::queue_one(std::uint64_t turn) {
  for (unsigned n = 0; n < 64; ++n) {
    DmaChannel& c = dma_[n];
    if (c.queued) continue;
    // ETYPE: 0 event, 1 manual, 2 chained, 3 QDMA. Event before chain before manual.
    if (c.event && c.enabled) {
      if (!enter(c.queue, {0, n, turn})) continue;
      c.event = false;
    } else if (c.chained) {
      if (!enter(c.queue, {2, n, turn})) continue;
      c.chained = false;
    } else if (c.manual) {
      if (!enter(c.queue, {1, n, turn})) continue;
      c.manual = false;
    } else {
      continue;
    }
    c.queued = true;
    return true;
  }
  for (unsigned n = 0; n < 8; ++n) {
    QdmaChannel& c = qdma_[n];
    if (c.queued || !c.event || !c.enabled) continue;
    if (!enter(c.queue, {3, n, turn})) continue;
    c.event = false;
    c.queued = true;
    return true;
  }
  return false;
}

bool Interpreter::serve_one(std::uint64_t now, const std::array<bool, 4>& accepts) {
  if (outstanding_ == 63) return false;
  for (EventQueue& q : queues_) {
    if (q.entries.empty() || q.entries.front().turn > now || !accepts[q.controller]) continue;
    serve(q);
    return true;
  }
  return false;
}

void Interpreter::serve(EventQueue& q) {
  const Entry e = q.entries.front();
  q.entries.pop_front();
  q.start = (q.start + 1) % 16;
  note_size(q);
  const bool is_qdma = e.kind == 3;
  const unsigned set = is_qdma ? qdma_[e.number].set : e.number;
  const Fields f = decode(param_[set]);

  const bool null = f.a == 0 && f.b == 0 && f.c == 0;
  const bool nothing = f.a == 0 || f.b == 0 || f.c == 0;  // null or dummy
  bool& queued = is_qdma ? qdma_[e.number].queued : dma_[e.number].queued;
  bool& missed = is_qdma ? qdma_[e.number].missed : dma_[e.number].missed;
  if (null)
    watching_errors([&] { missed = true; });
  else
    queued = false;

  const bool last = nothing || (f.c == 1 && (f.frames || f.b == 1));
  const bool raises = last ? f.raise_last : f.raise_others;
  const bool chains = last ? f.chain_last : f.chain_others;
  if (nothing || f.early) report(f.code, raises, chains);
  if (!nothing) {
    Request r;
    r.controller = q.controller;
    r.source = param_[set][1];
    r.destination = param_[set][3];
    r.array_bytes = f.a;
    r.arrays = f.frames ? f.b : 1;
    r.source_step = f.source_b;
    r.destination_step = f.destination_b;
    r.source_fixed = f.fixed_source;
    r.destination_fixed = f.fixed_destination;
    r.width = f.width;
    r.code = f.code;
    r.raises = raises && !f.early;
    r.chains = chains && !f.early;
    if (r.raises || r.chains)
      watching_errors([&] {
        if (++outstanding_ == 63) too_many_codes_ = true;
      });
    requests_.push_back(r);
  }
  if (f.is_static) return;
  if (last) return link(set);

  Words& w = param_[set];
  if (!f.frames && f.b > 1) {
    w[1] += static_cast<std::uint32_t>(f.source_b);
    w[3] += static_cast<std::uint32_t>(f.destination_b);
    w[2] = f.a + (f.b - 1) * 0x10000;
    return;
  }
  w[1] += static_cast<std::uint32_t>(f.source_c);
  w[3] += static_cast<std::uint32_t>(f.destination_c);
  w[7] = high(w[7]) * 0x10000 + f.c - 1;
  if (!f.frames) w[2] = f.a + f.reload * 0x10000;
}

void Interpreter::link(unsigned set) {
  const unsigned target = low(param_[set][5]);
  if (target == 0xFFFF || target % 0x4000 / 32 > 255) {  // out of range: undefined, here as FFFFh
    param_[set] = {0, 0, 0, 0, 0, 0xFFFF, 0, 0};
    if (target != 0xFFFF) {  // an observer of the set learns of the update
      for (unsigned w = 0; w < 8; ++w) store(set, w, param_[set][w]);
    }
    return;
  }
  const Words next = param_[target % 0x4000 / 32];
  for (unsigned w = 0; w < 8; ++w) store(set, w, next[w]);
}

void Interpreter::write(std::uint32_t offset, std::uint32_t value) {
  if (offset >= 0x4000) return store((offset - 0x4000) / 32, offset / 4 % 8, value);
  if (offset >= 0x2000)
    return write_channels(static_cast<int>(offset - 0x2000) / 0x200, offset % 0x200, value);
  if (offset >= 0x1000) return write_channels(kGlobalRegion, offset - 0x1000, value);
  const unsigned half = offset / 4 % 2 * 32;
  if (offset >= 0x200 && offset < 0x220) {
    QdmaChannel& q = qdma_[(offset - 0x200) / 4];
    q.set = (value >> 5) % 512;
    q.word = (value >> 2) % 8;
  } else if (offset >= 0x240 && offset < 0x260) {
    for (unsigned i = 0; i < 8; ++i)
      dma_[(offset - 0x240) / 4 * 8 + i].queue = (value >> 4 * i) % 8;
  } else if (offset == 0x260) {
    for (unsigned i = 0; i < 8; ++i) qdma_[i].queue = (value >> 4 * i) % 8;
  } else if (offset == 0x280) {
    for (unsigned i = 0; i < 4; ++i) queues_[i].controller = (value >> 4 * i) % 8;
  } else if (offset == 0x308 || offset == 0x30C) {
    for (unsigned i = 0; i < 32; ++i)
      if (bit(value, i)) dma_[half + i].missed = false;
  } else if (offset == 0x314) {
    for (unsigned i = 0; i < 8; ++i)
      if (bit(value, i)) qdma_[i].missed = false;
  } else if (offset == 0x31C) {
    for (unsigned i = 0; i < 4; ++i) {
      if (!bit(value, i)) continue;
      queues_[i].error = queues_[i].exceeded = false;
      queues_[i].mark = 0;
    }
    if (bit(value, 16)) too_many_codes_ = false;
  } else if (offset == 0x320) {
    if (bit(value, 0) && any_error()) ++error_pulses_;
  } else if (offset >= 0x340 && offset < 0x360) {
    for (unsigned i = 0; i < 32; ++i) region_[(offset - 0x340) / 8][half + i] = bit(value, i);
  } else if (offset >= 0x380 && offset < 0x390) {
    for (unsigned i = 0; i < 8; ++i) region_qdma_[(offset - 0x380) / 4][i] = bit(value, i);
  } else if (offset == 0x620) {
    for (unsigned i = 0; i < 4; ++i) queues_[i].threshold = (value >> 8 * i) % 32;
  }
}

void Interpreter::write_channels(int region, std::uint32_t offset, std::uint32_t value) {
  if (offset == 0x78) {  // IEVAL
    if (region != kGlobalRegion && bit(value, 0) && line(static_cast<unsigned>(region)))
      ++region_pulses_[static_cast<unsigned>(region)];
    return;
  }
  if (offset >= 0x80) {
    for (unsigned i = 0; i < 8; ++i) {
      if (!bit(value, i) || !owns_qdma(region, i)) continue;
      QdmaChannel& q = qdma_[i];
      if (offset == 0x88) q.enabled = false;
      if (offset == 0x8C) q.enabled = true;
      if (offset == 0x94) q.event = q.queued = false;
    }
    return;
  }
  // Registers are 8 bytes apart, for two halves.
  watching_interrupts([&] {
    watching_errors([&] {
      for (unsigned i = 0; i < 32; ++i) {
        const unsigned n = offset / 4 % 2 * 32 + i;
        if (!bit(value, i) || !owns(region, n)) continue;
        DmaChannel& c = dma_[n];
        switch (offset / 8 * 8) {
          case 0x08:
            c.event = false;
            break;
          case 0x10:
            if (c.manual) c.missed = true;
            c.manual = true;
            break;
          case 0x28:
            c.enabled = false;
            break;
          case 0x30:
            c.enabled = true;
            break;
          case 0x40:
            c.queued = false;
            break;
          case 0x58:
            c.interrupt_enabled = false;
            break;
          case 0x60:
            c.interrupt_enabled = true;
            break;
          case 0x70:
            c.interrupt = false;
            break;
          default:
            break;
        }
      }
    });
  });
}

std::uint32_t Interpreter::read_channels(int region, std::uint32_t offset) const {
  std::uint32_t v = 0;
  if (offset >= 0x80) {
    for (unsigned i = 0; i < 8; ++i) {
      const QdmaChannel& q = qdma_[i];
      const bool b = offset == 0x80   ? q.event
                     : offset == 0x84 ? q.enabled
                                      : offset == 0x90 && q.queued;
      if (b && owns_qdma(region, i)) v += 1u << i;
    }
    return v;
  }
  for (unsigned i = 0; i < 32; ++i) {
    const unsigned n = offset / 4 % 2 * 32 + i;
    const DmaChannel& c = dma_[n];
    bool b = false;
    switch (offset / 8 * 8) {
      case 0x00:
        b = c.event;
        break;
      case 0x10:
        b = c.manual;
        break;
      case 0x18:
        b = c.chained;
        break;
      case 0x20:
        b = c.enabled;
        break;
      case 0x38:
        b = c.queued;
        break;
      case 0x50:
        b = c.interrupt_enabled;
        break;
      case 0x68:
        b = c.interrupt;
        break;
      default:
        break;
    }
    if (b && owns(region, n)) v += 1u << i;
  }
  return v;
}

std::uint32_t Interpreter::read(std::uint32_t offset) const {
  if (offset >= 0x4000) return param_[(offset - 0x4000) / 32][offset / 4 % 8];
  if (offset >= 0x2000)
    return read_channels(static_cast<int>(offset - 0x2000) / 0x200, offset % 0x200);
  if (offset >= 0x1000) return read_channels(kGlobalRegion, offset - 0x1000);
  std::uint32_t v = 0;
  if (offset == 0x300 || offset == 0x304)
    for (unsigned i = 0; i < 32; ++i) v += dma_[(offset - 0x300) * 8 + i].missed ? 1u << i : 0;
  if (offset == 0x310)
    for (unsigned i = 0; i < 8; ++i) v += qdma_[i].missed ? 1u << i : 0;
  if (offset == 0x318) {
    for (unsigned i = 0; i < 4; ++i) v += queues_[i].error ? 1u << i : 0;
    v += too_many_codes_ ? 1u << 16 : 0;
  }
  if (offset >= 0x400 && offset < 0x500) v = queues_[(offset - 0x400) / 64].slots[offset / 4 % 16];
  if (offset >= 0x600 && offset < 0x610) {
    const EventQueue& q = queues_[(offset - 0x600) / 4];
    v = q.start + static_cast<std::uint32_t>(q.entries.size()) * 0x100 + q.mark * 0x10000 +
        (q.exceeded ? 0x100'0000 : 0);
  }
  if (offset == 0x640) {
    bool events = false, qdma_events = false;
    for (const DmaChannel& c : dma_) events |= (c.event && c.enabled) || c.manual || c.chained;
    for (const QdmaChannel& c : qdma_) qdma_events |= c.event && c.enabled;
    v = (events ? 1 : 0) + (qdma_events ? 2 : 0) + outstanding_ * 0x100;
    for (unsigned i = 0; i < 4; ++i) v += queues_[i].entries.empty() ? 0 : 0x10000u << i;
    if (v) v += 0x10;
  }
  return v;
}

}  // namespace fovea::reference
