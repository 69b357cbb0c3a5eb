// TI's DDR2/mDDR controller (the family's scheduler) as a passive state machine: the caller advances
// it to a time, which must not lie after that of a request that can still arrive.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "model/common/clock.h"
#include "model/common/masters.h"
#include "model/common/mem_request.h"
#include "model/common/observers.h"
#include "model/common/waits.h"
#include "model/mem/core/backing_store.h"
#include "model/mem/core/command_queue.h"
#include "model/mem/core/ddr_config.h"
#include "model/mem/core/ddr_params.h"
#include "model/mem/core/ddr_stats.h"
#include "model/mem/core/ddr_timing.h"
#include "model/mem/core/power_manager.h"
#include "model/mem/core/read_return.h"
#include "model/mem/core/refresh_manager.h"
#include "model/mem/core/row_policy.h"
#include "model/mem/core/scheduler/schedulers.h"
#include "model/mem/core/wait_attribution.h"

namespace fovea::mem {

/// Joins the parts of the controller: the queue, the part's timing, a scheduler, refresh, power-down, row
/// policy, the way back of read data, and the attribution of waits. What is left here is what they share:
/// the command bus, on which one command is issued at a time.
class DdrController {
 public:
  /// @param diagnostics receives warnings of postponed refreshes and of lost data
  DdrController(const DdrParams& params, BackingStore& store, const DiagnosticsRef& diagnostics);
  DdrController(const DdrController&) = delete;
  DdrController& operator=(const DdrController&) = delete;

  void set_clocks(Frequency ddr, Frequency scr, Picoseconds at);
  /// Reads have no crossbar to go to: their data are there when the SDRAM has sent them.
  void leave_out_return_channel() { returns_.channel().leave_out(); }
  /// New timing from the registers; takes effect for commands after the call's time.
  void configure(const DdrConfig& config, Picoseconds at);
  bool running() const { return running_; }
  /// Refreshes that are owed, and requests in the FIFOs; catch_up() first.
  unsigned refreshes_owed() const { return refresh_.owed(); }
  unsigned requests_queued() const { return queue_.count(); }

  /// Catches up to `at` what needs no decision: refreshes and sleep while nothing is queued, and
  /// the columns inside a burst. They change nothing that a master can see before the next decision
  /// or request. Must be called before the statistics are read.
  void catch_up(Picoseconds at);

  /// A request for the SDRAM, at byte `offset` in it, arrives at time `at`. The write data are copied
  /// when the request is accepted; the request itself stays valid until its outcome. True: accepted at
  /// once. False: it waits in the input register, until the news() of a later step say that it was
  /// accepted; the caller sends no other one before.
  bool submit(MemRequest& request, std::uint32_t offset, Picoseconds at);
  /// Like submit(), without its checks. The request must lie inside the SDRAM, and input_blocked() must be
  /// false. An inline function, in ddr_plan.h.
  bool submit_inside(MemRequest& request, std::uint32_t offset, Picoseconds at);
  /// The clock is stopped, or a request waits in the input register: no request may be submitted.
  bool input_blocked() const { return input_blocked_; }

  /// Time of the next decision, kNever if nothing is queued: a DRAM command, but of a burst's
  /// columns only the first and the last, as nothing can come between. Depends only on arrivals
  /// strictly before it.
  Picoseconds next_decision() const { return next_; }
  /// Takes that decision. What it decided for others is in news().
  void step();
  /// The same in line, in ddr_plan.h.
  void take_decision();

  /// Reported with the read's first column command; with a scheduler that reorders reads later, with that
  /// of the last of its master's older reads.
  using ReadOutcome = mem::ReadOutcome;
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
    ReadOutcomes reads;
    std::optional<Acceptance> accepted;
    bool any = false;
    void clear() {
      reads.clear();
      accepted.reset();
      any = false;
    }
  };
  News& news() { return news_; }

