// Makes a bus trace of what passes the crossbar: derives from times and outcomes what released each
// request. The rules and their reasons: model/decisions/0006-trace.md.
#pragma once
#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "model/common/clock.h"
#include "model/common/masters.h"
#include "model/common/mem_observer.h"
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
};

/// The core's write buffer (ARM DDI 0198D ch. 6).
inline constexpr unsigned kBufferedStores = 4, kBufferedWords = 16;

class BusRecorder : public MemObserver {
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
              std::function<CoreState(const MemRequest*)> core);

  /// Recording covers [start, end): requests put on their port in it. The clock is the core's.
  void open(Picoseconds start, Frequency core_clock, Picoseconds core_clock_start);
  void close(Picoseconds end);
  /// An interrupt line of the core rises.
  void interrupt(Picoseconds at) { interrupts_.push_back(at); }
  /// The program shows a phase.
  void mark(std::uint32_t value, Picoseconds at);

  void submitted(const MemRequest& r, bool to_sdram) override;
  void responded(const MemRequest& r) override;

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
    std::uint64_t event = kNone;      // kWhen of another stream: number of the record there
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
  };
  /// A request of the core whose place in the program is known.
  struct Step {
    std::uint64_t number = kNone, asked = 0, room_waits = 0;
    bool write = false;
    bool blocking = false;  // the program waits for its end
  };
  /// A burst from the write buffer.
  struct Burst {
    std::uint64_t number, asked;
    unsigned words;
  };
  struct Flight {
    const MemRequest* request;
    std::uint64_t number;
  };

  Outcome* outcome(Stream& s, std::uint64_t number) {
    if (number == kNone) return nullptr;
    Outcome& o = s.history[number % kHistory];
    return o.number == number ? &o : nullptr;
  }
  Pending& append(Stream& s, Picoseconds issued);
  void release_core(Stream& s, Pending& p, const MemRequest& r);
  void release_in_program(Stream& s, Pending& p, std::uint64_t asked);
  void note_room(Stream& s, Pending& p, const MemRequest& r, const CoreState& now);
  void release_line(Stream& s, Pending& p, Picoseconds at);
  void release_repeating(Stream& s, Pending& p, Picoseconds at);
  void release_by_data(Stream& s, Pending& p, Picoseconds at);
  const Outcome* latest_done(Stream& s, Picoseconds at);
  bool write_up_to(std::uint8_t index, std::uint64_t number);
  void drop_early(Stream& s);
  void write_out(Stream& s, unsigned index, std::size_t keep);
  void write_one(Stream& s, unsigned index);

  std::vector<MasterSetup> masters_;
  std::array<unsigned, kMasterCount> stream_of_{};
  std::vector<Stream> streams_;
  std::array<std::vector<Flight>, kMasterCount> flights_;
  std::function<CoreState(const MemRequest*)> core_;
  // A store that is put into its buffer before a read may go out after it; no more than the buffers
  // hold do so.
  static constexpr std::size_t kSteps = 32;
  std::array<Step, kSteps> steps_{};  // in the order in which they went out
  std::size_t next_step_ = 0;
  std::deque<Burst> bursts_;          // the last ones, no more than fill the buffer
  std::uint64_t last_victim_ = kNone;
  CoreState core_before_;
  std::uint64_t room_waits_at_open_ = 0;
  bool register_access_ = false;  // of the core since its last request here
  Clock clock_;
  StreamInfo core_info_;
  unsigned align_;
  bool phase_known_ = false;
  std::vector<Picoseconds> interrupts_;
  bool open_ = false;
  Picoseconds start_ = 0, end_ = kNever;
  TraceWriter writer_;
};

}  // namespace fovea::trace
