// The memory system played from a trace, without core, video and SystemC.
#pragma once
#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/bus/core/latency_stats.h"
#include "model/mem/ddr_check.h"
#include "model/memsys/memory_system.h"
#include "model/trace/core/trace.h"
#include "sw/fovea/replay/core_ram.h"
#include "sw/fovea/replay/replay_params.h"
#include "sw/fovea/replay/replay_pipe.h"
#include "sw/fovea/replay/replay_slaves.h"
#include "sw/fovea/replay/wake_order.h"
#include "sw/fovea/results/outputs.h"
#include "sw/fovea/tools/slowest.h"

namespace fovea::app {

class ReplayPath final : private memsys::MemoryHost {
 public:
  struct Mark {
    std::uint32_t value;
    Picoseconds at;
  };
  /// `name` is the trace's, for messages. Clocks: those of `info`, unless `params` say otherwise.
  ReplayPath(std::string name, const trace::TraceInfo& info, trace::RecordSource& source,
             const ReplayParams& params, bool memory_only);

  /// The figures shall be comparable with those of a run in the recorded window: nothing is played after its end, as
  /// the video ports' later requests are not in the trace, nor for long after the core's last record, if the core was
  /// at work up to the window's end and has now done all sooner.
  void end_with_window();
  /// Plays what comes before `until`; true: all is played that is to be. @throws UserError for a record that this
  /// memory cannot have
  bool run_before(Picoseconds until);
  /// To be called before the figures are read.
  void finish() {
    memory_.controller().catch_up(end());
    check_.warn(ddr().config(), ddr().ddr_clock().frequency());
  }

  /// Both sides of a transfer controller, of one label, are one.
  std::vector<StatRow> stats();
  std::vector<std::string> labels() const;
  /// Bytes by label. The last row ends with the replay.
  std::vector<TimelineRow> timeline() const;
  const std::vector<Mark>& marks() const { return marks_; }
  /// Of the frames whose remap began and ended in the trace, by its marks.
  std::vector<Picoseconds> remap_times() const;
  std::uint64_t requests() const { return requests_; }
  /// From the recording's start to the last completion, and to the last data on the SDRAM's bus: those
  /// of a write come behind its completion.
  Picoseconds duration() const { return end() > start_ ? end() - start_ : 0; }
  const bus::LatencyStats& latency(Master m) const { return *masters_[index(m)].latency; }
  /// Adds an observer of the requests on the crossbar.
  Subscription observe(MemObserver& observer) { return memory_.crossbar().observe(observer); }
  mem::DdrController& controller() { return memory_.controller(); }
  /// Rows of latency.csv, of all labels.
  std::vector<LatencyRow> latency_rows() const;
  /// Rows of slowest.csv, of all labels.
  std::vector<SlowestRow> slowest_rows() const;
  /// What the figures call a port; empty for one that the trace does not name.
  const std::string& label(Master m) const { return masters_[index(m)].label; }
  Picoseconds start() const { return start_; }
  const mem::DdrStats& memory() const { return ddr().stats; }
  /// Clocks of the core for which bursts have waited in internal RAM as recorded, whatever the settings are: by a trace
  /// that lacks the core's accesses to it.
  std::uint64_t waited_in_ram() const { return slaves_.waited_in_ram(); }
  /// Called with each record as it goes out; empty in a plain replay.
  std::function<void(unsigned stream, Picoseconds at)> on_issue;
  /// No request will go out before that time any more.
  Picoseconds progress() const { return std::min(next_time_, next_event()); }

 private:
  static constexpr std::size_t kHistory = trace::kMaxBack + 1;
  struct Slot : MemRequest {
    Picoseconds free = 0;  // kNever: taken, and its end is not known
    std::uint64_t number = 0;
    Picoseconds came = 0;  // when its record was released, whether or not its port was free
    Picoseconds service = 0;  // of a register
    alignas(16) std::array<std::uint8_t, kMaxBurstBytes> bytes_{};
  };
  struct MasterState {
    std::string label;
    std::vector<Slot> slots;
    unsigned bursts = 0;  // of each direction
    unsigned write_slots_from = 0, read_slots_to = 0;
    bool in_turn = false;  // each direction has slots of its own, and they end in order
    std::array<unsigned, 2> turn{};  // reads, writes: the slot that ended first, or will
    unsigned stream = 0;
    std::uint8_t priority = 0xFF;
    std::uint64_t read_bytes = 0, write_bytes = 0, transactions = 0;  // on the crossbar, or where there is none
                                                                      // at the controller
    void count(bool write, unsigned bytes) {
      ++transactions;
      (write ? write_bytes : read_bytes) += bytes;
    }
    std::uint64_t at_recorded_time = 0;          // but for the stream's first record
    std::shared_ptr<bus::LatencyStats> latency;  // with others of this label
  };
  /// Of a transfer: when it was submitted, when it ended.
  struct Outcome {
    std::uint64_t number = ~std::uint64_t{0};  // of its record
    Picoseconds first = 0, last = 0;
    Picoseconds delivered = kNever;            // trace::Point::kDelivered
  };
  struct Stream {
    trace::Record record;
    bool valid = false;     // `record` is the next one
    std::uint64_t number = 0;   // of `record`
    std::uint64_t played = 0;   // one more than the largest number played
    Picoseconds earliest = 0;
    Clock clock;
    unsigned align = 1, phase = 0;
    Slot* slot = nullptr;   // for it
    Picoseconds came = 0;   // when it was released
    std::vector<Outcome> history;
    unsigned controller = kTransferControllers;  // whose transfers it holds; kTransferControllers: none's
  };