  /// The bank and row of a byte of the SDRAM, as the address map in effect has them.
  void tell_place(std::uint32_t offset, SlowRequest& s) const {
    s.bank = bank_of(offset);
    s.row = row_of(offset);
  }
  /// How a read found its row, and the steps until its data are on the crossbar.
  void tell_waits(const ReadOutcome& read, SlowRequest& s) const {
    attribution_.tell(read.column, read.attributed, read.first, s);
  }

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
  LowPower asleep() const { return power_.mode(); }
  const Clock& ddr_clock() const { return ddr_; }
  /// A refresh interval counts from the first edge after this time, at or before `t`; 0: none does.
  Picoseconds interval_start(Picoseconds t) const;
  /// Called with each DRAM command, for checkers and traces, as long as the subscription lives.
  using CommandHook = void (*)(void* self, Cmd, unsigned bank, std::uint32_t row,
                               std::uint64_t clock);
  Subscription observe_commands(CommandHook hook, void* self) { return hooks_.add({hook, self}); }
  /// Within a hook called with a read or a write: the request whose first column that is, and whose data have just
  /// moved; null: it is another column.
  const QueueEntry* beginning() const { return in_burst_ ? nullptr : plan_.choice.entry; }
  /// Called when registers or clocks have changed: the commands that follow obey config().
  std::function<void(Picoseconds at)> on_change;
  const DdrConfig& config() const { return config_; }

 private:
  static constexpr std::uint64_t kNoClock = ~std::uint64_t{0};
  using Queued = QueuedRequest;
  using Entry = QueueEntry;
  using IssuedCommand = WaitAttribution::IssuedCommand;
  using Urgency = RefreshManager::Urgency;

  // Requests: ddr_controller.cpp.
  bool take_in(MemRequest& request, std::uint32_t offset, Picoseconds at);
  [[gnu::noinline]] bool queue(MemRequest& request, std::uint32_t offset, std::uint64_t arrived);
  void fill(Entry& e, std::uint64_t arrived) const;
  std::uint8_t bank_of(std::uint32_t offset) const {
    return static_cast<std::uint8_t>((offset >> bank_shift_) & bank_mask_);
  }
  std::uint32_t row_of(std::uint32_t offset) const { return (offset & row_mask_) >> row_shift_; }
  void join_single();
  [[gnu::noinline]] void take(Entry& e, std::uint64_t arrived);
  /// Room for a request in the FIFOs.
  bool fits(bool write, std::uint32_t address, unsigned bytes) const {
    return queue_.count() < fifo_entries_ &&
           !(write && queue_.write_words_held() + write_words(address, bytes) > write_fifo_words_);
  }
  void accept_waiting(std::uint64_t clock);
  void send_in_order(const Entry& e, const WaitAttribution::Column& column);
  void finish(std::uint64_t clock);
  void finish_queued(std::uint64_t clock);
  void leave_queue();
  void count_queued(std::uint64_t until);

  // Commands: ddr_controller.cpp.
  template <Cmd kCmd>
  void note(std::uint64_t clock, Picoseconds at, unsigned burst = 0);
  void call_hook(Cmd cmd, unsigned bank, std::uint32_t row, std::uint64_t clock) {
    if (!hooks_.empty()) [[unlikely]]
      call_hooks(cmd, bank, row, clock);
  }
  void call_hooks(Cmd cmd, unsigned bank, std::uint32_t row, std::uint64_t clock);
  /// `at`: of the clock; a decision's is next_.
  template <Cmd kCmd>
  void issue(unsigned bank, std::uint32_t row, std::uint64_t clock, Picoseconds at);
  void prepare();
  template <Cmd kCmd>
  [[gnu::noinline]] void first_column();
  template <Cmd kCmd>
  [[gnu::noinline]] void last_column();
  template <Cmd kCmd>
  void issue_last_column(const Entry& e, std::uint64_t clock);
  void columns_before(std::uint64_t until);
  void columns_take_effect();
  void close_overdue_row(std::uint64_t clock);
  void mark(Cmd cmd, std::uint64_t clock);

