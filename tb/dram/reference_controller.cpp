#include "tb/dram/reference_controller.h"

#include <algorithm>
#include <tuple>

namespace fovea::dram {

namespace {
constexpr unsigned kBurst = 4;          // clocks of a BL8 on the data bus
constexpr unsigned kLongestRule = 400;  // no rule reaches further back than this, in clocks
}  // namespace

ReferenceController::ReferenceController(const ReferenceLimits& limits)
    : limits_(limits), configs_(1), expiry_(configs_.back().refresh_interval) {}

void ReferenceController::set_clocks(Frequency ddr, Frequency scr, Picoseconds at) {
  if (ddr_.running()) idle_until(at);
  if (!(ddr == ddr_.frequency())) ddr_.restart(ddr, at);
  if (!(scr == scr_.frequency())) scr_.restart(scr, at);
  not_before_ = ddr_.edge_after(at);
  channel_start_ = scr_.edge_at_or_after(scr_.start());
}

void ReferenceController::configure(const ReferenceConfig& config, Picoseconds at) {
  using Sleep = ReferenceConfig::Sleep;
  idle_until(at);
  const auto refreshes_itself = [](Sleep s) {
    return s == Sleep::kSelfRefresh || s == Sleep::kClockStop;
  };
  if (refreshes_itself(asleep_) && refreshes_itself(config.sleep)) {
    if (asleep_ == Sleep::kClockStop && config.sleep == Sleep::kSelfRefresh)
      clock_runs_from_ = ddr_.edge_after(at) + limits_.clock_restart;
    if (asleep_ != config.sleep)
      clock_changes_.emplace_back(config.sleep == Sleep::kClockStop, ddr_.edge_after(at));
    asleep_ = config.sleep;
  } else if (config.sleep != configs_.back().sleep) {
    wake(ddr_.edge_after(at));
  }
  not_before_ = ddr_.edge_after(at);
  // A new interval starts to count at once; what ran out before is owed.
  if (not_before_ != 0) expire(not_before_ - 1);
  if (config.refresh_interval != configs_.back().refresh_interval)
    expiry_ = not_before_ + config.refresh_interval;
  configs_.push_back(config);
}

// ---- addresses and banks
unsigned ReferenceController::bank_of(std::uint32_t address) const {
  const ReferenceConfig& c = config();
  if (c.bank_on_top) return static_cast<unsigned>(address / (limits_.size / c.banks));
  return (address >> c.page_log2) % c.banks;
}

std::uint32_t ReferenceController::row_of(std::uint32_t address) const {
  const ReferenceConfig& c = config();
  if (c.bank_on_top)
    return static_cast<std::uint32_t>(address % (limits_.size / c.banks)) >> c.page_log2;
  return address >> (c.page_log2 + log2_of(c.banks));
}

unsigned ReferenceController::columns_of(const ReferenceRequest& r) {
  return (r.address + r.bytes - 1) / 16 - r.address / 16 + 1;
}

std::optional<std::uint32_t> ReferenceController::open_row(unsigned bank) const {
  for (auto c = commands.rbegin(); c != commands.rend(); ++c) {
    if (c->kind == Kind::kPreAll || c->kind == Kind::kRef) return std::nullopt;
    if (c->kind >= Kind::kPde) continue;
    if (c->bank != bank) continue;
    if (c->kind == Kind::kPre || c->kind == Kind::kRda || c->kind == Kind::kWra)
      return std::nullopt;
    return c->row;
  }
  return std::nullopt;
}

bool ReferenceController::all_closed() const {
  for (unsigned b = 0; b < 8; ++b)
    if (open_row(b)) return false;
  return true;
}

// ---- what the part allows
/// Clocks that must lie between `before` and a `kind` to this bank.
unsigned ReferenceController::apart(const Given& before, Kind kind, unsigned bank) const {
  const ReferenceConfig& c = configs_[before.config];
  const bool same = before.bank == bank;
  const bool closes = kind == Kind::kPre;
  const unsigned WL = c.mobile ? 1 : c.CL - 1;
  switch (before.kind) {
    case Kind::kAct:
      if (kind == Kind::kAct) return same ? std::max(c.tRC, c.tRRD) : c.tRRD;
      if (!same) return 0;
      return closes ? c.tRAS : kind == Kind::kRd || kind == Kind::kWr ? c.tRCD : 0;
    case Kind::kPre:
      return kind == Kind::kRef || (kind == Kind::kAct && same) ? c.tRP : 0;
    case Kind::kPreAll:
      return kind == Kind::kRef || kind == Kind::kAct ? c.tRP + (c.banks == 8 ? 1 : 0) : 0;
    case Kind::kRd:
    case Kind::kRda:
      if (kind == Kind::kRd) return kBurst;
      if (kind == Kind::kWr) return c.mobile ? c.CL + kBurst : c.CL + kBurst + 1 - WL;
      if (!closes || !same) return 0;
      return c.mobile ? kBurst : kBurst + std::max(c.tRTP, 2u) - 2;
    case Kind::kWr:
    case Kind::kWra:
      if (kind == Kind::kWr) return kBurst;
      if (kind == Kind::kRd) return WL + kBurst + c.tWTR;
      return closes && same ? WL + kBurst + c.tWR : 0;
    case Kind::kRef:
      return kind == Kind::kRef || kind == Kind::kAct ? c.tRFC : 0;
    case Kind::kPdx:
      return c.tXP;
    case Kind::kSrx:
      return kind == Kind::kRd ? std::max(c.tXSRD, c.tXSNR) : c.tXSNR;
    default:
      return 0;
  }
  return 0;
}

std::uint64_t ReferenceController::legal_from(Kind kind, unsigned bank,
                                              std::uint64_t not_before) const {
  if (kind == Kind::kPreAll) {
    std::uint64_t from = not_before;
    for (unsigned b = 0; b < 8; ++b)
      if (open_row(b)) from = std::max(from, legal_from(Kind::kPre, b, not_before));
    return from;
  }
  std::uint64_t from = not_before;
  for (auto c = commands.rbegin(); c != commands.rend(); ++c) {
    if (c->clock + kLongestRule < not_before) break;
    if (const unsigned n = apart(*c, kind, bank)) from = std::max(from, c->clock + n);
    if (c->closes && (kind == Kind::kRef || (kind == Kind::kAct && c->bank == bank)))
      from = std::max(from, c->closes + configs_[c->config].tRP);
  }
  return from;
}

std::uint64_t ReferenceController::clock_after_last() const {
  if (commands.empty()) return not_before_;
  const Given& last = commands.back();
  const bool woke = last.kind == Kind::kPdx || last.kind == Kind::kSrx;
  return std::max(not_before_, last.clock + (woke ? apart(last, Kind::kAct, 0) : 1));
}

// ---- the queue
bool ReferenceController::fits(const ReferenceRequest& r) const {
  if (queue_.size() >= limits_.command_fifo) return false;
  // Each 8 bytes of memory that a write touches are a word of the FIFO.
  const auto words = [](const ReferenceRequest& w) {
    return w.write ? (w.address + w.bytes - 1) / 8 - w.address / 8 + 1 : 0;
  };
  unsigned held = words(r);
  for (const Queued& q : queue_) held += words(q.request);
  return !r.write || held <= limits_.write_fifo / 8;
}

bool ReferenceController::submit(const ReferenceRequest& request, Picoseconds at) {
  const std::uint64_t arrived = std::max(ddr_.edge_after(at), last_arrival_);
  if (queue_.empty()) {
    idle_until(ddr_.edge(arrived - 1));
    wake(arrived);
  }
  if (!fits(request)) {
    input_ = request;
    input_arrived_ = arrived;
    return false;
  }
  enter(request, arrived);
  return true;
}

void ReferenceController::enter(const ReferenceRequest& r, std::uint64_t arrived) {
  last_arrival_ = arrived;
  queue_.push_back({r, arrived + limits_.request_latency});
  if (!r.write && limits_.order == ReferenceLimits::Order::kFrFcfs)
    unanswered_.push_back({r.id, r.master});
}

/// Each master offers its oldest request; a read passes older writes of its master to other
/// 2048-byte blocks that are not more urgent. FR-FCFS: all but those that touch a cache line of 64
/// bytes with an older request of the master, unless both only read.
bool ReferenceController::offered(std::size_t place) const {
  const ReferenceRequest& r = queue_[place].request;
  return std::all_of(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(place),
                     [&](const Queued& q) {
                       const ReferenceRequest& o = q.request;
                       if (o.master != r.master) return true;
                       if (limits_.order == ReferenceLimits::Order::kFrFcfs)
                         return o.address / 64 != r.address / 64 || (!o.write && !r.write);
                       return !r.write && o.write && o.address / 2048 != r.address / 2048 &&
                              r.priority <= o.priority;
                     });
}

ReferenceController::Kind ReferenceController::wanted(const Queued& q) const {
  const auto open = open_row(bank_of(q.request));
  if (!open) return Kind::kAct;
  if (*open != row_of(q.request)) return Kind::kPre;
  return q.request.write ? Kind::kWr : Kind::kRd;
}

// ---- refresh
// From TI's text, not from the model (SPRU986B 2.4.2 and 2.9 on the same controller, SPRUH73 7.3.3.5 on
// its successor):
// - An interval counter adds one to the backlog whenever it expires; each REFR takes one off. A second
//   counter holds the intervals since the last REFR.
// - REFR "is automatically preceded by a DCAB command": the two are one refresh cycle, and once it has
//   begun nothing comes between them, whether requests waited when it began or came later.
// - Levels: may (backlog above 0) refreshes while the controller is not busy; need and must go before
//   what they outrank. After "must" no request is served until the backlog is no longer above the
//   release level. After too many intervals without one, four REFR come before new requests.
ReferenceController::Refresh ReferenceController::refresh_level(std::uint64_t edge) const {
  std::uint64_t more = 0;
  if (config().refresh_interval)
    for (std::uint64_t e = expiry_; e <= edge; e += config().refresh_interval) ++more;
  const bool begun = cycle_begun_ || series_ != 0 || far_behind_;
  if (begun || backlog_ + more > limits_.must || since_refresh_ + more > limits_.gap)
    return Refresh::kMust;
  return backlog_ + more > limits_.need ? Refresh::kNeed : Refresh::kMay;
}

void ReferenceController::expire(std::uint64_t clock) {
  if (!config().refresh_interval) return;
  for (; expiry_ <= clock; expiry_ += config().refresh_interval) ++backlog_, ++since_refresh_;
  if (backlog_ > limits_.must) far_behind_ = true;
}

/// The next command of a refresh cycle: its DCAB unless all banks are closed, else its REFR.
void ReferenceController::refresh_cycle(Kind kind, std::uint64_t clock) {
  give(kind, 0, 0, clock);
  cycle_begun_ = kind == Kind::kPreAll;
  if (cycle_begun_) return;
  since_refresh_ = 0;
  if (backlog_ != 0) --backlog_;
  if (series_ != 0) --series_;
  if (backlog_ <= limits_.release) far_behind_ = false;
}

/// From when on the part takes commands of this kind after its last sleep.
std::uint64_t ReferenceController::awake_from(Kind kind, std::uint64_t clock) const {
  for (auto c = commands.rbegin(); c != commands.rend(); ++c) {
    if (c->kind == Kind::kPdx || c->kind == Kind::kSrx) return c->clock + apart(*c, kind, 0);
    if (c->clock + kLongestRule < clock) break;
  }
  return 0;
}

/// The data of the last bursts is over and CKE has been high for long enough.
bool ReferenceController::may_sleep(std::uint64_t clock) const {
  for (auto c = commands.rbegin(); c != commands.rend(); ++c) {
    if (c->clock + kLongestRule < clock) break;
    const ReferenceConfig& then = configs_[c->config];
    const unsigned WL = then.mobile ? 1 : then.CL - 1;
    unsigned n = 0;
    if (c->kind == Kind::kRd || c->kind == Kind::kRda) n = then.CL + kBurst + 1;
    if (c->kind == Kind::kWr || c->kind == Kind::kWra) n = WL + kBurst + then.tWTR;
    if (c->kind == Kind::kPdx || c->kind == Kind::kSrx)
      n = std::max(then.tCKE, apart(*c, Kind::kRd, 0));
    if (c->clock + n > clock) return false;
  }
  return true;
}

void ReferenceController::wake(std::uint64_t clock) {
  using Sleep = ReferenceConfig::Sleep;
  if (asleep_ == Sleep::kNever) return;
  if (asleep_ == Sleep::kClockStop) clock += limits_.clock_restart;
  clock = std::max(clock, commands.back().clock + configs_[commands.back().config].tCKE);
  clock = std::max(clock, clock_runs_from_);
  clock_runs_from_ = 0;
  give(asleep_ == Sleep::kPowerDown ? Kind::kPdx : Kind::kSrx, 0, 0, clock);
  if (asleep_ != Sleep::kPowerDown) {  // it refreshed itself until now
    if (ddr_.edge(clock) - asleep_at_ > limits_.retention)
      losses_.push_back(config().refreshed_log2);
    backlog_ = since_refresh_ = 0;
    cycle_begun_ = config().mobile;  // SPRUH82C 14.2.8: mDDR gets a REF before anything else
    expiry_ = clock + config().refresh_interval;
  }
  asleep_ = Sleep::kNever;
}

/// What an idle controller does in one clock: a step of a refresh cycle, or sleep.
void ReferenceController::idle_at(std::uint64_t clock) {
  using Sleep = ReferenceConfig::Sleep;
  const bool refreshes = config().refresh_interval != 0;
  if (asleep_ == Sleep::kSelfRefresh || asleep_ == Sleep::kClockStop) return;
  if (asleep_ == Sleep::kPowerDown) {
    const Given& entry = commands.back();
    if (refreshes && expiry_ <= clock && entry.clock + configs_[entry.config].tCKE <= clock)
      wake(clock);
    return;
  }
  expire(clock);
  if (clock < awake_from(Kind::kRef, clock)) return;
  const Sleep sleep = config().sleep;
  const bool self_refresh = sleep == Sleep::kSelfRefresh || sleep == Sleep::kClockStop;
  if (cycle_begun_ || backlog_ != 0) {
    if (!refreshes && !cycle_begun_) return;
    const Kind kind = all_closed() ? Kind::kRef : Kind::kPreAll;
    if (legal_from(kind, 0, clock) == clock) refresh_cycle(kind, clock);
    return;
  }
  if (self_refresh && !all_closed()) {  // the part must have its banks closed; a request may still come
    if (legal_from(Kind::kPreAll, 0, clock) == clock) give(Kind::kPreAll, 0, 0, clock);
    return;
  }
  if (self_refresh && legal_from(Kind::kRef, 0, clock) != clock) return;
  if (sleep == Sleep::kNever || !may_sleep(clock)) return;
  give(sleep == Sleep::kPowerDown ? Kind::kPde : Kind::kSre, 0, 0, clock);
  if (sleep == Sleep::kClockStop) clock_changes_.emplace_back(true, clock);
  asleep_ = sleep;
  asleep_at_ = ddr_.edge(clock);
}

void ReferenceController::idle_until(Picoseconds at) {
  if (queue_.empty()) idle_while_empty(ddr_.edge_after(at));
}
void ReferenceController::idle_while_empty(std::uint64_t end) {
  // Clocks in which nothing can fall due are passed over.
  std::uint64_t clock = clock_after_last();
  const bool calm = config().sleep == ReferenceConfig::Sleep::kNever && backlog_ == 0;
  if (calm && !config().refresh_interval) return;
  if (calm) clock = std::max(clock, expiry_);
  for (; clock < end; ++clock) idle_at(clock);
}

// ---- scheduling
Picoseconds ReferenceController::next() const {
  return queue_.empty() ? kNever : ddr_.edge(plan().clock);
}

ReferenceController::Plan ReferenceController::plan() const {
  if (cycle_begun_) return refresh_at(clock_after_last());
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const Queued& q = queue_[i];
    if (q.columns_given == 0) continue;
    // Nothing comes between the columns of a request.
    const Kind kind = q.request.write ? Kind::kWr : Kind::kRd;
    return {kind, legal_from(kind, bank_of(q.request), clock_after_last()), i};
  }
  // The decision of an edge stands if its command can be given before anything else wants a say.
  std::uint64_t edge = std::max(clock_after_last(), queue_.front().ready);
  for (;;) {
    const Plan p = plan_at(edge);
    std::uint64_t wake = ~std::uint64_t{0};
    for (const Queued& q : queue_)
      if (q.ready > edge) wake = std::min(wake, q.ready);
    if (read_room_ > edge) wake = std::min(wake, read_room_);
    for (unsigned bank = 0; bank < 8; ++bank)
      if (const std::uint64_t due = due_at(bank); due > edge) wake = std::min(wake, due);
    if (p.clock < wake) return p;
    edge = wake;
  }
}

