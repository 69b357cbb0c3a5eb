#include "model/dma/core/channel_controller.h"

#include <algorithm>
#include <bit>

namespace fovea::dma {
namespace {

constexpr std::uint64_t bit(unsigned n) { return std::uint64_t{1} << n; }
constexpr std::uint32_t kQdmaMask = (1u << kQdmaChannels) - 1;
/// Most completion codes that may be outstanding. At this number the controller serves no queue (SPRUH73H,
/// CCSTAT.COMPACTV).
constexpr unsigned kMostCodes = 63;

/// Calls f with the 64 bits that a write to one half means.
template <class F>
void on_write(RegPair& pair, F f) {
  pair.lo.on_write([f](std::uint32_t word) { f(std::uint64_t{word}); });
  pair.hi.on_write([f](std::uint32_t word) { f(std::uint64_t{word} << 32); });
}

}  // namespace

ChannelController::ChannelController(EdmaRegs& regs, Host& host) : regs_(regs), host_(host) {
  install_global();
  for (unsigned r = 0; r < kShadowRegions; ++r) install_region(r);
  for (unsigned s = 0; s < kParamSets; ++s)
    for (unsigned w = 0; w < kParamWords; ++w) {
      regs_.param[s].word[w]->on_read([this] { ++counts_.words_read; });
      regs_.param[s].word[w]->on_write([this, s, w](std::uint32_t) {
        ++counts_.words_written;
        write_trigger(s, w, host_.trigger());
      });
    }
}

/// Registers that exist once.
void ChannelController::install_global() {
  install(
      regs_.global, [] { return ~std::uint64_t{0}; }, [] { return kQdmaMask; });
  regs_.global.ieval.on_write([this](std::uint32_t) {
    host_.warn("IEVAL of the global region: its interrupt is not connected on this chip");
  });
  on_write(regs_.emcr, [this](std::uint64_t bits) { regs_.emr.set(regs_.emr.get() & ~bits); });
  regs_.qemcr.on_write([this](std::uint32_t bits) { regs_.qemr.set(regs_.qemr.get() & ~bits); });
  regs_.ccerrclr.on_write([this](std::uint32_t) {
    const std::uint32_t queues = regs_.ccerrclr.threshold.get();
    regs_.ccerr.threshold.set(regs_.ccerr.threshold.get() & ~queues);
    if (regs_.ccerrclr.codes.get()) regs_.ccerr.codes.set(0);
    for (unsigned q = 0; q < kQueues; ++q)
      if (queues >> q & 1) {
        regs_.qstat[q]->mark.set(0);
        regs_.qstat[q]->exceeded.set(0);
      }
  });
  regs_.eeval.on_write([this](std::uint32_t word) {
    if ((word & 1) && errors()) host_.pulse_error();
  });
  regs_.ccstat.on_read([this] { regs_.ccstat.set(status()); });
  for (auto& map : regs_.qchmap)
    map->on_write([this, &map = *map](std::uint32_t) {
      if (map.set.get() >= kParamSets)
        host_.warn(map.name() + " names set " + std::to_string(map.set.get()) +
                   ", whose writes trigger nothing; allowed: 0 to 255");
    });
}

void ChannelController::install_region(unsigned region) {
  const auto mask = [this, region] { return regs_.drae[region]->get(); };
  const auto qdma_mask = [this, region] { return regs_.qrae[region]->get() & kQdmaMask; };
  ChannelRegs& view = *regs_.shadow[region];
  install(view, mask, qdma_mask);
  view.ieval.on_write([this, region, mask](std::uint32_t word) {
    if ((word & 1) && (regs_.global.ipr.get() & regs_.global.ier.get() & mask()))
      host_.pulse_completion(region);
  });
  const auto show = [mask](RegPair& shown, const RegPair& whole) {
    const auto update = [&shown, &whole, mask] { shown.set(whole.get() & mask()); };
    shown.lo.on_read(update);
    shown.hi.on_read(update);
  };
  const ChannelRegs& g = regs_.global;
  show(view.er, g.er);
  show(view.esr, g.esr);
  show(view.cer, g.cer);
  show(view.eer, g.eer);
  show(view.ser, g.ser);
  show(view.ier, g.ier);
  show(view.ipr, g.ipr);
  const auto show_qdma = [qdma_mask](Reg& shown, const Reg& whole) {
    shown.on_read([&shown, &whole, qdma_mask] { shown.set(whole.get() & qdma_mask()); });
  };
  show_qdma(view.qer, g.qer);
  show_qdma(view.qeer, g.qeer);
  show_qdma(view.qser, g.qser);
}

/// What writes to one set of channel registers do. They act on the global registers, as far as the
/// masks permit.
void ChannelController::install(ChannelRegs& view, std::function<std::uint64_t()> mask,
                                std::function<std::uint32_t()> qdma_mask) {
  ChannelRegs& g = regs_.global;
  const auto set = [](RegPair& r, std::uint64_t bits) { r.set(r.get() | bits); };
  const auto clear = [](RegPair& r, std::uint64_t bits) { r.set(r.get() & ~bits); };
  on_write(view.ecr, [=, &g](std::uint64_t bits) { clear(g.er, bits & mask()); });
  on_write(view.esr, [=, this](std::uint64_t bits) { set_manual(bits & mask()); });
  on_write(view.eecr, [=, &g](std::uint64_t bits) { clear(g.eer, bits & mask()); });
  on_write(view.eesr, [=, this, &g](std::uint64_t bits) {
    set(g.eer, bits & mask());
    host_.events_enabled(bits & mask());
    host_.work_arrived();
  });
  on_write(view.secr, [=, this, &g](std::uint64_t bits) {
    clear(g.ser, bits & mask());
    host_.work_arrived();
  });
  on_write(view.iecr, [=, this, &g](std::uint64_t bits) {
    change_interrupts([&] { clear(g.ier, bits & mask()); });
  });
  on_write(view.iesr, [=, this, &g](std::uint64_t bits) {
    change_interrupts([&] { set(g.ier, bits & mask()); });
  });
  on_write(view.icr, [=, this, &g](std::uint64_t bits) {
    change_interrupts([&] { clear(g.ipr, bits & mask()); });
  });
  view.qeecr.on_write([=, &g](std::uint32_t bits) { g.qeer.set(g.qeer.get() & ~(bits & qdma_mask())); });
  view.qeesr.on_write([=, this, &g](std::uint32_t bits) {
    g.qeer.set(g.qeer.get() | (bits & qdma_mask()));
    host_.work_arrived();
  });
  view.qsecr.on_write([=, this, &g](std::uint32_t bits) {
    g.qser.set(g.qser.get() & ~(bits & qdma_mask()));
    g.qer.set(g.qer.get() & ~(bits & qdma_mask()));
    host_.work_arrived();
  });
}

void ChannelController::reset() {
  queues_ = {};
  outstanding_codes_ = 0;
}

bool ChannelController::errors() const {
  return regs_.emr.get() || regs_.qemr.get() || regs_.ccerr.get();
}

/// An error is pulsed only if no other one is pending.
void ChannelController::miss(std::uint64_t bits) {
  if (!bits) return;
  const bool first = !errors();
  counts_.missed += static_cast<unsigned>(std::popcount(bits));
  regs_.emr.set(regs_.emr.get() | bits);
  if (first) host_.pulse_error();
}

void ChannelController::miss_qdma(std::uint32_t bits) {
  if (!bits) return;
  const bool first = !errors();
  counts_.missed += static_cast<unsigned>(std::popcount(bits));
  regs_.qemr.set(regs_.qemr.get() | bits);
  if (first) host_.pulse_error();
}

void ChannelController::set_error(std::uint32_t threshold, bool codes) {
  const bool first = !errors();
  regs_.ccerr.threshold.set(regs_.ccerr.threshold.get() | threshold);
  if (codes) regs_.ccerr.codes.set(1);
  if (first) host_.pulse_error();
}

/// A shadow region's interrupt is pulsed when the first of its enabled interrupts becomes pending.
template <class Change>
void ChannelController::change_interrupts(Change change) {
  const auto active = [this] { return regs_.global.ipr.get() & regs_.global.ier.get(); };
  const std::uint64_t before = active();
  change();
  const std::uint64_t after = active();
  for (unsigned r = 0; r < kShadowRegions; ++r) {
    const std::uint64_t mask = regs_.drae[r]->get();
    if (!(before & mask) && (after & mask)) host_.pulse_completion(r);
  }
}

/// The event is latched whether or not it is enabled. It is missed if the channel has an event pending
/// that waits for service; pending events of a channel that is not enabled wait for no service, or the
/// timers' events would report errors on every unused channel (assumed: the guides speak of an event
/// that "is being processed").
void ChannelController::event(unsigned channel, Picoseconds at) {
  ChannelRegs& g = regs_.global;
  const std::uint64_t e = bit(channel);
  if (g.er.get() & g.eer.get() & e) return miss(e);
  g.er.set(g.er.get() | e);
  by(Trigger::kEvent, channel) = {.at = at};
  if (g.eer.get() & e) host_.work_arrived();
}

void ChannelController::set_manual(std::uint64_t bits) {
  ChannelRegs& g = regs_.global;
  miss(g.esr.get() & bits);
  g.esr.set(g.esr.get() | bits);
  if (!bits) return;
  host_.trigger_written();
  for (std::uint64_t left = bits; left; left &= left - 1)
    by(Trigger::kManual, static_cast<unsigned>(std::countr_zero(left))) = host_.trigger();
  host_.work_arrived();
}

void ChannelController::set_chained(unsigned channel, const TransferTrigger& by_whom) {
  ChannelRegs& g = regs_.global;
  miss(g.cer.get() & bit(channel));
  g.cer.set(g.cer.get() | bit(channel));
  by(Trigger::kChain, channel) = by_whom;
  host_.work_arrived();
}

/// A write to the trigger word of a QDMA channel's set, by software or by a link.
void ChannelController::write_trigger(unsigned set, unsigned word, const TransferTrigger& by_whom) {
  ChannelRegs& g = regs_.global;
  for (unsigned c = 0; c < kQdmaChannels; ++c) {
    const EdmaRegs::QdmaMap& map = *regs_.qchmap[c];
    if (map.set.get() != set || map.trigger.get() != word || !(g.qeer.get() >> c & 1)) continue;
    if (by_whom.kind == TransferTrigger::Kind::kWrite) host_.trigger_written();
    if (g.qer.get() >> c & 1) {
      miss_qdma(1u << c);
    } else {
      g.qer.set(g.qer.get() | 1u << c);
      by(Trigger::kQdma, c) = by_whom;
    }
    host_.work_arrived();
  }
}

/// Channels whose event may be queued: pending, and not queued already.
std::uint64_t ChannelController::pending() const {
  const ChannelRegs& g = regs_.global;
  return ((g.er.get() & g.eer.get()) | g.cer.get() | g.esr.get()) & ~g.ser.get();
}

/// The lowest channel first, DMA before QDMA; of one channel's sources hardware event, then chain, then
/// software. A full queue holds its channels back, others pass.
bool ChannelController::prioritise(Picoseconds ready) {
  ChannelRegs& g = regs_.global;
  for (std::uint64_t left = pending(); left; left &= left - 1) {
    const auto c = static_cast<unsigned>(std::countr_zero(left));
    const bool event = g.er.get() & g.eer.get() & bit(c), chain = g.cer.get() & bit(c);
    const Trigger trigger = event ? Trigger::kEvent : chain ? Trigger::kChain : Trigger::kManual;
    if (!push(regs_.queue_of(c), {trigger, static_cast<std::uint8_t>(c), ready, by(trigger, c)})) continue;
    RegPair& source = event ? g.er : chain ? g.cer : g.esr;
    source.set(source.get() & ~bit(c));
    g.ser.set(g.ser.get() | bit(c));
    return true;
  }
  for (unsigned c = 0; c < kQdmaChannels; ++c) {
    if (!((g.qer.get() & g.qeer.get() & ~g.qser.get()) >> c & 1)) continue;
    if (!push(regs_.queue_of_qdma(c),
              {Trigger::kQdma, static_cast<std::uint8_t>(c), ready, by(Trigger::kQdma, c)}))
      continue;
    g.qer.set(g.qer.get() & ~(1u << c));
    g.qser.set(g.qser.get() | 1u << c);
    return true;
  }
  return false;
}

bool ChannelController::push(unsigned queue, const Entry& e) {
  if (queue >= kQueues) {
    host_.warn("DMAQNUM or QDMAQNUM names event queue " + std::to_string(queue) +
               "; allowed: 0 to 3");
    queue %= kQueues;
  }
  Queue& q = queues_[queue];
  if (q.count == kQueueDepth) return false;
  const unsigned at = (q.head + q.count++) % kQueueDepth;
  q.entry[at] = e;
  ++counts_.events;
  regs_.entry[queue * kQueueDepth + at]->set(static_cast<std::uint32_t>(e.trigger) << 6 | e.channel);
  show(queue);
  return true;
}

/// QSTAT after a change of the queue, with watermark and threshold. A threshold above 16 is off.
void ChannelController::show(unsigned queue) {
  const Queue& q = queues_[queue];
  EdmaRegs::QueueStatus& s = *regs_.qstat[queue];
  s.start.set(q.head);
  s.count.set(q.count);
  if (q.count > s.mark.get()) s.mark.set(q.count);
  if (q.count > regs_.threshold(queue) && !s.exceeded.get()) {
    s.exceeded.set(1);
    set_error(1u << queue, false);
  }
}

Picoseconds ChannelController::next_turn() const {
  Picoseconds t = kNever;
  for (const Queue& q : queues_)
    if (q.count > 0) t = std::min(t, q.entry[q.head].ready);
  return t;
}

Picoseconds ChannelController::next_turn_after(Picoseconds now) const {
  Picoseconds t = kNever;
  for (const Queue& q : queues_)
    if (q.count > 0 && q.entry[q.head].ready > now) t = std::min(t, q.entry[q.head].ready);
  return t;
}

bool ChannelController::process(Picoseconds now) {
  if (outstanding_codes_ == kMostCodes) return false;
  for (unsigned q = 0; q < kQueues; ++q) {
    if (queues_[q].count == 0 || queues_[q].entry[queues_[q].head].ready > now) continue;
    const unsigned controller = regs_.quetcmap.queue[q]->get();
    if (controller >= kQueues) {
      host_.warn("QUETCMAP names transfer controller " + std::to_string(controller) +
                 "; allowed: 0 to 3");
      continue;
    }
    if (!host_.can_submit(controller)) continue;
    serve(q, controller, now);
    return true;
  }
  return false;
}

/// The head of a queue: a null set is an error and blocks its channel; a dummy set completes here; any
/// other is submitted. Then the set moves on, or is replaced by the one it links to.
void ChannelController::serve(unsigned queue, unsigned controller, Picoseconds now) {
  Queue& q = queues_[queue];
  const Entry e = q.entry[q.head];
  q.head = (q.head + 1) % kQueueDepth;
  --q.count;
  show(queue);
  const bool qdma = e.trigger == Trigger::kQdma;
  ChannelRegs& g = regs_.global;
  const unsigned index = qdma ? regs_.qchmap[e.channel]->set.get() % kParamSets : e.channel;
  ParamSet set = load(index);
  const bool final = set.final();
  if (set.null()) {
    qdma ? miss_qdma(1u << e.channel) : miss(bit(e.channel));
  } else {
    qdma ? g.qser.set(g.qser.get() & ~(1u << e.channel)) : g.ser.set(g.ser.get() & ~bit(e.channel));
  }
  const bool moves = !set.null() && !set.dummy();
  TransferRequest r = moves ? set.request() : TransferRequest{};
  r.controller = static_cast<std::uint8_t>(controller);
  r.number = requested_[controller]++;
  host_.requested(r, e.by, e.ready);
  const TransferTrigger submitted{.kind = TransferTrigger::Kind::kSubmitted, .controller = r.controller,
                                  .number = r.number, .at = now};
  if (!moves) {
    report(set, final, submitted);
  } else {
    check_width(index, set);
    ++counts_.requests;
    if (set.opt(ParamSet::kEarly)) {
      report(set, final, submitted);
      r.interrupt = r.chain = false;
    }
    if (r.interrupt || r.chain) {
      if (++outstanding_codes_ == kMostCodes) set_error(0, true);
    }
    host_.submit(controller, r);
  }
  if (!set.opt(ParamSet::kStatic)) {
    if (final) {
      exhausted(index, submitted);
    } else {
      set.advance();
      store(index, set);
    }
  }
  host_.work_arrived();
}

/// FWID acts on a side with constant addressing only.
void ChannelController::check_width(unsigned index, const ParamSet& set) {
  constexpr std::uint32_t kConstant = ParamSet::kSourceConstant | ParamSet::kDestinationConstant;
  if (set.opt(kConstant) && set.width() > ParamSet::kWidest)
    host_.warn("PARAM" + std::to_string(index) + " has OPT.FWID " + std::to_string(set.width()) +
               ", which is reserved and taken as 256 bits; allowed: 0 to 5");
}

ParamSet ChannelController::load(unsigned set) {
  ++counts_.sets_read;
  return regs_.load(set);
}

void ChannelController::store(unsigned set, const ParamSet& value) {
  ++counts_.sets_written;
  regs_.store(set, value);
}

/// The completion code of a set that the channel controller completes by itself.
void ChannelController::report(const ParamSet& set, bool final, const TransferTrigger& by_whom) {
  const bool interrupt =
      set.opt(final ? ParamSet::kFinalInterrupt : ParamSet::kIntermediateInterrupt);
  const bool chain = set.opt(final ? ParamSet::kFinalChain : ParamSet::kIntermediateChain);
  if (interrupt) {
    host_.coded(by_whom);
    change_interrupts(
        [&] { regs_.global.ipr.set(regs_.global.ipr.get() | bit(set.tcc())); });
  }
  if (chain) set_chained(set.tcc(), by_whom);
}

void ChannelController::dropped(const TransferRequest& r) {
  if (r.interrupt || r.chain) --outstanding_codes_;
}

void ChannelController::completed(const TransferRequest& r, Picoseconds ended) {
  if (!r.interrupt && !r.chain) return;
  --outstanding_codes_;
  const TransferTrigger end{.kind = TransferTrigger::Kind::kEnded, .controller = r.controller,
                            .number = r.number, .at = ended};
  if (r.interrupt) {
    host_.coded(end);
    change_interrupts([&] { regs_.global.ipr.set(regs_.global.ipr.get() | bit(r.tcc)); });
  }
  if (r.chain) set_chained(r.tcc, end);
}

/// Links an exhausted set. LINK is the address of a set; its bits 15:14 and 4:0 are ignored, so that
/// offsets from the block and from the parameter RAM mean the same.
void ChannelController::exhausted(unsigned index, const TransferTrigger& by_whom) {
  const ParamSet old = regs_.load(index);
  ParamSet next = ParamSet::unlinked();
  if (old.link() != ParamSet::kNoLink) {
    const unsigned from = (old.link() & 0x3FFF) / (4 * kParamWords);
    if (from < kParamSets) {
      next = load(from);
      ++counts_.links;
    } else {
      host_.warn("PARAM" + std::to_string(index) + " links to set " + std::to_string(from) +
                 "; allowed: 0 to 255");
    }
  }
  store(index, next);
  if (old.link() == ParamSet::kNoLink) return;
  for (unsigned w = 0; w < kParamWords; ++w) write_trigger(index, w, by_whom);
}

std::uint32_t ChannelController::status() const {
  const ChannelRegs& g = regs_.global;
  std::uint32_t queues = 0;
  for (unsigned q = 0; q < kQueues; ++q) queues |= (queues_[q].count > 0) << q;
  const std::uint32_t events = ((g.er.get() & g.eer.get()) | g.cer.get() | g.esr.get()) != 0;
  const std::uint32_t qdma = (g.qer.get() & g.qeer.get()) != 0;
  const std::uint32_t forming = host_.forms_request();
  const std::uint32_t active = events || qdma || forming || queues || outstanding_codes_;
  return events | qdma << 1 | forming << 2 | active << 4 | (outstanding_codes_ & 0x3F) << 8 | queues << 16;
}

}  // namespace fovea::dma
