#include "model/mem/check/command_checker.h"

#include <algorithm>

namespace fovea::mem::check {

void CommandChecker::complain(const char* rule, std::uint64_t clock, unsigned bank,
                              std::int64_t missing) {
  ++total_;
  if (on_complaint) on_complaint({rule, clock, bank, static_cast<std::uint64_t>(missing)});
  if (complaints_.size() < 100)
    complaints_.push_back({rule, clock, bank, static_cast<std::uint64_t>(missing)});
}

void CommandChecker::apart(const char* rule, std::int64_t before, std::int64_t now, unsigned clocks,
                           unsigned bank) {
  const std::int64_t legal = before + static_cast<std::int64_t>(clocks);
  if (now < legal) complain(rule, static_cast<std::uint64_t>(now), bank, legal - now);
}

void CommandChecker::change(const DataSheet& sheet, std::uint64_t clock) {
  sheet_ = sheet;
  banks_.resize(std::max<std::size_t>(banks_.size(), sheet.banks));
  for (Bank& b : banks_) b.act = b.pre = b.rd = b.wr = kLongAgo;
  acts_.fill(kLongAgo);
  rd_ = wr_ = ref_ = pre_ = prea_ = cke_ = pdx_ = srx_ = kLongAgo;
  last_ref_ = counted_to_ = clock;
  owed_ = 0;
}

void CommandChecker::command(Command c, unsigned bank, std::uint32_t row, std::uint64_t clock) {
  ++commands_;
  const auto now = static_cast<std::int64_t>(clock);
  if (now <= previous_) complain("one command a clock", clock, bank, previous_ + 1 - now);
  previous_ = now;
  const bool exits = c == Command::kPdx || c == Command::kSrx;
  if (state_ != Cke::kHigh && !exits) complain("command while CKE is low", clock, bank, 0);
  if (exits) return wake(c == Command::kSrx, now);
  if (c == Command::kPde || c == Command::kSre) return sleep(c == Command::kSre, now);
  apart("tXP", pdx_, now, sheet_.tXP, bank);
  apart("tXSNR", srx_, now, sheet_.tXSNR, bank);
  if (slept_ && sheet_.refresh_after_sleep && c != Command::kRef) complain("REF after self-refresh", clock, bank, 0);
  const bool whole_rank = c == Command::kPreAll || c == Command::kRef;
  if (!whole_rank && bank >= sheet_.banks) {
    complain("no such bank", clock, bank, 0);
    return;
  }
  // The device answers to nothing while it refreshes.
  apart("tRFC", ref_, now, sheet_.tRFC, bank);
  switch (c) {
    case Command::kAct:
      activate(bank, row, now);
      break;
    case Command::kRd:
      column(false, bank, row, now);
      break;
    case Command::kWr:
      column(true, bank, row, now);
      break;
    case Command::kRda:
      column(false, bank, row, now);
      close_by_itself(bank);
      break;
    case Command::kWra:
      column(true, bank, row, now);
      close_by_itself(bank);
      break;
    case Command::kRef:
      refresh(now);
      break;
    default:  // CKE: above
      break;
    case Command::kPre:
      if (!banks_[bank].open) complain("PRE on closed bank", clock, bank, 0);
      precharge(bank, now);
      banks_[bank].pre = now;
      pre_ = std::max(pre_, now);
      break;
    case Command::kPreAll:
      for (unsigned b = 0; b < sheet_.banks; ++b)
        if (banks_[b].open) precharge(b, now);
      prea_ = now;
      break;
  }
}

void CommandChecker::activate(unsigned b, std::uint32_t row, std::int64_t now) {
  Bank& k = banks_[b];
  if (k.open) complain("ACT on open bank", static_cast<std::uint64_t>(now), b, 0);
  apart("tRC", k.act, now, sheet_.tRC, b);
  apart("tRP", k.pre, now, sheet_.tRP, b);
  // Precharging all of eight banks takes a clock more.
  apart("tRPA", prea_, now, sheet_.tRP + (sheet_.banks == 8 ? 1 : 0), b);
  apart("tRRD", acts_[0], now, sheet_.tRRD, b);
  if (sheet_.tFAW) apart("tFAW", acts_[3], now, sheet_.tFAW, b);
  std::rotate(acts_.begin(), acts_.end() - 1, acts_.end());
  acts_[0] = now;
  k.open = true;
  k.row = row;
  k.act = k.opened = now;
}

void CommandChecker::precharge(unsigned b, std::int64_t now) {
  Bank& k = banks_[b];
  apart("tRAS", k.act, now, sheet_.tRAS, b);
  apart("tRTP", k.rd, now, sheet_.mobile ? 4 : 4 + std::max(sheet_.tRTP, 2u) - 2, b);
  apart("tWR", k.wr, now, WL() + 4 + sheet_.tWR, b);
  check_open_time(b, now);
  k.open = false;
}

void CommandChecker::check_open_time(unsigned b, std::int64_t closed) {
  const auto limit = static_cast<std::int64_t>(sheet_.tRASmax);
  const std::int64_t open = closed - banks_[b].opened;
  if (limit && banks_[b].open && open > limit)
    complain("tRASmax", static_cast<std::uint64_t>(closed), b, open - limit);
}

void CommandChecker::column(bool write, unsigned b, std::uint32_t row, std::int64_t now) {
  Bank& k = banks_[b];
  const auto clock = static_cast<std::uint64_t>(now);
  if (!k.open)
    complain(write ? "WR on closed bank" : "RD on closed bank", clock, b, 0);
  else if (k.row != row)
    complain(write ? "WR on wrong row" : "RD on wrong row", clock, b, 0);
  apart("tRCD", k.act, now, sheet_.tRCD, b);
  if (write) {
    apart("WR to WR", wr_, now, 4, b);
    apart("RD to WR", rd_, now, sheet_.mobile ? sheet_.CL + 4 : sheet_.CL + 4 + 1 - WL(), b);
    k.wr = wr_ = now;
  } else {
    apart("RD to RD", rd_, now, 4, b);
    apart("tXSRD", srx_, now, sheet_.tXSRD, b);
    apart("tWTR", wr_, now, WL() + 4 + sheet_.tWTR, b);
    k.rd = rd_ = now;
  }
}

/// The part precharges as soon as tRAS, tRTP and tWR allow it.
void CommandChecker::close_by_itself(unsigned b) {
  Bank& k = banks_[b];
  const std::int64_t after_read = k.rd + (sheet_.mobile ? 4 : 4 + std::max(sheet_.tRTP, 2u) - 2);
  k.pre = std::max({k.act + sheet_.tRAS, after_read, k.wr + WL() + 4 + sheet_.tWR});
  pre_ = std::max(pre_, k.pre);
  check_open_time(b, k.pre);
  k.open = false;
}

void CommandChecker::sleep(bool self_refresh, std::int64_t now) {
  apart("tCKE", cke_, now, sheet_.tCKE, 0);
  apart("RD to CKE low", rd_, now, sheet_.CL + 4 + 1, 0);
  apart("WR to CKE low", wr_, now, WL() + 4 + sheet_.tWTR, 0);
  if (self_refresh) {
    for (unsigned b = 0; b < sheet_.banks; ++b)
      if (banks_[b].open)
        complain("self-refresh with open bank", static_cast<std::uint64_t>(now), b, 0);
    if (slept_ && sheet_.refresh_before_sleep)
      complain("REF between self-refreshes", static_cast<std::uint64_t>(now), 0, 0);
    apart("tRP", pre_, now, sheet_.tRP, 0);
    apart("tRPA", prea_, now, sheet_.tRP + (sheet_.banks == 8 ? 1 : 0), 0);
    apart("tRFC", ref_, now, sheet_.tRFC, 0);
    check_refresh_gap(static_cast<std::uint64_t>(now));
  }
  state_ = self_refresh ? Cke::kSelfRefresh : Cke::kPowerDown;
  cke_ = now;
}

void CommandChecker::wake(bool self_refresh, std::int64_t now) {
  if (state_ != (self_refresh ? Cke::kSelfRefresh : Cke::kPowerDown))
    complain("exit without entry", static_cast<std::uint64_t>(now), 0, 0);
  apart("tCKE", cke_, now, sheet_.tCKE, 0);
  if (self_refresh) apart("tRFC in self-refresh", cke_, now, sheet_.tSR, 0);
  (self_refresh ? srx_ : pdx_) = cke_ = now;
  if (self_refresh) {  // it refreshed itself
    last_ref_ = counted_to_ = static_cast<std::uint64_t>(now);
    owed_ = 0;
    slept_ = true;
  }
  state_ = Cke::kHigh;
}

void CommandChecker::refresh(std::int64_t now) {
  const auto clock = static_cast<std::uint64_t>(now);
  for (unsigned b = 0; b < sheet_.banks; ++b)
    if (banks_[b].open) complain("REF with open bank", clock, b, 0);
  apart("tRP", pre_, now, sheet_.tRP, 0);
  apart("tRPA", prea_, now, sheet_.tRP + (sheet_.banks == 8 ? 1 : 0), 0);
  check_refresh_gap(clock);
  check_postponed(clock);
  if (owed_ != 0) --owed_;
  last_ref_ = clock;
  ref_ = now;
  slept_ = false;
}

/// At a REF: every interval that ended owes one. A part in self-refresh owes none.
void CommandChecker::check_postponed(std::uint64_t clock) {
  if (sheet_.tREFI == 0 || !sheet_.counts_postponed || state_ == Cke::kSelfRefresh) return;
  const std::uint64_t ended = (clock - counted_to_) / sheet_.tREFI;
  owed_ += ended;
  counted_to_ += ended * sheet_.tREFI;
  if (owed_ > sheet_.postponed_max)
    complain("postponed REF", clock, 0, static_cast<std::int64_t>(owed_ - sheet_.postponed_max));
}

void CommandChecker::check_refresh_gap(std::uint64_t clock) {
  if (sheet_.tREFI == 0) return;
  const std::uint64_t gap = clock - last_ref_;
  largest_gap_ = std::max(largest_gap_, gap);
  const std::uint64_t allowed = std::uint64_t{sheet_.postponed_max + 1} * sheet_.tREFI;
  if (gap > allowed) complain("tREFI", clock, 0, static_cast<std::int64_t>(gap - allowed));
}

std::string CommandChecker::text() const {
  std::string out;
  for (std::size_t i = 0; i < complaints_.size() && i < 10; ++i) {
    const Complaint& c = complaints_[i];
    out += c.rule + " at clock " + std::to_string(c.clock) + ", bank " + std::to_string(c.bank) +
           ", off by " + std::to_string(c.missing) + "\n";
  }
  return out + std::to_string(total_) + " complaints in " + std::to_string(commands_) +
         " commands\n";
}

}  // namespace fovea::mem::check
