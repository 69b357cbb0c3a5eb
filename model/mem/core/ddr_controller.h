// TI's DDR2/mDDR controller (the family's scheduler) as a passive state machine: it is advanced to
// a time by whoever is entitled to, and never runs ahead of what may still arrive.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "model/common/clock.h"
#include "model/common/masters.h"
#include "model/common/mem_request.h"
#include "model/common/waits.h"
#include "model/mem/core/backing_store.h"
#include "model/mem/core/ddr_params.h"
#include "model/mem/core/ddr_stats.h"
#include "model/mem/core/ddr_timing.h"
#include "model/mem/core/queue_positions.h"
#include "model/mem/core/return_channel.h"
#include "model/mem/core/scheduler/policy.h"
#include "model/mem/core/wait_attribution.h"

namespace fovea::mem {

/// What an idle controller does with the part (SDRCR.LPMODEN, SR_PD and MCLKSTOPEN). kClockStop:
/// self-refresh, and the memory's clock stands.
enum class LowPower : std::uint8_t { kOff, kSelfRefresh, kPowerDown, kClockStop };
constexpr bool refreshes_itself(LowPower p) {
  return p == LowPower::kSelfRefresh || p == LowPower::kClockStop;
}

/// What the registers say (SDBCR, SDBCR2, SDTIMR, SDTIMR2, SDRCR, PBBPR, DDRPHYCR), decoded.
struct DdrConfig {
  DdrTiming timing;
  unsigned read_latency = 5;         ///< DDRPHYCR.RL, clocks; CL is the floor
  unsigned refresh_interval = 1895;  ///< SDRCR.RR, clocks; 0: no refresh
  unsigned old_count = 0xFF;         ///< PBBPR.PR_OLD_COUNT; 0xFF: never
  unsigned page_log2 = 11;           ///< bytes of a row on the 16-bit bus
  bool bank_on_top = false;          ///< SDBCR.IBANK_POS: row stays in its bank
  LowPower low_power = LowPower::kOff;
  unsigned row_intervals = 16;  ///< SDTIMR2.T_RASMAX + 1: refresh intervals that a row may be open
  /// SDBCR2.PASR of a mobile part: self-refresh keeps the first 1/2^n of the array.
  unsigned refreshed_log2 = 0;
};

class DdrController {
 public:
  DdrController(const DdrParams& params, BackingStore& store);
  DdrController(const DdrController&) = delete;
  DdrController& operator=(const DdrController&) = delete;

  void set_clocks(Frequency ddr, Frequency scr, Picoseconds at);
  /// Reads have no crossbar to go to: their data are there when the SDRAM has sent them.
  void leave_out_return_channel() { return_channel_.leave_out(); }
  /// New timing from the registers; takes effect for commands after the call's time.
  void configure(const DdrConfig& config, Picoseconds at);
  bool running() const { return running_; }

  /// Catches up to `at` what needs no decision: refreshes and sleep while nothing is queued, and
  /// the columns inside a burst. They change nothing that a master can see before the next decision
  /// or request; whoever reads the statistics calls this first.
  void catch_up(Picoseconds at);

  /// A request for the SDRAM, at byte `offset` in it, arrives at time `at`. The write data are copied
  /// when the request is accepted; the request itself stays valid until its outcome. True: accepted at
  /// once. False: it waits in the input register, and is among accepted() of a later step; the caller
  /// sends no other one before.
  bool submit(MemRequest& request, std::uint32_t offset, Picoseconds at);
  /// The same for a caller that knows that it may: the request inside the SDRAM, input_blocked() false.
  bool submit_inside(MemRequest& request, std::uint32_t offset, Picoseconds at);
  /// The clock is stopped, or a request waits in the input register: no request may be submitted.
  bool input_blocked() const { return input_blocked_; }

  /// Time of the next decision, kNever if nothing is queued: a DRAM command, but of a burst's
  /// columns only the first and the last, as nothing can come between. Depends only on arrivals
  /// strictly before it.
  Picoseconds next_decision() const { return next_; }
  /// Takes that decision. What it decided for others is in news().
  void step();

