#include "model/mem/core/ddr_controller.h"

#include <bit>
#include <cstring>

#include "model/common/check.h"

namespace fovea::mem {
namespace {

/// The usual lengths in line; memcpy() of a length not known is a call.
void move_bytes(std::uint8_t* to, const std::uint8_t* from, unsigned bytes) {
  switch (bytes) {
    case 4: std::memcpy(to, from, 4); return;
    case 32: std::memcpy(to, from, 32); return;
    case 64: std::memcpy(to, from, 64); return;
    default: std::memcpy(to, from, bytes);
  }
}

}  // namespace

DdrController::DdrController(const DdrParams& params, BackingStore& store, DdrClient& client)
    : params_(params),
      store_(store),
      client_(client),
      fifo_entries_(params.command_fifo()),
      write_fifo_bytes_(static_cast<unsigned>(params.write_fifo())),
      read_fifo_bytes_(static_cast<unsigned>(params.read_fifo())),
      request_latency_(static_cast<unsigned>(params.request_latency())),
      return_latency_(static_cast<unsigned>(params.return_latency())),
      need_(static_cast<unsigned>(params.refresh_need())),
      must_(static_cast<unsigned>(params.refresh_must())),
      gap_limit_(static_cast<unsigned>(params.refresh_gap())) {
  configure(DdrConfig{}, 0);
}

void DdrController::catch_up(Picoseconds at) {
  if (count_ == 0 && running()) refresh_while_idle(ddr_.edge_after(at));
}

void DdrController::set_clocks(Frequency ddr, Frequency scr, Picoseconds at) {
  catch_up(at);
  if (!(ddr == ddr_.frequency())) ddr_.restart(ddr, at);
  if (!(scr == scr_.frequency())) scr_.restart(scr, at);
  if (ddr_.running()) floor_ = ddr_.edge_after(at);
  if (scr_.running()) start_of_lane_ = scr_.edge_at_or_after(scr_.start());
  plan();
}

void DdrController::configure(const DdrConfig& config, Picoseconds at) {
  catch_up(at);
  // Refresh keeps its phase when only timing changes; a new interval starts to count now.
  if (config.refresh_interval != config_.refresh_interval || next_expiry_ == 0)
    next_expiry_ =
        (ddr_.running() ? ddr_.edge_after(at) : 0) + std::max(1u, config.refresh_interval);
  floor_ = ddr_.running() ? ddr_.edge_after(at) : 0;
  config_ = config;
  device_.configure(config.timing);
  const unsigned bank_bits = static_cast<unsigned>(std::bit_width(config.timing.banks)) - 1;
  if (config.bank_on_top) {
    bank_shift_ = static_cast<unsigned>(std::bit_width(store_.size())) - 1 - bank_bits;
    row_shift_ = config.page_log2;
  } else {
    bank_shift_ = config.page_log2;
    row_shift_ = config.page_log2 + bank_bits;
  }
  plan();
}

bool DdrController::submit(const DdrRequest& request, Picoseconds at) {
  FOVEA_CHECK(running(), "request to a DDR controller without a clock");
  FOVEA_CHECK(!door_full_, "request to a DDR controller whose door is taken");
  FOVEA_CHECK(request.address + request.bytes <= store_.size() && request.bytes <= 64,
              "request outside the SDRAM reached the controller");
  // Counted at the request, as the crossbar does, so that both sums agree at any instant.
  (request.write ? stats.write_bytes : stats.read_bytes) += request.bytes;
  const std::uint64_t arrived = std::max(ddr_.edge_after(at), last_arrival_);
  if (count_ == 0 && (owed_ != 0 || next_expiry_ < arrived)) refresh_while_idle(arrived);
  if (count_ >= fifo_entries_ ||
      (request.write && write_bytes_held_ + request.bytes > write_fifo_bytes_)) {
    door_full_ = true;
    door_ = request;
    door_arrived_ = arrived;
    return false;
  }
  take(request, arrived);
  // A choice for an earlier clock than the newcomer is ready at stands.
  if (next_ == kNever || slots_[order_[count_ - 1]].ready <= choice_.at) plan();
  return true;
}

void DdrController::take(const DdrRequest& request, std::uint64_t arrived) {
  const int slot = std::countr_zero(free_slots_);
  free_slots_ &= free_slots_ - 1;
  order_[count_++] = static_cast<std::uint8_t>(slot);
  last_arrival_ = arrived;
  __builtin_prefetch(store_.at(request.address));  // the host's own memory is slow as well
  Entry& e = slots_[static_cast<std::size_t>(slot)];
  e.request = request;
  e.ready = arrived + request_latency_;
  e.bank = static_cast<std::uint8_t>((request.address >> bank_shift_) & (config_.timing.banks - 1));
  e.row = config_.bank_on_top ? (request.address & ((1u << bank_shift_) - 1)) >> row_shift_
                              : request.address >> row_shift_;
  e.chunks = static_cast<std::uint8_t>(((request.address & 15u) + request.bytes + 15u) / 16u);
  e.issued = 0;
  e.classified = false;
  if (request.write) {
    write_bytes_held_ += request.bytes;
    move_bytes(e.data.data(), request.data, request.bytes);
  }
}

Cmd DdrController::needed(const Entry& e) const {
  const std::uint32_t open = device_.row(e.bank);
  if (open == e.row) return e.request.write ? Cmd::kWr : Cmd::kRd;
  return open == DdrDevice::kClosed ? Cmd::kAct : Cmd::kPre;
}

std::uint64_t DdrController::earliest(const Entry& e, Cmd cmd, std::uint64_t edge) const {
  const std::uint64_t at = std::max(edge, device_.earliest(cmd, e.bank));
  return cmd == Cmd::kRd && e.issued == 0 ? std::max(at, read_room_) : at;
}

/// Rule 1: a master offers its oldest command; a read may pass an older write of the same master
/// that is in another 2048-byte block and not more urgent. i: place in the order of age.
bool DdrController::passes_older(std::size_t i) const {
  const DdrRequest& r = slots_[order_[i]].request;
  for (std::size_t k = 0; k < i; ++k) {
    const DdrRequest& o = slots_[order_[k]].request;
    if (o.master != r.master) continue;
    if (r.write || !o.write || (o.address >> 11) == (r.address >> 11) || o.priority < r.priority)
      return false;
  }
  return true;
}

/// Chooses the next command and its clock from the present state alone, so it does not matter when
/// or how often it is called. A decision is taken at the first edge at which something is ready; if
/// its command can only be given later, whatever becomes ready before has its say.
void DdrController::plan() {
  next_ = kNever;
  if (count_ == 0 || !running()) return;
  const std::uint64_t first = std::max(floor_, command_free_);
  if (in_service_ >= 0) {  // a burst under way is finished before anything else
    const Entry& e = slots_[static_cast<std::size_t>(in_service_)];
    const Cmd cmd = e.request.write ? Cmd::kWr : Cmd::kRd;
    choice_ = {in_service_, cmd, earliest(e, cmd, first)};
    next_ = ddr_.edge(choice_.at);
    return;
  }
  std::size_t ready = 1;
  std::uint64_t edge = std::max(first, slots_[order_[0]].ready);
  for (;;) {
    while (ready < count_ && slots_[order_[ready]].ready <= edge) ++ready;
    std::uint64_t wake = ready < count_ ? slots_[order_[ready]].ready : kNoClock;
    if (read_room_ > edge) wake = std::min(wake, read_room_);
    choice_ = choose(edge, ready);
    if (choice_.at < wake) break;
    edge = wake;
  }
  next_ = ddr_.edge(choice_.at);
}

/// The command to give if only the `ready` oldest requests are there.
DdrController::Choice DdrController::choose(std::uint64_t edge, std::size_t ready) const {
  const Urgency refresh = refresh_urgency(edge);
  if (refresh == Urgency::kMust) return choose_refresh(edge);
  if (ready == 1) {
    const Entry& e = slots_[order_[0]];
    if (refresh == Urgency::kNeed && e.request.write) return choose_refresh(edge);
    const Cmd cmd = needed(e);
    return {order_[0], cmd, earliest(e, cmd, edge)};
  }
  // Rank: the raised oldest command (rule 5), then reads, then writes; among each open rows first,
  // then priority, then age (rules 2 and 3). With the read FIFO full, writes go before reads.
  const bool raise = config_.old_count != 0xFF && served_while_oldest_ > config_.old_count;
  const bool room = read_room_ <= edge;
  std::array<std::uint32_t, kMaxEntries> ranked;
  std::size_t n = 0;
  std::uint32_t masters = 0;  // that have an older command
  std::uint32_t best_read = ~0u, best_write = ~0u;
  for (std::size_t i = 0; i < ready; ++i) {
    const Entry& e = slots_[order_[i]];
    const std::uint32_t master = 1u << index(e.request.master);
    const bool offered = !(masters & master) || passes_older(i);
    masters |= master;
    if (!offered) continue;
    const bool miss = device_.row(e.bank) != e.row;
    const std::uint32_t kind = e.request.write ? 2u : room ? 1u : 3u;
    const std::uint32_t rank = kind << 17 | std::uint32_t{miss} << 16 |
                               std::uint32_t{e.request.priority} << 8 |
                               static_cast<std::uint32_t>(i);
    (e.request.write ? best_write : best_read) =
        std::min(e.request.write ? best_write : best_read, rank);
    std::size_t at = n++;
    for (; at > 0 && ranked[at - 1] > (raise && i == 0 ? 0u : rank); --at)
      ranked[at] = ranked[at - 1];
    ranked[at] = raise && i == 0 ? 0u : rank;
  }
  // Rule 4: a needed refresh goes before writes and before a read that has a more urgent write.
  if (refresh == Urgency::kNeed) {
    const auto priority = [](std::uint32_t rank) { return rank >> 8 & 0xFFu; };
    if (best_read == ~0u || (best_write != ~0u && priority(best_write) < priority(best_read)))
      return choose_refresh(edge);
  }
  // The first in rank gets its command; others may only prepare banks that nobody above them needs.
  Choice best;
  std::uint32_t banks_above = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint8_t slot = order_[ranked[k] & 0xFFu];
    const Entry& e = slots_[slot];
    const std::uint32_t bank = 1u << e.bank;
    if (banks_above & bank) continue;
    const Cmd cmd = needed(e);
    if (k == 0 || cmd == Cmd::kAct || cmd == Cmd::kPre) {
      const std::uint64_t at = earliest(e, cmd, edge);
      if (k == 0 || at < best.at) best = {slot, cmd, at};
      if (best.at == edge) break;
    }
    banks_above |= bank;
  }
  return best;
}