ReferenceController::Plan ReferenceController::refresh_at(std::uint64_t edge) const {
  const Kind kind = all_closed() ? Kind::kRef : Kind::kPreAll;
  return {kind, legal_from(kind, 0, edge), std::nullopt};
}

/// When the bank's open row has been open for its number of intervals; ~0: never.
std::uint64_t ReferenceController::due_at(unsigned bank) const {
  if (config().refresh_interval == 0 || !open_row(bank)) return ~std::uint64_t{0};
  auto act = commands.rbegin();
  while (act->kind != Kind::kAct || act->bank != bank) ++act;
  return act->clock + std::uint64_t{config().row_intervals} * config().refresh_interval;
}

/// Rows that are due are closed, the oldest first.
std::optional<ReferenceController::Plan> ReferenceController::overdue_at(std::uint64_t edge) const {
  std::optional<Plan> plan;
  std::uint64_t oldest = ~std::uint64_t{0};
  for (unsigned bank = 0; bank < 8; ++bank) {
    const std::uint64_t due = due_at(bank);
    if (due > edge || due >= oldest) continue;
    oldest = due;
    plan = Plan{Kind::kPre, legal_from(Kind::kPre, bank, edge), std::nullopt, bank};
  }
  return plan;
}

ReferenceController::Plan ReferenceController::plan_at(std::uint64_t edge) const {
  const Refresh level = refresh_level(edge);
  if (level == Refresh::kMust) return refresh_at(edge);

  using Order = ReferenceLimits::Order;
  const bool in_order = limits_.order == Order::kFcfs, plain = limits_.order == Order::kFrFcfs;
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < queue_.size(); ++i)
    if (queue_[i].ready <= edge && (in_order || offered(i))) list.push_back(i);
  const bool raise = config().old_count != 0xFF && passed_ > config().old_count;
  // FR-FCFS: what can have its column first; with TI's rules that is a question of the setting.
  const auto column_from = [&](const ReferenceRequest& r) -> std::uint64_t {
    if (!plain && !limits_.ready_rows_first) return 0;
    const std::uint64_t from = legal_from(r.write ? Kind::kWr : Kind::kRd, bank_of(r), edge);
    return r.write ? from : std::max(from, read_room_);
  };
  const auto order = [&](std::size_t i) {
    const ReferenceRequest& r = queue_[i].request;
    const bool reads_wait = read_room_ > edge;
    const int kind = !r.write && reads_wait ? 2 : r.write && !plain ? 1 : 0;
    const bool open = open_row(bank_of(r)) == row_of(r);
    return std::make_tuple(!(raise && i == 0), kind, !open, open ? column_from(r) : 0,
                           plain ? 0 : r.priority, i);
  };
  if (!in_order)
    std::sort(list.begin(), list.end(),
              [&](std::size_t a, std::size_t b) { return order(a) < order(b); });

  if (level == Refresh::kNeed) {
    // Before writes, and before a read if the write that would come first is more urgent.
    std::optional<std::size_t> read, write;
    for (const std::size_t i : in_order ? std::vector<std::size_t>{0} : list) {
      auto& first = queue_[i].request.write ? write : read;
      const auto natural = [&](std::size_t k) {
        const ReferenceRequest& r = queue_[k].request;
        return std::make_tuple(open_row(bank_of(r)) != row_of(r), r.priority, k);
      };
      if (!first || natural(i) < natural(*first)) first = i;
    }
    if (!read || (write && queue_[*write].request.priority < queue_[*read].request.priority))
      return refresh_at(edge);
  }

  if (const auto overdue = overdue_at(edge)) return *overdue;

  // The first gets what it wants; the others may prepare a bank that no request before them needs.
  std::optional<Plan> best;
  std::vector<unsigned> taken;
  for (const std::size_t i : list) {
    const unsigned bank = bank_of(queue_[i].request);
    if (std::find(taken.begin(), taken.end(), bank) != taken.end()) continue;
    taken.push_back(bank);
    const Kind kind = wanted(queue_[i]);
    if (best && (kind == Kind::kRd || kind == Kind::kWr)) continue;
    std::uint64_t clock = legal_from(kind, bank, edge);
    if (kind == Kind::kRd) clock = std::max(clock, read_room_);
    if (!best || clock < best->clock) best = Plan{kind, clock, i};
  }
  return *best;
}