  /// A read whose data is on the crossbar from `first` (its first 8 bytes) to `last`; both lie ahead.
  /// Reported with its first column command; with the scheduler `frfcfs` later, with that of the last of
  /// its master's older reads.
  struct ReadOutcome {
    MemRequest* request;
    Picoseconds first, last;
    Picoseconds attributed;  ///< the part of its time that `waits` explains
  };
  /// The request in the input register was taken into the FIFOs at `at`, as a request of `unblocked_by`
  /// left them and made room.
  struct Acceptance {
    MemRequest* request;
    Picoseconds at;
    Master unblocked_by;
  };
  /// What the last step() decided for others; the caller handles the reads first, in their order, and
  /// clears it.
  struct News {
    std::vector<ReadOutcome> reads;
    std::optional<Acceptance> accepted;
    bool any = false;
    void clear() {
      reads.clear();
      accepted.reset();
      any = false;
    }
  };
  News& news() { return news_; }

  /// A master's newest read that has no outcome yet; null: there is none.
  const MemRequest* newest_read(Master master) const;

  /// A debugger's access, without time: memory with the write data that wait in the FIFO. The caller
  /// checks address + bytes against the SDRAM's size.
  void debug_read(std::uint32_t address, std::uint8_t* to, unsigned bytes) const;
  void debug_write(std::uint32_t address, const std::uint8_t* from, unsigned bytes);
  /// Snapshot of all requests and of the next command, for debugger commands.
  struct View {
    struct Item {
      const MemRequest* request;  ///< stale for an accepted write: its master has gone on
      Master master;
      bool write;
      std::uint8_t bytes;
      std::uint32_t address;  ///< offset in the SDRAM
      bool waiting;           ///< in the input register, for room in the FIFOs
      bool moving;            ///< its burst is under way
      bool out_of_order;      ///< its data wait for those of its master's older reads
      Picoseconds ready;      ///< the scheduler sees it from then on
      unsigned bank;
      std::uint32_t row, open;  ///< open: DdrDevice::kClosed or the bank's row
    };
    std::vector<Item> items;  ///< the queue, oldest first; the input register; out-of-order reads
    std::size_t next = ~std::size_t{0};  ///< item of the next command; beyond the end: a refresh's
    Cmd cmd = Cmd::kRef;                 ///< that command
    Picoseconds next_at = kNever;        ///< kNever: nothing to do
    LowPower asleep = LowPower::kOff;
    Cmd last = Cmd::kRef;               ///< the command before it
    std::optional<Master> last_master;  ///< whose that was; none: a refresh's, or none at all
    bool data_full = false;  ///< the input register waits for room for write data, not for an entry
  };
  View view() const;

  DdrStats stats;
  /// What reads waited for here, between the pipeline's end and their first column command: each
  /// clock is attributed to the last command before it: another master's, or the read's own ACT or PRE.
  /// From the end of a write burst on it is the turnaround. Data that wait for older reads of the same
  /// master count as that master's own wait.
  WaitTable& waits() { return attribution_.waits; }
  const WaitTable& waits() const { return attribution_.waits; }
  std::uint64_t busy_clocks() const { return stats.bursts.count() * DdrTiming::kBurstClocks; }
  const DdrDevice& device() const { return device_; }
  /// What the part does now; catch_up() first.
  LowPower asleep() const { return asleep_; }
  const Clock& ddr_clock() const { return ddr_; }
  /// A refresh interval counts from the first edge after this time, at or before `t`; 0: none does.
  Picoseconds interval_start(Picoseconds t) const;
  /// Called with each DRAM command, for checkers and traces. Several may listen, each with its own
  /// `self`; null: this one no more.
  using CommandHook = void (*)(void* self, Cmd, unsigned bank, std::uint32_t row,
                               std::uint64_t clock);
  void set_command_hook(CommandHook hook, void* self);
  /// Called when registers or clocks have changed: the commands that follow obey config().
  std::function<void(Picoseconds at)> on_change;
  const DdrConfig& config() const { return config_; }

 private:
  static constexpr std::size_t kMaxEntries = QueuePositions::kMost;
  static constexpr std::uint64_t kNoClock = ~std::uint64_t{0};
  using Queued = QueuedRequest;
  using Entry = QueueEntry;
  /// PREA and REF are refresh's; the others belong to a request.
  struct Choice {
    Entry* entry = nullptr;
    std::uint64_t at = 0;
    Cmd cmd = Cmd::kAct;
    std::uint8_t position = 0;  // of the entry
    std::uint8_t bank = 0;  // of a PRE without an entry: the row has been open for too long
  };

  using IssuedCommand = WaitAttribution::IssuedCommand;