  // Planning: ddr_schedule.cpp.
  void plan();
  void plan_anew();
  void plan_one(Entry& e);
  void plan_many();
  void plan_refresh();
  void plan_from(std::uint64_t edge);
  void plan_with_newest(std::uint64_t edge);
  template <Scheduler S>
  void plan_by(std::uint64_t edge);
  template <Scheduler S>
  void choose(const SchedulerInput& in, std::uint64_t edge, Positions seen);
  template <Scheduler S>
  bool stands(const SchedulerInput& in, unsigned position, std::uint64_t edge);
  SchedulerInput scheduler_input() {
    return {queue_, device_, returns_.room(),
            served_while_oldest_ > config_.old_count && config_.old_count != 0xFF,
            refresh_.urgency() != Urgency::kMay};
  }
  /// Calls f with the scheduler's type.
  template <class F>
  decltype(auto) with_scheduler(F f) const {
    return std::visit(f, scheduler_);
  }
  bool refresh_goes_first(Positions set) const;
  void choose_refresh(std::uint64_t edge);
  bool choose_overdue_row(std::uint64_t edge);
  void update_deadlines();

  // Refresh and sleep: ddr_idle.cpp.
  void idle(std::uint64_t until);
  void idle_until_arrival(std::uint64_t clock);
  void pass_over_refreshes(std::uint64_t until);
  void begin_refresh();
  void issue_refresh(std::uint64_t clock, Picoseconds at);
  void count_owed(std::uint64_t clock) {
    if (clock >= refresh_.next_expiry()) [[unlikely]]
      count_expired(clock);
  }
  void count_expired(std::uint64_t clock);
  bool fall_asleep(std::uint64_t until);
  void wake(std::uint64_t clock);
  void sleep_changes(LowPower to, std::uint64_t clock);

  BackingStore& store_;
  News news_;
  Clock ddr_, scr_;
  std::uint64_t first_edge_ = 0;  // of the DDR clock since its last restart
  bool running_ = false;
  bool input_blocked_ = true;  // stopped, or the input register taken
  DdrConfig config_;
  // The address map in effect.
  std::uint64_t size_;
  unsigned bank_shift_ = 11, row_shift_ = 14;
  std::uint32_t bank_mask_ = 7, row_mask_ = ~0u;

  // Configuration copied out of the parameters once: read in the hot path.
  std::size_t fifo_entries_;
  unsigned write_fifo_words_, request_latency_, return_latency_;
  Picoseconds retention_;

  DdrDevice device_;
  CommandQueue queue_;
  WaitAttribution attribution_{ddr_, queue_};
  ReadReturn returns_{ddr_, scr_, attribution_};
  RefreshManager refresh_;
  PowerManager power_;
  RowPolicy rows_;
  AnyScheduler scheduler_;

  std::uint64_t last_arrival_ = 0;
  std::uint64_t queued_since_ = 0;  // edge up to which the time with requests queued is counted
  bool input_taken_ = false;
  Queued input_;
  std::uint64_t input_arrived_ = 0;

  std::uint64_t command_free_ = 0;  // edge after the last command or change of configuration
  Plan plan_;
  Picoseconds next_ = kNever;  // when plan_ is carried out
  std::uint64_t served_while_oldest_ = 0;  // column commands of others since the oldest became so
  // Of a burst under way plan_ is the last column.
  bool in_burst_ = false;
  std::uint64_t next_column_ = 0;
  unsigned columns_left_ = 0;
  /// The newest column issued, while its constraints are left to the last one's, which come later.
  std::uint64_t newest_column_ = 0;

  std::uint64_t all_in_time_until_ = 0;  // no interval ends and no row is due before this edge
  std::uint64_t calm_until_ = 0;         // and no refresh is urgent
  std::uint64_t idle_calm_ = 0;          // nothing to do before this edge while nothing is queued

  struct Hook {
    CommandHook call;
    void* self;
  };
  Observers<Hook> hooks_;
  DiagnosticsRef diagnostics_;
};

}  // namespace fovea::mem