void ReferenceController::give(Kind kind, unsigned bank, std::uint32_t row, std::uint64_t clock) {
  commands.push_back({kind, bank, row, clock, configs_.size() - 1});
}

void ReferenceController::step() {
  const Plan p = plan();
  expire(p.clock);
  if (!p.of && p.kind == Kind::kPre) return give(p.kind, p.bank, 0, p.clock);
  if (!p.of) {
    if (since_refresh_ > limits_.gap && series_ == 0) series_ = 4;
    return refresh_cycle(p.kind, p.clock);
  }
  Queued& q = queue_[*p.of];
  const ReferenceRequest r = q.request;
  if (!q.classified) {
    q.classified = true;
    ++(p.kind == Kind::kAct ? misses : p.kind == Kind::kPre ? conflicts : hits);
  }
  Kind kind = p.kind;
  const bool column = kind == Kind::kRd || kind == Kind::kWr;
  if (column && q.columns_given + 1 == columns_of(r) &&
      limits_.order == ReferenceLimits::Order::kClosedPage) {
    // The row closes unless another request in the queue wants it.
    bool wanted = false;
    for (const Queued& o : queue_)
      wanted = wanted ||
               (&o != &q && bank_of(o.request) == bank_of(r) && row_of(o.request) == row_of(r));
    if (!wanted) kind = kind == Kind::kRd ? Kind::kRda : Kind::kWra;
  }
  give(kind, bank_of(r), row_of(r), p.clock);
  if (kind == Kind::kRda || kind == Kind::kWra)
    commands.back().closes = legal_from(Kind::kPre, bank_of(r), p.clock);
  if (p.kind == Kind::kAct || p.kind == Kind::kPre) return;
  if (q.columns_given++ == 0 && !r.write) answer(r, p.clock);
  if (q.columns_given == columns_of(r)) leave(*p.of, p.clock);
}