  /// A read whose data came before those of older reads of its master. They wait behind the return
  /// channel, in a buffer as large as what the masters have under way.
  struct OutOfOrderRead {
    Queued request;
    std::uint32_t behind = 0;  // slots of the older reads
    Picoseconds first = 0;     // its own data on the return channel
    std::uint64_t edges = 0;   // of the crossbar, from there to the last
    Picoseconds waited = 0;
  };
  bool bound_by(const Entry& younger, Positions older) const;
  void offer_all(Positions of_one_master);
  void report_in_order(const Entry& e, const ReturnChannel::Span& transfer);
  void report_out_of_order(const OutOfOrderRead& h);
  const MemRequest* newest_out_of_order(unsigned behind_slot) const;

  bool take_in(MemRequest& request, std::uint32_t offset, Picoseconds at);
  [[gnu::noinline]] bool queue(MemRequest& request, std::uint32_t offset,
                                 std::uint64_t arrived);
  void fill(Entry& e, std::uint64_t arrived) const;
  void join_queue();
  [[gnu::noinline]] void take(Entry& e, std::uint64_t arrived);
  Entry& free_entry() { return slots_[oldest(free_slots_)]; }
  void plan();
  void plan_anew();
  void plan_one(Entry& e);
  void plan_many() {
    if (closing_) [[unlikely]]
      return plan_refresh();
    plan_from(std::max(command_free_, entry(0).ready));
  }
  void plan_refresh();
  void plan_from(std::uint64_t edge);
  unsigned first_of(Positions set) const;
  Positions best_kind(Positions set, bool room) const;
  void choose(std::uint64_t edge, Positions ready);
  void prepare_others(std::uint64_t edge, Positions ready, bool room);
  Positions soonest(Positions open, std::uint64_t edge) const;
  void choose_in_order(std::uint64_t edge, Positions ready);
  bool stands_with(unsigned position, std::uint64_t edge, Positions ready);
  bool ranks_below_first(unsigned position, std::uint64_t edge) const;
  bool refresh_goes_first(Positions set) const;
  void choose_refresh(std::uint64_t edge);
  bool choose_overdue_row(std::uint64_t edge);
  void close_overdue_row(std::uint64_t clock);
  std::uint64_t first_overdue() const;
  void lose_unrefreshed(Picoseconds slept);
  enum class Urgency { kMay, kNeed, kMust };
  Urgency refresh_urgency(std::uint64_t edge) const {
    return edge < next_expiry_ ? urgency_ : refresh_urgency_after(edge);
  }
  Urgency refresh_urgency_after(std::uint64_t edge) const;
  void begin_refresh();
  void urgency_changed();
  Cmd needed(const Entry& e) const;
  std::uint64_t earliest(const Entry& e, Cmd cmd, std::uint64_t edge) const;
  Entry& entry(unsigned position) { return slots_[queue_.slot(position)]; }
  const Entry& entry(unsigned position) const { return slots_[queue_.slot(position)]; }
  bool passes(const Entry& read, Positions older) const;
  void offer(Positions of_one_master);
  void idle(std::uint64_t until);
  void idle_until_arrival(std::uint64_t clock);
  void pass_over_refreshes(std::uint64_t until);
  bool fall_asleep(std::uint64_t until);
  void sleep_changes(LowPower to, std::uint64_t clock);
  void wake(std::uint64_t clock);
  void mark(Cmd cmd, std::uint64_t clock);
  void count_queued(std::uint64_t until);
  void count_asleep(std::uint64_t until);
  void count_owed(std::uint64_t clock) {
    if (clock >= next_expiry_) [[unlikely]]
      count_expired(clock);
  }
  void count_expired(std::uint64_t clock);
  template <Cmd kCmd>
  void note(std::uint64_t clock, Picoseconds at);
  /// `at`: of the clock; a decision's is next_.
  template <Cmd kCmd>
  void issue(unsigned bank, std::uint32_t row, std::uint64_t clock, Picoseconds at);
  void issue_refresh(std::uint64_t clock, Picoseconds at);
  void prepare();
  bool row_wanted(const Entry& by_others) const;
  template <Cmd kCmd>
  void issue_closing_column(const Entry& e, std::uint64_t clock);
  template <Cmd kCmd>
  [[gnu::noinline]] void first_column();
  template <Cmd kCmd>
  [[gnu::noinline]] void last_column();
  void columns_before(std::uint64_t until);
  void finish(std::uint64_t clock);
  void finish_queued(std::uint64_t clock);
  void leave_queue();
  void report_read(MemRequest* request, Picoseconds first, Picoseconds last) {
    news_.reads.push_back({request, first, last, attribution_.waited});
    news_.any = true;
  }
  void accept_waiting(std::uint64_t clock);