DdrController::Choice DdrController::choose_refresh(std::uint64_t edge) const {
  const Cmd cmd = device_.all_closed() ? Cmd::kRef : Cmd::kPreAll;
  return {kRefresh, cmd, std::max(edge, device_.earliest(cmd, 0))};
}

DdrController::Urgency DdrController::refresh_urgency(std::uint64_t edge) const {
  unsigned expired = 0;
  if (config_.refresh_interval && edge >= next_expiry_) [[unlikely]]
    expired = 1 + static_cast<unsigned>((edge - next_expiry_) / config_.refresh_interval);
  if (forced_ > 0 || owed_ + expired > must_ || gap_ + expired > gap_limit_) return Urgency::kMust;
  return owed_ + expired > need_ ? Urgency::kNeed : Urgency::kMay;
}

void DdrController::count_owed(std::uint64_t clock) {
  if (!config_.refresh_interval) return;
  while (next_expiry_ <= clock) {
    ++owed_;
    ++gap_;
    next_expiry_ += config_.refresh_interval;
  }
}

void DdrController::issue(Cmd cmd, unsigned bank, std::uint32_t row, std::uint64_t clock) {
  device_.issue(cmd, bank, row, clock);
  command_free_ = clock + 1;
  if (hook_) hook_(hook_self_, cmd, bank, row, clock);
}

