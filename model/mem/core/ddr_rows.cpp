// Rows that are open for too long (T_RASMAX), and data lost in partial self-refresh.
#include <cstring>

#include "model/common/check.h"
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {
namespace {

/// What a cell that lost its charge reads as: any value that is not mistaken for data.
constexpr int kLostByte = 0xA5;

}  // namespace

/// T_RASMAX counts refresh intervals, so a row that opens now is due after the present interval's
/// end: looking at the open rows when an interval ends is early enough.
std::uint64_t DdrController::first_overdue() const {
  std::uint64_t first = kNoClock;
  if (config_.refresh_interval == 0) return first;
  for (unsigned b = 0; b < DdrDevice::kMaxBanks; ++b)
    if (device_.row(b) != DdrDevice::kClosed)
      first = std::min(first, device_.opened(b) +
                                  std::uint64_t{config_.row_intervals} * config_.refresh_interval);
  return first;
}

/// The row that is due first goes before all requests; refresh, which closes all rows, before it.
bool DdrController::choose_overdue_row(std::uint64_t edge) {
  if (first_overdue() > edge) return false;
  unsigned bank = 0;
  std::uint64_t opened = kNoClock;
  for (unsigned b = 0; b < DdrDevice::kMaxBanks; ++b) {
    if (device_.row(b) == DdrDevice::kClosed || device_.opened(b) >= opened) continue;
    opened = device_.opened(b);
    bank = b;
  }
  choice_ = {nullptr, std::max(edge, device_.earliest(Cmd::kPre, bank)), Cmd::kPre, 0,
             static_cast<std::uint8_t>(bank)};
  return true;
}

void DdrController::close_overdue_row(std::uint64_t clock) {
  device_.issue<Cmd::kPre>(choice_.bank, 0, clock);
  hits_ &= ~queue_.of_bank(choice_.bank);
  ++stats.overdue_rows;
  command_free_ = clock + 1;
  IssuedCommand& g = attribution_.add(clock, next_);
  g.cause = WaitAttribution::kRefreshed;
  g.before = 0;
  g.cmd = Cmd::kPreAll;  // whoever waits for it waits for the upkeep of the part, as for refresh
  if (hook_) hook_(hook_self_, Cmd::kPre, choice_.bank, 0, clock);
  urgency_changed();
}

/// Another way of sleeping. Between self-refresh with and without the memory's clock the part sleeps
/// on; all else wakes it.
void DdrController::sleep_changes(LowPower to, std::uint64_t clock) {
  if (!refreshes_itself(asleep_) || !refreshes_itself(to)) return wake(clock);
  count_asleep(clock);
  if (asleep_ == LowPower::kClockStop) cke_free_ = std::max(cke_free_, clock + clock_restart_);
  asleep_ = to;
}

/// The part was in self-refresh for this long and kept the banks, or of bank 0 the rows, with low
/// addresses.
void DdrController::lose_unrefreshed(Picoseconds slept) {
  if (config_.refreshed_log2 == 0 || slept <= retention_) return;
  const std::uint64_t page = std::uint64_t{1} << config_.page_log2;
  const unsigned banks = config_.timing.banks;
  const std::uint64_t rows = size_ / page / banks;
  const unsigned of_banks = std::min(config_.refreshed_log2, 2u);  // 4, 2, 1; then parts of one
  const unsigned kept_banks = std::max(banks >> of_banks, 1u);
  const std::uint64_t kept_rows = rows >> (config_.refreshed_log2 - of_banks);
  for (unsigned b = 0; b < banks; ++b)
    for (std::uint64_t r = b < kept_banks ? kept_rows : 0; r < rows; ++r)
      std::memset(store_.at(config_.bank_on_top ? (b * rows + r) * page : (r * banks + b) * page),
                  kLostByte, page);
  Diagnostics::instance().guest(
      "self-refresh of a part of the SDRAM (SDBCR2.PASR) was so long that the rest lost its data");
}

}  // namespace fovea::mem