void ReferenceController::leave(std::size_t place, std::uint64_t clock) {
  passed_ = place == 0 ? 0 : passed_ + columns_of(queue_[place].request);
  const unsigned leaving = queue_[place].request.master;
  queue_.erase(queue_.begin() + static_cast<std::ptrdiff_t>(place));
  if (input_ && fits(*input_)) {
    enter(*input_, std::max(input_arrived_, clock + 1));
    accepted.push_back({input_->id, ddr_.edge(clock), leaving});
    input_.reset();
  }
  // Until the first of the queue arrives there is no request.
  if (queue_.empty()) return;
  const std::uint64_t arrival = queue_.front().ready - limits_.request_latency;
  if (arrival <= clock + 1) return;
  idle_while_empty(arrival);
  wake(arrival);
}

/// The way of a read's data: PHY, read FIFO, and a return channel of 8 bytes a crossbar clock.
void ReferenceController::answer(const ReferenceRequest& r, std::uint64_t clock) {
  const std::uint64_t latency =
      std::max(config().read_latency, config().CL) + limits_.return_latency;
  const std::uint64_t head = latency + kBurst / 2;  // 8 bytes are 4 beats
  const std::uint64_t words = (r.bytes + 7) / 8;
  const std::uint64_t here = scr_.edge_after(ddr_.edge(clock + head));
  const std::uint64_t all_here =
      scr_.edge_after(ddr_.edge(clock + latency + columns_of(r) * kBurst));
  const std::uint64_t start = std::max(here, channel_free_);
  std::uint64_t end = start;
  if (words > 1 || columns_of(r) > 1) end = std::max(start + words - 1, all_here);
  channel_free_ = end + 1;
  // With more than this many words before the channel, 64 bytes of another read find no room.
  const std::uint64_t held = limits_.read_fifo / 8 - 8;
  if (channel_free_ > channel_start_ + held && channel_free_ - held >= here) {
    const std::uint64_t room = ddr_.edge_at_or_after(scr_.edge(channel_free_ - held));
    read_room_ = room > head ? room - head : 0;
  }
  if (limits_.order == ReferenceLimits::Order::kFrFcfs)
    hand_out(r, start, end);
  else
    reads.push_back({r.id, scr_.edge(start), scr_.edge(end)});
}

/// Each master gets its reads in the order in which they arrived, one after the other and never
/// before their data are there.
void ReferenceController::hand_out(const ReferenceRequest& r, std::uint64_t start,
                                   std::uint64_t end) {
  handed_out_until_.resize(std::max<std::size_t>(handed_out_until_.size(), r.master + 1));
  for (Unanswered& o : unanswered_) {
    if (o.id != r.id) continue;
    o.has_data = true;
    o.first = scr_.edge(start);
    o.edges = end - start;
  }
  Picoseconds& until = handed_out_until_[r.master];
  for (auto o = unanswered_.begin(); o != unanswered_.end();) {
    if (o->master != r.master) {
      ++o;
      continue;
    }
    if (!o->has_data) return;
    const Picoseconds first = std::max(o->first, scr_.next_edge_after(until));
    until = scr_.edge(scr_.edge_at_or_after(first) + o->edges);
    reads.push_back({o->id, first, until});
    o = unanswered_.erase(o);
  }
}

}  // namespace fovea::dram
