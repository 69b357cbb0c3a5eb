// A checker of the SDRAM's command bus that shares nothing with the model: its rules are the
// relations of JESD79-2 and JESD209 (BL8, AL 0), checked backwards from each command to those before
// it. It knows the device only by its command stream.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "model/mem/check/data_sheet.h"

namespace fovea::mem::check {

/// kRda, kWra: with auto-precharge. The last four: power-down and self-refresh, entry and exit.
enum class Command : std::uint8_t {
  kAct,
  kPre,
  kPreAll,
  kRd,
  kWr,
  kRef,
  kRda,
  kWra,
  kPde,
  kPdx,
  kSre,
  kSrx
};

struct Complaint {
  std::string rule;         ///< "tRCD", ...
  std::uint64_t clock = 0;  ///< of the offending command
  unsigned bank = 0;
  /// Clocks too early (tREFI, tRASmax: too late; "postponed REF": how many too many); 0: a state rule
  std::uint64_t missing = 0;
};

class CommandChecker {
 public:
  explicit CommandChecker(const DataSheet& sheet) : sheet_(sheet), banks_(sheet.banks) {}

  void command(Command c, unsigned bank, std::uint32_t row, std::uint64_t clock);
  /// End of the stream: refreshes owed by then are late too.
  void finish(std::uint64_t clock) {
    check_refresh_gap(clock);
    check_postponed(clock);
  }
  /// Other numbers from `clock` on (registers written, another clock): what was given before puts
  /// nothing off any more, except that rows stay open and the part asleep.
  void change(const DataSheet& sheet, std::uint64_t clock);
  /// The interval counter restarted here (SDRCR written): gaps count from this clock.
  void refresh_counts_from(std::uint64_t clock) { last_ref_ = counted_to_ = clock; }

  /// The first complaints, at most 100; `total` counts all.
  const std::vector<Complaint>& complaints() const { return complaints_; }
  std::uint64_t total() const { return total_; }
  std::uint64_t commands() const { return commands_; }
  /// Largest distance of two REF seen, clocks.
  std::uint64_t largest_refresh_gap() const { return largest_gap_; }
  std::string text() const;
  /// Called with each complaint, beyond the first hundred too.
  std::function<void(const Complaint&)> on_complaint;

 private:
  static constexpr std::int64_t kLongAgo = -1'000'000;
  struct Bank {
    bool open = false;
    std::uint32_t row = 0;
    std::int64_t opened = 0, act = kLongAgo, pre = kLongAgo, rd = kLongAgo, wr = kLongAgo;
  };
  void complain(const char* rule, std::uint64_t clock, unsigned bank, std::int64_t missing);
  /// Complains unless `now` is at least `clocks` after `before`.
  void apart(const char* rule, std::int64_t before, std::int64_t now, unsigned clocks,
             unsigned bank);
  void activate(unsigned b, std::uint32_t row, std::int64_t now);
  void precharge(unsigned b, std::int64_t now);
  void column(bool write, unsigned b, std::uint32_t row, std::int64_t now);
  void close_by_itself(unsigned b);
  void sleep(bool self_refresh, std::int64_t now);
  void wake(bool self_refresh, std::int64_t now);
  void refresh(std::int64_t now);
  void check_refresh_gap(std::uint64_t clock);
  void check_postponed(std::uint64_t clock);
  void check_open_time(unsigned b, std::int64_t closed);
  unsigned WL() const { return sheet_.mobile ? 1 : sheet_.CL - 1; }

  DataSheet sheet_;
  std::vector<Bank> banks_;
  std::array<std::int64_t, 4> acts_{kLongAgo, kLongAgo, kLongAgo, kLongAgo};  // newest first
  std::int64_t rd_ = kLongAgo, wr_ = kLongAgo, ref_ = kLongAgo, pre_ = kLongAgo, prea_ = kLongAgo,
               previous_ = kLongAgo, cke_ = kLongAgo, pdx_ = kLongAgo, srx_ = kLongAgo;
  bool slept_ = false;  // no REF has come since the last self-refresh
  enum class Cke { kHigh, kPowerDown, kSelfRefresh } state_ = Cke::kHigh;
  std::uint64_t last_ref_ = 0, largest_gap_ = 0;
  std::uint64_t owed_ = 0, counted_to_ = 0;  // refreshes, by intervals that ended up to this clock
  std::vector<Complaint> complaints_;
  std::uint64_t total_ = 0, commands_ = 0;
};

}  // namespace fovea::mem::check