void DdrController::issue_refresh(std::uint64_t clock) {
  issue(Cmd::kRef, 0, 0, clock);
  ++stats.refreshes;
  gap_ = 0;
  if (owed_) --owed_;
  if (forced_) --forced_;
}

/// Refreshes that fell into the time without requests: at the "may" level each is done as soon as
/// it is owed. They cannot cause anything but later row misses, so they are caught up lazily.
void DdrController::refresh_while_idle(std::uint64_t until) {
  if (!config_.refresh_interval) return;
  for (;;) {
    std::uint64_t from = std::max({idle_since_, command_free_, floor_});
    if (owed_ == 0) {
      if (next_expiry_ >= until) return;
      from = std::max(from, next_expiry_);
      count_owed(from);
    }
    if (!device_.all_closed()) {
      const std::uint64_t at = std::max(from, device_.earliest(Cmd::kPreAll, 0));
      if (at >= until) return;
      issue(Cmd::kPreAll, 0, 0, at);
      from = at + 1;
    }
    const std::uint64_t at = std::max(from, device_.earliest(Cmd::kRef, 0));
    if (at >= until) return;
    count_owed(at);
    issue_refresh(at);
  }
}

void DdrController::step() {
  const Choice c = choice_;
  count_owed(c.at);
  if (c.slot == kRefresh) {
    // Too long without a refresh: four in a row before anything new.
    if (gap_ > gap_limit_ && forced_ == 0) forced_ = 4;
    if (c.cmd == Cmd::kRef)
      issue_refresh(c.at);
    else
      issue(c.cmd, 0, 0, c.at);
    plan();
    return;
  }
  const auto slot = static_cast<std::size_t>(c.slot);
  Entry& e = slots_[slot];
  if (!e.classified) {
    e.classified = true;
    if (c.cmd == Cmd::kAct)
      ++stats.row_misses;
    else if (c.cmd == Cmd::kPre)
      ++stats.row_conflicts;
    else
      ++stats.row_hits;
  }
  if (c.cmd == Cmd::kAct || c.cmd == Cmd::kPre) {
    if (c.cmd == Cmd::kAct) ++stats.activates;
    issue(c.cmd, e.bank, e.row, c.at);
  } else {
    column(slot, c.at);
  }
  plan();
}

