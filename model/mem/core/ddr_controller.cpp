#include "model/mem/core/ddr_controller.h"

#include <bit>
#include <utility>

#include "model/common/check.h"
#include "model/mem/core/move_bytes.h"

namespace fovea::mem {

void DdrController::catch_up(Picoseconds at) {
  if (!running_) return;
  const std::uint64_t until = ddr_.edge_after(at);
  if (in_burst_)
    columns_before(until);
  else if (count_ == 0)
    idle(until);
  if (count_) count_queued(until);
  count_asleep(until);
  stats.row_open_clocks += device_.take_open_clocks(until);
}

/// Clocks since the queue filled, or since these were counted last.
inline void DdrController::count_queued(std::uint64_t until) {
  if (until <= queued_since_) return;
  stats.queued_clocks += until - queued_since_;
  queued_since_ = until;
}

void DdrController::count_asleep(std::uint64_t until) {
  if (asleep_ == LowPower::kOff || until <= asleep_since_) return;
  const std::uint64_t clocks = until - asleep_since_;
  asleep_since_ = until;
  (refreshes_itself(asleep_) ? stats.self_refresh_clocks : stats.power_down_clocks) += clocks;
  if (asleep_ == LowPower::kClockStop) stats.clock_stop_clocks += clocks;
  if (asleep_ == LowPower::kPowerDown && !device_.all_closed())
    stats.active_power_down_clocks += clocks;
}

bool DdrController::submit(MemRequest& r, std::uint32_t offset, Picoseconds at) {
  FOVEA_CHECK(running_, "request to a DDR controller without a clock");
  FOVEA_CHECK(!input_blocked_, "request to a DDR controller whose input register is taken");
  FOVEA_CHECK(r.bytes <= 64 && std::uint64_t{offset} + r.bytes <= size_,
              "request outside the SDRAM reached the controller");
  return take_in(r, offset, at);
}

bool DdrController::submit_inside(MemRequest& request, std::uint32_t offset, Picoseconds at) {
  return take_in(request, offset, at);
}

namespace {

/// Field by field: a copy of the whole, or by way of another one, would read bytes just written as
/// wide words, for which the host has to wait.
template <class Queued>
[[gnu::always_inline]] inline void put(Queued& r, MemRequest& from, std::uint32_t offset) {
  r.origin = &from;
  r.master = from.master;
  r.priority = from.priority;
  r.write = from.write;
  r.bytes = from.bytes;
  r.address = offset;
  r.data = from.data;
  r.parts = from.parts;
}

}  // namespace

[[gnu::always_inline]] inline bool DdrController::take_in(MemRequest& request, std::uint32_t offset,
                                                          Picoseconds at) {
  // Counted at the request, as the crossbar does, so that both sums agree at any instant.
  (request.write ? stats.write_bytes : stats.read_bytes) += request.bytes;
  const std::uint64_t arrived = std::max(ddr_.edge_after(at), last_arrival_);
  if (count_ != 0) return queue(request, offset, arrived);
  if (idle_calm_ < arrived) [[unlikely]] {
    idle(arrived);
    wake(arrived);
  }
  last_arrival_ = queued_since_ = arrived;
  count_ = 1;
  single_ = true;
  put(slots_[0].request, request, offset);
  fill(slots_[0], arrived);
  plan_one(slots_[0]);
  return true;
}

bool DdrController::queue(MemRequest& request, std::uint32_t offset, std::uint64_t arrived) {
  const bool was_alone = single_;
  if (was_alone) join_queue();
  if (count_ >= fifo_entries_ ||
      (request.write &&
       write_words_held_ + write_words(offset, request.bytes) > write_fifo_words_)) {
    input_taken_ = input_blocked_ = true;
    put(input_, request, offset);
    input_arrived_ = arrived;
    return false;
  }
  Entry& e = free_entry();
  put(e.request, request, offset);
  take(e, arrived);
  // A command chosen for a clock before the newcomer is ready stands; no other can come before then.
  const std::uint64_t seen = entry(count_ - 1).ready;
  if (in_burst_ || seen > choice_.at) return true;
  const std::uint64_t edge = std::max(command_free_, seen);
  if (!was_alone && stands_with(count_ - 1, edge, (1u << (count_ - 1)) - 1))
    next_ = ddr_.edge(choice_.at);
  else
    plan_from(edge);
  return true;
}

/// What follows from the entry's request.
inline void DdrController::fill(Entry& e, std::uint64_t arrived) const {
  const Queued& r = e.request;
  __builtin_prefetch(store_.at(r.address));  // the host's own memory is slow as well
  e.ready = arrived + request_latency_;
  e.bank = static_cast<std::uint8_t>((r.address >> bank_shift_) & bank_mask_);
  e.row = (r.address & row_mask_) >> row_shift_;
  e.chunks = static_cast<std::uint8_t>(((r.address & 15u) + r.bytes + 15u) / 16u);
  e.classified = false;
  e.prepared = 0;
  if (r.write) move_bytes(e.data.data(), r.data, r.bytes);
}

/// The single request in slot 0 becomes the first of the queue.
void DdrController::join_queue() {
  single_ = false;
  Entry& e = slots_[0];
  free_slots_ ^= 1u;
  queue_.add(0, 0, e.request.master, e.bank, e.request.priority, e.request.write);
  attribution_.begin_queue(e.ready);
  offered_ = 1u;
  hits_ = device_.row(e.bank) == e.row;
  write_words_held_ = e.request.write ? write_words(e.request.address, e.request.bytes) : 0u;
}

/// The request in this entry joins the queue as the newest one.
void DdrController::take(Entry& e, std::uint64_t arrived) {
  const Queued& request = e.request;
  const auto slot = static_cast<unsigned>(&e - slots_.data());
  const unsigned position = count_++;
  const Positions bit = 1u << position;
  free_slots_ ^= 1u << slot;
  last_arrival_ = arrived;
  fill(e, arrived);
  attribution_.joined(position, e.ready);
  const Positions older = queue_.of_master(request.master);
  queue_.add(position, slot, request.master, e.bank, request.priority, request.write);
  if (device_.row(e.bank) == e.row) hits_ |= bit;
  if (request.write) write_words_held_ += write_words(request.address, request.bytes);
  const auto goes_before = [&] {
    return policy_.free_order ? !bound_by(e, older) : !request.write && passes(e, older);
  };
  if (older == 0 || goes_before()) offered_ |= bit;
}

/// Rule 1: a master offers its oldest command; a read may pass an older write of the same master
/// that is in another 2048-byte block and not more urgent.
bool DdrController::passes(const Entry& read, Positions older) const {
  if (older & ~queue_.writes()) return false;
  const Queued& r = read.request;
  for (; older; older &= older - 1) {
    const Queued& o = entry(oldest(older)).request;
    if ((o.address >> 11) == (r.address >> 11) || o.priority < r.priority) return false;
  }
  return true;
}

/// What a master offers of its requests: no more than the oldest one and the first read.
inline void DdrController::offer(Positions of_one_master) {
  if (of_one_master == 0) return;
  offered_ |= of_one_master & -of_one_master;
  const Positions reads = of_one_master & ~queue_.writes(), first = reads & -reads;
  if (first & ~offered_ && passes(entry(oldest(first)), of_one_master & (first - 1)))
    offered_ |= first;
}

/// Chooses the next command and its clock from the present state alone, so it does not matter when
/// or how often it is called.
inline void DdrController::plan() {
  if (count_ == 0)
    next_ = kNever;
  else if (count_ > 1)
    return plan_many();
  else
    plan_one(entry(0));
  plain_ = false;
}

/// The same after a change from outside: a burst may be under way or the clock stopped.
void DdrController::plan_anew() {
  next_ = kNever;
  if (count_ == 0 || !running_) return;
  if (single_) join_queue();
  if (!in_burst_) return plan_many();
  if (next_column_ < command_free_) {  // it is finished before anything else
    choice_.at += command_free_ - next_column_;
    next_column_ = command_free_;
  }
  next_ = ddr_.edge(choice_.at);
}

/// The usual case: one request, nothing to choose from, and no refresh that is urgent.
inline void DdrController::plan_one(Entry& e) {
  const std::uint64_t edge = std::max(command_free_, e.ready);
  const Cmd cmd = needed(e);
  const std::uint64_t at = earliest(e, cmd, edge);
  if (at >= calm_until_) [[unlikely]] {
    if (single_) join_queue();
    return plan_many();
  }
  choice_ = {&e, at, cmd};
  next_ = ddr_.edge(at);
}

template <Cmd kCmd>
inline void DdrController::note(std::uint64_t clock, Picoseconds at) {
  constexpr bool kColumn = kCmd == Cmd::kRd || kCmd == Cmd::kWr;
  IssuedCommand& g = attribution_.add(clock, at, kColumn ? choice_.entry : nullptr);
  g.cmd = kCmd;
  if constexpr (kCmd == Cmd::kRef || kCmd == Cmd::kPreAll)
    g.cause = WaitAttribution::kRefreshed;
  else
    g.cause = static_cast<std::uint8_t>(index(choice_.entry->request.master));
  if constexpr (kCmd == Cmd::kAct || kCmd == Cmd::kPre)
    g.before = std::exchange(choice_.entry->prepared, attribution_.count());
}

template <Cmd kCmd>
inline void DdrController::issue(unsigned bank, std::uint32_t row, std::uint64_t clock,
                                 Picoseconds at) {
  device_.issue<kCmd>(bank, row, clock);
  if constexpr (kCmd == Cmd::kAct) {
    for (Positions set = queue_.of_bank(bank); set; set &= set - 1)
      if (entry(oldest(set)).row == row) hits_ |= set & -set;
  } else if constexpr (kCmd == Cmd::kPre) {
    hits_ &= ~queue_.of_bank(bank);
  } else if constexpr (kCmd == Cmd::kPreAll) {
    hits_ = 0;
  }
  command_free_ = clock + 1;
  note<kCmd>(clock, at);
  if (hook_) [[unlikely]]
    hook_(hook_self_, kCmd, bank, row, clock);
}

void DdrController::issue_refresh(std::uint64_t clock, Picoseconds at) {
  issue<Cmd::kRef>(0, 0, clock, at);
  ++stats.refreshes;
  gap_ = 0;
  if (owed_) --owed_;
  if (forced_) --forced_;
  if (owed_ <= release_) catching_up_ = false;
  closing_ = false;
  urgency_changed();
}

/// What falls into the time without requests: at the "may" level each refresh is done as soon as it
/// is owed; then the part goes to sleep, if software allows it. The PREA belongs to the REF: once it is
/// issued, a request that comes waits for both. This cannot cause anything but later row misses and
/// waiting, so it is caught up lazily.
[[gnu::noinline]] void DdrController::idle(std::uint64_t until) {
  for (;;) {
    if (refreshes_itself(asleep_)) return;
    if (asleep_ == LowPower::kPowerDown) {
      const std::uint64_t at = std::max(next_expiry_, cke_free_);
      if (at >= until) return;
      wake(at);
    }
    std::uint64_t from = command_free_;
    if (owed_ == 0) {
      if (config_.low_power != LowPower::kOff && fall_asleep(std::min(until, next_expiry_)))
        continue;
      pass_over_refreshes(until);
      if (next_expiry_ >= until) return;
      from = std::max(command_free_, next_expiry_);
      if (from >= until) return;
      count_owed(from);
    }
    if (!config_.refresh_interval && !closing_) return;  // owed from before it was switched off
    if (!device_.all_closed()) {
      const std::uint64_t at = std::max(from, device_.earliest_pre_all());
      if (at >= until) return;
      issue<Cmd::kPreAll>(0, 0, at, ddr_.edge(at));
      closing_ = true;
      urgency_changed();
      from = at + 1;
    }
    const std::uint64_t at = std::max(from, device_.earliest_refresh());
    if (at >= until) return;
    count_owed(at);
    issue_refresh(at, ddr_.edge(at));
  }
}

/// Entry with the last data over, before `until`. Power-down leaves rows open; self-refresh needs
/// them closed. Entry at once, rather than after some time without requests, is assumed.
bool DdrController::fall_asleep(std::uint64_t until) {
  const bool self_refresh = refreshes_itself(config_.low_power);
  if (self_refresh && !device_.all_closed()) {
    const std::uint64_t at = std::max(command_free_, device_.earliest_pre_all());
    if (at >= until) return false;
    issue<Cmd::kPreAll>(0, 0, at, ddr_.edge(at));
  }
  std::uint64_t at = std::max({command_free_, device_.quiet(), cke_free_});
  if (self_refresh) at = std::max(at, device_.earliest_refresh());
  if (at >= until) return false;
  asleep_ = config_.low_power;
  asleep_since_ = at;
  asleep_at_ = ddr_.edge(at);
  cke_free_ = at + config_.timing.nCKE;
  ++(self_refresh ? stats.self_refreshes : stats.power_downs);
  mark(self_refresh ? Cmd::kSre : Cmd::kPde, at);
  return true;
}

/// CKE rises for what comes at `clock`; commands follow tXP later, or tXSNR and for reads tXSRD.
/// After self-refresh the refresh interval starts anew (assumed).
[[gnu::noinline]] void DdrController::wake(std::uint64_t clock) {
  if (asleep_ == LowPower::kOff) return;
  const DdrTiming& t = config_.timing;
  const bool self_refresh = refreshes_itself(asleep_);
  if (asleep_ == LowPower::kClockStop) clock += clock_restart_;
  const std::uint64_t at = std::max(clock, cke_free_);
  count_asleep(at);
  asleep_ = LowPower::kOff;
  cke_free_ = at + t.nCKE;
  mark(self_refresh ? Cmd::kSrx : Cmd::kPdx, at);
  command_free_ = at + (self_refresh ? t.nXSNR : t.nXP);
  if (!self_refresh) return;
  lose_unrefreshed(ddr_.edge(at) - asleep_at_);
  device_.put_off_reads(at + t.nXSRD);
  owed_ = gap_ = 0;
  if (config_.refresh_interval) next_expiry_ = at + config_.refresh_interval;
  urgency_changed();
}

void DdrController::mark(Cmd cmd, std::uint64_t clock) {
  command_free_ = std::max(command_free_, clock + 1);
  IssuedCommand& g = attribution_.add(clock, ddr_.edge(clock));
  g.cmd = cmd;
  g.cause = WaitAttribution::kAsleep;
  if (hook_) hook_(hook_self_, cmd, 0, 0, clock);
}

void DdrController::step() {
  if (choice_.at >= next_expiry_) [[unlikely]]
    count_owed(choice_.at);
  if (choice_.cmd == Cmd::kWr) return in_burst_ ? last_column<Cmd::kWr>() : first_column<Cmd::kWr>();
  if (choice_.cmd == Cmd::kRd) return in_burst_ ? last_column<Cmd::kRd>() : first_column<Cmd::kRd>();
  prepare();
}

/// Whatever is no column command.
[[gnu::noinline]] void DdrController::prepare() {
  const std::uint64_t clock = choice_.at;
  Entry* const e = choice_.entry;
  switch (choice_.cmd) {
    case Cmd::kAct:
      if (!e->classified) {
        ++stats.row_misses;
        ++stats.bank[e->bank].row_misses;
      }
      e->classified = true;
      ++stats.activates;
      issue<Cmd::kAct>(e->bank, e->row, clock, next_);
      break;
    case Cmd::kPre:
      if (!e) {
        close_overdue_row(clock);
        break;
      }
      if (!e->classified) {
        ++stats.row_conflicts;
        ++stats.bank[e->bank].row_conflicts;
      }
      e->classified = true;
      issue<Cmd::kPre>(e->bank, e->row, clock, next_);
      break;
    case Cmd::kPreAll:
      begin_refresh();
      issue<Cmd::kPreAll>(0, 0, clock, next_);
      break;
    default:
      begin_refresh();
      issue_refresh(clock, next_);
      break;
  }
  plan();
}

bool DdrController::row_wanted(const Entry& by_others) const {
  if (single_) return false;
  for (unsigned i = 0; i < count_; ++i) {
    const Entry& o = entry(i);
    if (&o != &by_others && o.bank == by_others.bank && o.row == by_others.row) return true;
  }
  return false;
}

/// The last column of a request under the closed-page rule.
template <Cmd kCmd>
[[gnu::noinline]] void DdrController::issue_closing_column(const Entry& e, std::uint64_t clock) {
  if (row_wanted(e)) return issue<kCmd>(e.bank, e.row, clock, next_);
  device_.issue<kCmd>(e.bank, e.row, clock);
  device_.close_when_legal(e.bank);
  hits_ &= ~queue_.of_bank(e.bank);
  command_free_ = clock + 1;
  note<kCmd>(clock, next_);
  if (hook_) hook_(hook_self_, kCmd == Cmd::kRd ? Cmd::kRda : Cmd::kWra, e.bank, e.row, clock);
}

/// The first BL8 column command of a request. All its data moves now, since nothing can come
/// between its bursts; for the same reason the next decision is its last column.
template <Cmd kCmd>
void DdrController::first_column() {
  const Entry& e = *choice_.entry;
  const Queued& r = e.request;
  const std::uint64_t clock = choice_.at;
  if (!e.classified) {
    ++stats.row_hits;
    ++stats.bank[e.bank].row_hits;
  }
  if constexpr (kCmd == Cmd::kRd) {
    attribution_.waited = 0;
    if (clock > e.ready) attribution_.attribute(e, clock, next_, !single_);
  }
  if (policy_.closes_rows && e.chunks == 1) [[unlikely]]
    issue_closing_column<kCmd>(e, clock);
  else
    issue<kCmd>(e.bank, e.row, clock, next_);
  ++stats.bursts;
  if constexpr (kCmd == Cmd::kWr) {
    move_bytes(store_.at(r.address), e.data.data(), r.bytes);
  } else {
    move_bytes(r.data, store_.at(r.address), r.bytes);
    const ReturnChannel::Span transfer = return_channel_.take(r.bytes, e.chunks, clock, ddr_, scr_);
    if (policy_.free_order) [[unlikely]]
      report_in_order(e, transfer);
    else
      report_read(r.origin, transfer.first, transfer.last);
  }
  if (e.chunks == 1) return finish(clock);
  // No turnaround lies between the columns of a write, so the history shows this one as a RD.
  if constexpr (kCmd == Cmd::kWr) attribution_.newest().cmd = Cmd::kRd;
  in_burst_ = true;
  columns_left_ = e.chunks - 1u;
  next_column_ = clock + DdrTiming::kBurstClocks;
  choice_.at = clock + columns_left_ * DdrTiming::kBurstClocks;
  next_ = ddr_.edge(choice_.at);
}

/// The last column command, and those inside the burst that catch_up() has not issued yet. Every
/// constraint that they would set, the last one sets later.
template <Cmd kCmd>
void DdrController::last_column() {
  const Entry& e = *choice_.entry;
  const std::uint64_t clock = choice_.at;
  in_burst_ = false;
  stats.bursts += columns_left_;
  if (hook_) [[unlikely]] {
    for (; columns_left_ > 1; --columns_left_, next_column_ += DdrTiming::kBurstClocks)
      hook_(hook_self_, kCmd, e.bank, e.row, next_column_);
  }
  if (policy_.closes_rows) [[unlikely]]
    issue_closing_column<kCmd>(e, clock);
  else
    issue<kCmd>(e.bank, e.row, clock, next_);
  finish(clock);
}

/// Gives the columns inside the burst under way that come before `until`. They are not noted: who is
/// to blame must not depend on whether somebody looked.
[[gnu::noinline]] void DdrController::columns_before(std::uint64_t until) {
  const Entry& e = *choice_.entry;
  for (; columns_left_ > 1 && next_column_ < until; --columns_left_) {
    count_owed(next_column_);
    if (e.request.write)
      device_.issue<Cmd::kWr>(e.bank, e.row, next_column_);
    else
      device_.issue<Cmd::kRd>(e.bank, e.row, next_column_);
    command_free_ = next_column_ + 1;
    if (hook_) hook_(hook_self_, choice_.cmd, e.bank, e.row, next_column_);
    ++stats.bursts;
    next_column_ += DdrTiming::kBurstClocks;
  }
}

/// The last column command is issued: the entry is free, and the request in the input register may
/// enter.
[[gnu::always_inline]] inline void DdrController::finish(std::uint64_t clock) {
  if (!single_) return finish_queued(clock);
  single_ = false;
  served_while_oldest_ = 0;
  count_ = 0;
  count_queued(clock + 1);
  next_ = kNever;
}

[[gnu::noinline]] void DdrController::finish_queued(std::uint64_t clock) {
  leave_queue();
  if (input_taken_) accept_waiting(clock);
  if (count_ == 0)
    count_queued(clock + 1);
  else if (entry(0).ready > clock + 1 + request_latency_) [[unlikely]]
    idle_until_arrival(clock);
  plan();
}

/// What is queued has only been announced: the crossbar says at the grant when the last beat will be
/// here. Nothing else comes before that.
[[gnu::noinline]] void DdrController::idle_until_arrival(std::uint64_t clock) {
  const std::uint64_t arrives = entry(0).ready - request_latency_;
  count_queued(clock + 1);
  queued_since_ = arrives;
  if (idle_calm_ >= arrives) return;
  idle(arrives);
  wake(arrives);
}

inline void DdrController::leave_queue() {
  const Entry& e = *choice_.entry;
  const unsigned position = choice_.position;
  if (e.request.write) write_words_held_ -= write_words(e.request.address, e.request.bytes);
  free_slots_ |= 1u << queue_.slot(position);
  queue_.leave(position, e.request.priority);
  offered_ = QueuePositions::without(position, offered_);
  hits_ = QueuePositions::without(position, hits_);
  --count_;
  attribution_.left(position);
  served_while_oldest_ = position == 0 ? 0 : served_while_oldest_ + e.chunks;
  const Positions others = queue_.of_master(e.request.master);
  if (policy_.free_order) [[unlikely]]
    return offer_all(others);
  offer(others);
}

void DdrController::accept_waiting(std::uint64_t clock) {
  if (count_ >= fifo_entries_ ||
      (input_.write && write_words_held_ + write_words(input_.address, input_.bytes) > write_fifo_words_))
    return;
  input_taken_ = input_blocked_ = false;
  Entry& e = free_entry();
  e.request = input_;
  take(e, std::max(input_arrived_, clock + 1));
  news_.accepted = {input_.origin, ddr_.edge(clock), choice_.entry->request.master};
  news_.any = true;
}

}  // namespace fovea::mem
