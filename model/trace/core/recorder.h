// Makes a bus trace of what passes the crossbar: derives from times and outcomes what released each
// request. The rules and their reasons: model/decisions/0006-trace.md.
#pragma once
#include <array>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "model/common/clock.h"
#include "model/common/masters.h"
#include "model/common/mem_observer.h"
#include "model/common/ram_watch.h"
#include "model/common/transfer_request.h"
#include "model/trace/core/trace_file.h"

namespace fovea::trace {

/// What the core reports of itself, in core clocks since its start.
struct CoreState {
  std::uint64_t idle = 0;        ///< asleep, waiting for an interrupt
  std::uint64_t room_waits = 0;  ///< waiting for room in the write and victim buffers
  std::uint64_t drains = 0;      ///< how often it has waited for both to be empty
  /// Of the request asked about: when the program came to it, less the room_waits until then; 0: not
  /// known, or a write that the program waits for.
  std::uint64_t asked = 0;
  bool victim = false;           ///< a write from the victim buffer
  std::uint64_t origin = 0;      ///< of `asked`: the clock at which the core's clock started
  std::uint64_t woke = 0;        ///< when its latest sleep ended, counted as `asked`; 0: not known
};

/// What surrounds the masters, for the transfers of the EDMA.
struct Surroundings {
  EdmaInfo edma;
  /// What a word's access to a register takes.
  std::function<Picoseconds(std::uint32_t address)> register_latency;
  std::function<unsigned(Master)> priority;
  /// A transfer of the EDMA has been triggered and has not ended.
  std::function<bool()> transfers_under_way;
};

/// The core's write buffer (ARM DDI 0198D ch. 6).
inline constexpr unsigned kBufferedStores = 4, kBufferedWords = 16;

class BusRecorder : public MemObserver, public TransferObserver, public RamWatch {
 public:
  struct MasterSetup {
    Master id;
    Pace pace;
    unsigned reads, writes;
    bool shared;
    std::optional<Master> partner = {};  ///< whose completions it waits for as well
  };
  /// @param core asked at each of the core's requests, and without one when the recording begins
  BusRecorder(const std::vector<MasterSetup>& masters, unsigned core_align,
              std::function<CoreState(const MemRequest*)> core, Surroundings surroundings = {});

  /// Recording covers [start, end): requests put on their port in it. If transfers of the EDMA are under way at
  /// `start`, of which the trace would have only a part, it begins later: with the core's first register access at
  /// which there are none, but at most kLongestDelay later. The clock is the core's, `scr` the crossbar's.
  void open(Picoseconds start, Frequency core_clock, Picoseconds core_clock_start, const ClockInfo& scr = {});
  static constexpr Picoseconds kLongestDelay = 20 * kPsPerMs;
  void close(Picoseconds end);
  /// An interrupt line of the core rises.
  void interrupt(Picoseconds at);
  /// The program shows a phase.
  void mark(std::uint32_t value, Picoseconds at);

  void submitted(const MemRequest& r, bool to_sdram) override;
  void responded(const MemRequest& r) override;
  void register_done(const MemRequest& r) override;

  void trigger_written(Master writer, Picoseconds at) override;
  void requested(const TransferRequest& request, const TransferTrigger& by, unsigned burst, Picoseconds ready,
                 Picoseconds at) override;
  void coded(const TransferTrigger& by, Picoseconds at) override;
  void completion_pulsed(Picoseconds at) override {
    pulse_ = code_;
    pulsed_at_ = at;
  }
  void loaded(const Load& load) override;
  void accessed(const Access& access) override;
  void moved(const Burst& burst, Picoseconds at) override;

  /// After close(). `info` has the parameters and the clocks of crossbar and SDRAM; the rest is
  /// filled in.
  void finish(TraceInfo info, const std::function<void(std::string_view)>& put);
  std::uint64_t records() const { return writer_.records(); }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  static constexpr std::size_t kHistory = kMaxBack + 1;
  // More than any master hands over ahead of the kernel.
  static constexpr std::size_t kHeldBack = 256;

