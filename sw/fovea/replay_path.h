// The memory system played from a trace, without core, video and SystemC.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "model/bus/core/latency_stats.h"
#include "model/mem/ddr_check.h"
#include "model/memsys/memory_system.h"
#include "model/trace/core/trace.h"
#include "sw/fovea/outputs.h"
#include "sw/fovea/replay_params.h"

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

  /// Plays what comes before `until`; true: all is played. @throws UserError for a record that this
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
  Picoseconds start() const { return start_; }
  const mem::DdrStats& memory() const { return ddr().stats; }
  /// Called with each record as it goes out; empty in a plain replay.
  std::function<void(unsigned stream, Picoseconds at)> on_issue;

 private:
  static constexpr std::size_t kHistory = trace::kMaxBack + 1;
  struct Slot : MemRequest {
    Picoseconds free = 0;  // kNever: taken, and its end is not known
    std::uint64_t number = 0;
    Picoseconds came = 0;  // when its record was released, whether or not its port was free
    alignas(16) std::array<std::uint8_t, kMaxBurstBytes> bytes_{};
  };
  struct MasterState {
    std::string label;
    std::vector<Slot> slots;
    unsigned write_slots_from = 0, read_slots_to = 0;
    bool in_turn = false;  // each direction has slots of its own, and they end in order
    std::array<unsigned, 2> turn{};  // reads, writes: the slot that ended first, or will
    unsigned stream = 0;
    std::uint8_t priority = 0xFF;
    std::uint64_t read_bytes = 0, write_bytes = 0, transactions = 0;
    std::uint64_t at_recorded_time = 0;          // but for the stream's first record
    std::shared_ptr<bus::LatencyStats> latency;  // with others of this label
  };
  struct Outcome {
    Picoseconds first, last;
  };
  struct Stream {
    trace::Record record;
    bool valid = false;     // `record` is the next one
    std::uint64_t number = 0;
    Picoseconds earliest = 0;
    Clock clock;
    unsigned align = 1, phase = 0;
    Slot* slot = nullptr;   // for it
    Picoseconds came = 0;   // when it was released
    std::vector<Outcome> history;
  };

  void set_up_memory(const ReplayParams& params);
  void set_up_streams();
  void set_up_masters();
  Picoseconds end() const;
  void add_wait_rows(const std::string& label, Waits MasterWaits::*direction, const char* name,
                     std::vector<StatRow>& rows) const;
  void fetch(unsigned stream);
  void prepare(unsigned stream);
  Picoseconds event(const trace::Record& r) const;
  Picoseconds released(const Stream& s) const;
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
  void check(const trace::Record& r, const Stream& s);
  void complete(Slot& slot);

  void completed(MemRequest& r) override { complete(static_cast<Slot&>(r)); }
  Taken deliver(MemRequest&, bus::Slave, Picoseconds) override { return Taken::kRefused; }
  const mem::DdrController& ddr() const { return memory_.controller(); }

  std::string name_;
  const trace::TraceInfo& info_;
  trace::RecordSource& source_;
  bool memory_only_;
  std::array<MasterState, kMasterCount> masters_;
  std::vector<Stream> streams_;
  std::array<Picoseconds, kMasterCount> time_{};  // of each stream's next request
  std::uint32_t due_ = 0;                         // streams whose time is known
  std::array<std::uint8_t, kMasterCount> waits_for_{};  // stream that holds up each, by kWhen
  bool cross_ = false;  // a record of one stream has waited for another
  unsigned next_stream_ = 0;
  Picoseconds next_time_ = kNever;
  Picoseconds start_ = 0, last_ = 0;
  std::uint64_t requests_ = 0, bytes_ = 0;
  std::vector<Mark> marks_;
  memsys::MemorySystem memory_;
  mem::DdrCheck check_;
};

}  // namespace fovea::app