/// One BL8 column command. The data moves with the first one, since nothing can come between the
/// bursts of a request.
void DdrController::column(std::size_t slot, std::uint64_t clock) {
  Entry& e = slots_[slot];
  issue(e.request.write ? Cmd::kWr : Cmd::kRd, e.bank, e.row, clock);
  ++stats.bursts;
  if (e.issued++ == 0) {
    in_service_ = static_cast<int>(slot);
    const DdrRequest& r = e.request;
    if (r.write) {
      move_bytes(store_.at(r.address), e.data.data(), r.bytes);
    } else {
      move_bytes(r.data, store_.at(r.address), r.bytes);
      answer_read(e, clock);
    }
  }
  if (e.issued == e.chunks) finish(slot, clock);
}

/// The last column command is given: the entry is free, and the request at the door may come in.
void DdrController::finish(std::size_t slot, std::uint64_t clock) {
  const Entry& e = slots_[slot];
  in_service_ = -1;
  if (e.request.write) write_bytes_held_ -= e.request.bytes;
  const bool oldest = order_[0] == slot;
  served_while_oldest_ = oldest ? 0 : served_while_oldest_ + e.chunks;
  std::size_t i = 0;
  while (order_[i] != slot) ++i;
  for (--count_; i < count_; ++i) order_[i] = order_[i + 1];
  free_slots_ |= 1u << slot;
  if (count_ == 0) idle_since_ = clock + 1;
  if (door_full_ && count_ < fifo_entries_ &&
      (!door_.write || write_bytes_held_ + door_.bytes <= write_fifo_bytes_)) {
    door_full_ = false;
    take(door_, std::max(door_arrived_, clock + 1));
    client_.ddr_accepted(door_.cookie, ddr_.edge(clock));
  }
}

/// The return lane to the crossbar is 64 bits wide and serves reads in the order of their data.
/// `clock`: the first column command; the others follow each other without a gap.
void DdrController::answer_read(const Entry& e, std::uint64_t clock) {
  constexpr std::uint64_t kHead = DdrTiming::kBurstClocks / 2;  // 8 bytes: 4 beats
  const unsigned latency = std::max(config_.read_latency, config_.timing.CL) + return_latency_;
  const std::uint64_t tail_clock = clock + latency + e.chunks * DdrTiming::kBurstClocks;
  const std::uint64_t arrival = scr_.edge_after(ddr_.edge(clock + latency + kHead));
  const std::uint64_t words = (e.request.bytes + 7u) / 8u;
  const std::uint64_t start = std::max(arrival, lane_free_);
  std::uint64_t end = start;
  if (words > 1 || e.chunks > 1)
    end = std::max(start + words - 1, scr_.edge_after(ddr_.edge(tail_clock)));
  lane_free_ = end + 1;
  // Rule 3: the read FIFO is full while another 64 bytes would not fit beside the words that wait
  // for the lane when their data comes. It can only fill if the lane is slower than the DDR bus.
  // Words that the lane has taken by the next read's data, at or after `arrival`, do not count.
  const std::uint64_t held = read_fifo_bytes_ / 8u - 8u;
  if (lane_free_ > start_of_lane_ + held && lane_free_ - held >= arrival) {
    const std::uint64_t room = ddr_.edge_at_or_after(scr_.edge(lane_free_ - held));
    const std::uint64_t lead = latency + kHead;  // from a RD to its data
    read_room_ = room > lead ? room - lead : 0;
  }
  client_.ddr_read_done(e.request.cookie, scr_.edge(start), scr_.edge(end));
}

}  // namespace fovea::mem