  struct Pending {
    Record record;
    Picoseconds issued = 0;
    std::uint64_t reference = kNone;  // number of the record that releases it
    std::uint64_t room = kNone;       // number of the write whose end makes room for it
    std::uint64_t event = kNone;      // kWhen of a stream: number of the record there
    Picoseconds ready = 0;            // of a transfer: when its turn came
    bool done = false, failed = false;
  };
  struct Outcome {
    std::uint64_t number = kNone, place = kNone;  // place: among those written
    Picoseconds first = 0, last = 0;
    bool done = false, write = false;
  };
  struct Stream {
    std::deque<Pending> pending;
    std::uint64_t next = 0;     // number of the next record
    std::uint64_t written = 0;
    std::vector<Outcome> history;
    std::uint64_t blocking_read = kNone, latest = kNone, taken_place = kNone;
    Pace pace = Pace::kSampled;
    unsigned reads = 1;
    std::uint8_t partner = kInterrupt;  // its stream
    std::uint64_t first = kNone;        // number of the first record in the recording
  };
  /// A request of the core whose place in the program is known.
  struct Step {
    std::uint64_t number = kNone, asked = 0, room_waits = 0;
    bool write = false;
    bool blocking = false;  // the program waits for its end
  };
  /// A burst from the write buffer.
  struct Buffered {
    std::uint64_t number, asked;
    unsigned words;
  };
  struct Flight {
    const MemRequest* request;
    std::uint64_t number;
  };
  /// A transfer as a record's number in the stream of its controller.
  struct Transfer {
    std::uint8_t stream = kInterrupt;
    std::uint64_t number = kNone;
  };
  struct Controller {
    unsigned stream = ~0u;          // ~0: its transfers are not followed
    std::uint64_t base = kNone;     // of its requests' numbers: that of record 0
    struct Left {
      std::uint64_t number;
      std::uint32_t bytes;
      std::uint32_t bursts;  // that went elsewhere than to the SDRAM
    };
    std::array<std::deque<Left>, 2> to_issue;  // transfers with reads, and writes, that are not on the port yet
    struct Elsewhere {
      std::uint32_t address;
      std::uint64_t number;
      std::uint32_t burst;  // of those of the transfer that do not go to the SDRAM
      bool last;
    };
    std::array<std::deque<Elsewhere>, 2> elsewhere;  // reads and writes under way that do not go to the SDRAM
  };
  /// A word of internal RAM that the program looks at again and again.
  struct Flag {
    std::uint32_t word = ~0u;
    bool written = false;           // by a transfer, and not seen since
    bool last = false;              // with its last write
    Transfer by;
    Picoseconds at = 0;
  };
  /// The program looks at one place again and again.
  struct Looks {
    std::uint32_t place = 0;
    std::uint64_t first = 0, latest = 0;  // clocks of the core, counted as those of the recording
    unsigned count = 0;
    std::uint32_t pc = 0;                 // of the latest
    unsigned by_pc = 0;                   // how many of the latest were by that instruction
  };
  /// What a wait ended with.
  struct WaitEnd {
    Transfer by;
    Point point = Point::kEnd;
    Picoseconds at = 0;
  };

  /// A wait whose place in the stream is not known yet.
  struct Wait {
    std::uint64_t began, seen, room_waits;
    WaitEnd end;
    /// Its end, as Step::asked.
    std::uint64_t asked() const { return seen - std::min(room_waits, seen); }
  };

  Outcome* outcome(Stream& s, std::uint64_t number) {
    if (number == kNone) return nullptr;
    Outcome& o = s.history[number % kHistory];
    return o.number == number ? &o : nullptr;
  }
  Pending& append(Stream& s, Picoseconds issued);
  Pending& append_step(Picoseconds at);
  void note_step(std::uint64_t room_waits, std::uint64_t asked);
  void note_sleep();
  void note_ends(Picoseconds at);
  void note_wait(std::uint64_t began, std::uint64_t seen, std::uint64_t room_waits, const WaitEnd& end);
  void place_waits(std::uint64_t asked = kNone);
  void place_wait_before(const MemRequest& r);
  void place_work_before(const MemRequest& r);
  void release_behind_latest(Stream& s, Pending& p, Picoseconds at, unsigned align);
  std::size_t interrupt_before(std::uint64_t woke) const;
  void submit_aside(const MemRequest& r);
  bool looks_in_a_loop(const MemRequest& r);
  std::uint64_t register_write() const;
  void submit_of_transfer(const MemRequest& r, bool to_sdram);
  void release_transfer(Pending& p, const TransferTrigger& by, Picoseconds ready);
  Transfer transfer_of(const TransferTrigger& by) const;
  void note_ram_waits(const Controller& c, const Controller::Elsewhere& of, const Burst& burst);
  void end_flight(const MemRequest& r);
  void release_core(Stream& s, Pending& p, const MemRequest& r);
  void release_in_program(Stream& s, Pending& p, std::uint64_t asked);
  void note_room(Stream& s, Pending& p, const MemRequest& r, const CoreState& now);
  void note_flag(const Load& load);
  std::uint64_t take_accesses(Record& r, bool with_room_waits, std::uint64_t from, std::uint64_t to);
  void take_looks(Record& r, std::uint64_t began, std::uint64_t seen);
  void release_line(Stream& s, Pending& p, Picoseconds at);
  void release_repeating(Stream& s, Pending& p, Picoseconds at);
  void release_by_data(Stream& s, Pending& p, Picoseconds at);
  const Outcome* latest_done(Stream& s, Picoseconds at);
  bool write_up_to(std::uint8_t index, std::uint64_t number);
  std::uint64_t place_of(std::uint8_t index, std::uint64_t number);
  void list_interrupts(TraceInfo& info);
  void begin(Picoseconds start);
  void drop_early(Stream& s);
  void write_out(Stream& s, unsigned index, std::size_t keep);
  void write_one(Stream& s, unsigned index);