  /// A record of the core whose program has come to it, and which waits for its port.
  struct Ready {
    trace::Record record;
    std::uint64_t number = 0;
    Picoseconds came = 0;
  };

  void set_up_memory(const ReplayParams& params);
  void set_up_streams();
  void set_up_masters();
  void set_up_transfers();
  Picoseconds end() const;
  void add_wait_rows(const std::string& label, Waits MasterWaits::*direction, const char* name,
                     std::vector<StatRow>& rows) const;
  void fetch(unsigned stream);
  void next_record(unsigned stream);
  void next_in_wake_order();
  void core_has_ended(Picoseconds recorded);
  void leave_out_the_rest();
  void set_core_record(WakeOrder::Numbered& n);
  std::uint8_t wake_core();
  static void note_outcome(Stream& s, Picoseconds first, Picoseconds last);
  void prepare(unsigned stream);
  Picoseconds event(const trace::Record& r) const;
  Picoseconds moment(std::uint8_t stream, std::uint64_t number, trace::Point point) const;
  std::uint8_t awaited(const trace::Record& r) const;
  Picoseconds turn_of_transfer(const Stream& s, Picoseconds ready) const;
  void submit_transfer(unsigned stream);
  void send(ReplayPipe::Burst& burst);
  void serve(MemRequest& r, bus::Slave slave, Picoseconds arrival);
  void delivered(const Slot& slot, Picoseconds at);
  void finish_served();
  void end_served(MemRequest& r, Picoseconds at);
  Picoseconds next_event() const { return std::min({memory_.next_event(), slaves_.next(), ram_over_}); }
  void wake_those_behind(unsigned stream);
  Picoseconds released(const Stream& s);
  std::uint64_t wait_in_gap(const trace::Record& r, std::uint64_t edge);
  void note_ram_over();
  static std::uint64_t aligned(const Stream& s, std::uint64_t edge);
  void wake(unsigned stream);
  Slot* place(MasterState& m, bool write);
  void set_time(unsigned stream, Picoseconds at) {
    time_[stream] = at;
    const std::uint32_t bit = 1u << stream;
    due_ = at == kNever ? due_ & ~bit : due_ | bit;
  }
  void find_next();
  void issue();
  void issue_request(unsigned stream, const trace::Record& r, std::uint64_t number, Picoseconds came, Slot& slot);
  Picoseconds time_on_port(const Stream& s, const trace::Record& r, Picoseconds came, const Slot& slot) const;
  void prepare_core();
  Picoseconds program_time();
  Picoseconds ready_time();
  void go_on_with_core();
  void begin_in_ram();
  void end_in_ram();
  void note_end_of_core();
  void check(const trace::Record& r, const Stream& s);
  void complete(Slot& slot);

  void completed(MemRequest& r) override;
  Taken deliver(MemRequest& r, bus::Slave slave, Picoseconds arrival) override;
  const mem::DdrController& ddr() const { return memory_.controller(); }

  std::string name_;
  const trace::TraceInfo& info_;
  trace::RecordSource& source_;
  bool memory_only_;
  std::array<MasterState, kMasterCount> masters_;
  std::vector<Stream> streams_;
  std::optional<WakeOrder> wake_order_;  // of the core, if transfers wake it
  bool asleep_ = false, chosen_ = false, settled_ = false, transfers_done_ = false;
  std::array<Picoseconds, kMasterCount> time_{};  // of each stream's next request
  std::uint32_t due_ = 0;                         // streams whose time is known
  std::array<std::uint8_t, kMasterCount> waits_for_{};  // stream that holds up each, by kWhen
  bool cross_ = false;  // a record of one stream has waited for another
  std::array<std::unique_ptr<ReplayPipe>, kTransferControllers> pipes_;
  Clock scr_;                          // of the transfers
  Picoseconds next_request_ = 0;       // when the channel controller takes the next request
  ReplaySlaves slaves_;
  CoreRam ram_;
  Picoseconds ram_over_ = kNever;      // of the burst in internal RAM, as far as is known
  std::deque<Ready> ready_;
  Slot* ready_slot_ = nullptr;         // for the first of them
  Picoseconds program_at_ = 0;         // when it came to the record before
  Picoseconds program_time_ = kNever;  // when the program comes to the core's next record
  bool ended_in_trace_ = false;        // to be noted when all before has gone out
  unsigned next_stream_ = 0;
  Picoseconds next_time_ = kNever;
  Picoseconds start_ = 0, last_ = 0;
  bool end_with_window_ = false;
  Picoseconds stop_ = kNever, ended_early_ = kNever;
  std::uint64_t left_out_ = 0;         // requests and transfers, because of stop_
  Picoseconds core_last_ = 0;          // when the core's latest record went out
  std::uint64_t requests_ = 0, bytes_ = 0;
  std::vector<Mark> marks_;
  memsys::MemorySystem memory_;
  mem::DdrCheck check_;
};

}  // namespace fovea::app