  BackingStore& store_;
  News news_;
  Clock ddr_, scr_;
  std::uint64_t first_edge_ = 0;  // of the DDR clock since its last restart
  bool running_ = false;
  bool input_blocked_ = true;  // stopped, or the input register taken
  DdrDevice device_;
  DdrConfig config_;
  // The address map in effect.
  std::uint64_t size_;
  unsigned bank_shift_ = 11, row_shift_ = 14;
  std::uint32_t bank_mask_ = 7, row_mask_ = ~0u;

  // Configuration copied out of the parameters once: read in the hot path.
  std::size_t fifo_entries_;
  unsigned write_fifo_words_, request_latency_, return_latency_, clock_restart_;
  Picoseconds retention_;
  unsigned release_, need_, must_, gap_limit_;
  SchedulerPolicy policy_;

  std::array<Entry, kMaxEntries> slots_;
  std::uint32_t free_slots_ = (1u << kMaxEntries) - 1;
  unsigned count_ = 0;
  // A request that comes while nothing else is queued goes to slot 0, and mostly leaves before another
  // one comes: the sets and totals of the queue do not know it until join_queue().
  bool single_ = false;
  QueuePositions queue_;
  Positions offered_ = 0;  // whose command its master offers (rule 1)
  Positions hits_ = 0;     // whose row is open
  WaitAttribution attribution_{ddr_, slots_, queue_, count_};
  std::uint64_t last_arrival_ = 0;
  unsigned write_words_held_ = 0;
  bool input_taken_ = false;
  Queued input_;
  std::uint64_t input_arrived_ = 0;

  std::uint64_t command_free_ = 0;  // edge after the last command or change of configuration
  Choice choice_;
  unsigned first_ = 0;     // position of the first in rank when choice_ was made
  bool plain_ = false;     // by rank, with room for read data
  Picoseconds next_ = kNever;
  bool in_burst_ = false;  // choice_ is the last column of a burst under way
  std::uint64_t next_column_ = 0;
  unsigned columns_left_ = 0;
  std::uint64_t served_while_oldest_ = 0;

  std::uint64_t next_expiry_ = 0;     // edge at which the refresh interval runs out next
  Urgency urgency_ = Urgency::kMay;   // before next_expiry_
  std::uint64_t all_in_time_until_ = 0;  // no interval ends and no row is due before this edge
  std::uint64_t calm_until_ = 0;         // and no refresh is urgent
  std::uint64_t idle_calm_ = 0;       // nothing to do before this edge while nothing is queued
  LowPower asleep_ = LowPower::kOff;  // CKE is low
  std::uint64_t queued_since_ = 0, asleep_since_ = 0;  // edges up to which that time is counted
  std::uint64_t cke_free_ = 0;        // edge from which CKE may move again
  Picoseconds asleep_at_ = 0;         // when it fell asleep
  unsigned owed_ = 0, forced_ = 0;
  unsigned gap_ = 0;  // intervals that ended since the last REF
  // A refresh has closed the banks: its REF follows before anything else. Without this, requests that
  // come between the two would reopen their rows and find them closed again at the next idle clock; and
  // a read that ranks first only while all rows are closed and one that does only while its row is open
  // could take turns in putting it off, and none of them be served.
  bool closing_ = false;
  bool catching_up_ = false;  // the backlog was above `must` and is not down to `release` yet
  ReturnChannel return_channel_;

  std::vector<OutOfOrderRead> out_of_order_;                        // each master's oldest first
  std::array<Picoseconds, kMasterCount> reported_until_{};  // with policy_.free_order: ends of their newest

  std::vector<std::pair<CommandHook, void*>> listeners_;
  CommandHook hook_ = nullptr;  // the only listener, or one that calls all
  void* hook_self_ = nullptr;
};

/// Words of 64 bits that a write's data occupies in the FIFO: one touched in part counts as a whole one.
inline unsigned write_words(std::uint32_t address, unsigned bytes) {
  return ((address & 7u) + bytes + 7u) >> 3;
}

inline Cmd DdrController::needed(const Entry& e) const {
  const std::uint32_t open = device_.row(e.bank);
  if (open == e.row) return e.request.write ? Cmd::kWr : Cmd::kRd;
  return open == DdrDevice::kClosed ? Cmd::kAct : Cmd::kPre;
}

inline std::uint64_t DdrController::earliest(const Entry& e, Cmd cmd, std::uint64_t edge) const {
  const std::uint64_t at = std::max(edge, device_.earliest(cmd, e.bank));
  return cmd == Cmd::kRd ? std::max(at, return_channel_.room()) : at;
}

}  // namespace fovea::mem