  std::vector<MasterSetup> masters_;
  std::array<unsigned, kMasterCount> stream_of_{};
  std::uint32_t of_transfers_ = 0;  // masters, one bit each
  std::vector<Stream> streams_;
  std::array<std::vector<Flight>, kMasterCount> flights_;
  std::function<CoreState(const MemRequest*)> core_;
  // A store that is put into its buffer before a read may go out after it; no more than the buffers
  // hold do so.
  static constexpr std::size_t kSteps = 32;
  std::array<Step, kSteps> steps_{};  // in the order in which they went out
  std::size_t next_step_ = 0;
  std::deque<Buffered> bursts_;          // the last ones, no more than fill the buffer
  std::uint64_t last_victim_ = kNone;
  CoreState core_before_;
  std::uint64_t room_waits_at_open_ = 0;
  bool register_access_ = false;  // of the core since its last request here, or it is one
  Clock clock_;
  StreamInfo core_info_;
  Picoseconds core_until_ = 0;  // when its last record went out
  unsigned align_;
  bool phase_known_ = false;
  struct Risen {
    Picoseconds at;
    TransferTrigger by;
    Picoseconds pulsed;  // 0: not by a completion code
    bool rose = true;    // false: its transfer ended while the interrupt of another one was pending
  };
  std::vector<Risen> interrupts_;
  Surroundings surroundings_;
  Clock scr_;
  Picoseconds scr_start_ = 0;
  std::array<Controller, kTransferControllers> controllers_{};
  std::deque<const MemRequest*> posted_;  // buffered writes to registers under way, oldest first
  const MemRequest* awaited_ = nullptr;   // the register access that the program waits for
  struct Written {
    Picoseconds at;
    std::uint64_t number;
  };
  /// Places of the core's records that transfers wait for; they may be written long before the transfers.
  std::map<std::uint64_t, std::uint64_t> places_;
  std::deque<Written> triggers_;          // the last of the core's writes that set one, by the record of it
  TransferTrigger code_, pulse_;          // what set the last completion code; what caused the last interrupt by one
  Picoseconds pulsed_at_ = 0;
  bool code_seen_ = true;
  std::deque<TransferTrigger> ended_;     // of the latest codes, those since the core's latest register access
  std::array<Flag, 32> flags_{};
  std::size_t next_flag_ = 0;
  std::array<std::uint32_t, 16> pollers_{};  // instructions that have looked at a word again and again; 0: none
  std::size_t next_poller_ = 0;
  Looks ram_looks_, register_looks_;
  std::deque<Wait> waits_;
  /// An access of the core to internal RAM, in clocks of the recording.
  struct RamAccess {
    std::uint64_t clock, waited, room_waits;
    std::uint32_t pc;
    std::uint8_t bank;
    /// Place in the program, as Step::asked; or the clock.
    std::uint64_t place(bool with_room_waits) const { return with_room_waits ? clock : clock - room_waits; }
  };
  std::deque<RamAccess> accesses_;        // that no record has yet
  struct {
    std::uint32_t after = 0, clocks = 0;
    std::uint8_t bank = 0;
  } looks_;                               // of the latest loop that looked at a word in vain
  std::uint64_t core_origin_ = 0;
  std::uint32_t not_followed_ = 0;        // masters, one bit each, some of whose records keep their times
  bool open_ = false, delayed_ = false;  // delayed_: to be opened when no transfer is under way
  Picoseconds start_ = 0, end_ = kNever;
  TraceWriter writer_;
};

}  // namespace fovea::trace
