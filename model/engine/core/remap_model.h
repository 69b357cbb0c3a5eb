// The remap engine as a fast model: one job, from its acceptance to its end, with the requests of the RTL in its order
// and in its clocks. Structure and numbers are those of rtl/remap; what a clock does is computed without signals.
#pragma once
#include <array>
#include <cstdint>

#include "model/engine/core/address_generator.h"
#include "model/engine/core/engine_backend.h"
#include "model/engine/core/map_reader.h"
#include "model/engine/core/packer.h"
#include "model/engine/core/remap_job.h"
#include "model/engine/core/source_cache.h"

namespace fovea::engine {

/// How a job ended, and its counters.
struct JobEnd {
  bool refused = false, read_error = false, write_error = false, aborted = false;
  std::uint32_t clocks = 0, lines = 0, writes = 0, bad = 0;
};

/// Clocks are numbered; clock n ends with edge n, at which requests are taken and answers arrive. The model
/// works ahead of the present as far as no answer that is not known yet could change what it does. So after an
/// error, or an abort, it may have asked for a little more than the RTL.
class RemapModel {
 public:
  class Port {
   public:
    virtual ~Port() = default;
    virtual void issue(const Burst& burst, std::uint64_t clock) = 0;
  };
  static constexpr std::uint64_t kNoClock = ~std::uint64_t{0};

  explicit RemapModel(Port& port, Geometry geometry = {}) : port_(port), cache_(geometry) {}

  void reset();
  /// @param clock in which the engine, which must be idle, takes the job
  void start(const Job& job, std::uint64_t clock);
  bool idle() const { return state_ == State::kIdle; }
  const Job& job() const { return job_; }  ///< that was started last
  /// Ends the job early; no effect while there is none.
  void abort(std::uint64_t clock);
  /// Works on. @param safe no answer that is not known arrives before this clock
  /// @return the clock that has to be safe before it can go on; kNoClock: only an answer helps
  std::uint64_t run(std::uint64_t safe);
  /// Outcomes, in the order in which their beats arrive. @param beats the clock of each beat of 8 bytes
  void answer_map(bool error, std::span<const std::uint8_t> data, std::span<const std::uint64_t> beats);
  /// @param first, last the clocks of the line's first and last beat
  void answer_line(bool error, std::span<const std::uint8_t> data, std::uint64_t first, std::uint64_t last);
  void answer_write(bool error, std::uint64_t clock);
  /// The clock in which the job ended (done_o); kNoClock: it is under way.
  std::uint64_t done_at() const { return done_at_; }
  const JobEnd& end() const { return end_; }

 private:
  enum class State : std::uint8_t { kIdle, kBegin, kRun, kDrain };
  struct Arrival {
    std::uint64_t clock;
    bool error;
  };

  void begin();
  bool step();
  bool run_clock();
  void flow(std::uint64_t reads);
  template <bool kNearest>
  bool feed(bool room, bool may_ask, bool map_asked);
  bool fetch();
  template <bool kNearest>
  void blend_last();
  bool drain();
  bool arrivals(std::uint64_t clock) { return next_arrival_ <= clock && arrive(clock); }
  bool arrive(std::uint64_t clock);
  void note_read(bool error, std::uint64_t first, std::uint64_t last);
  void note_arrivals();
  bool pack();
  bool blend_words(bool taken);
  template <bool kNearest>
  bool tags(const Pair& pair, bool may_ask);
  bool ask(bool& map_asked);
  bool send();
  void send_burst();
  bool waits(std::uint64_t clock) const {
    return state_ == State::kRun ? waits_in_run(clock) : waits_in_drain(clock);
  }
  bool waits_in_run(std::uint64_t clock) const;
  bool wants_read() const { return cache_.wants_line() || (map_.empty() && addresses_.wants_map()); }
  bool waits_in_drain(std::uint64_t clock) const;
  std::uint64_t next_event() const;

  Port& port_;
  State state_ = State::kIdle;
  Job job_;
  JobEnd end_;
  std::uint64_t now_ = 0, accepted_ = 0, done_at_ = kNoClock;
  bool frozen_ = false;  // nothing moves until next_event()

  MapReader map_;
  AddressGenerator addresses_;
  SourceCache cache_;
  Packer packer_;
  unsigned which_ = 0;         // access of the pair at hand
  bool line_asked_ = false;    // the port has the request for a line
  std::uint32_t line_ = 0;     // its number
  // Between data and blending, and behind it.
  bool word_valid_ = false, blended_valid_ = false;
  std::uint32_t word_ = 0, blended_ = 0;
  CacheAccess access_;
  std::uint32_t blended_dst_ = 0;
  bool blended_last_ = false;
  std::array<std::uint32_t, 4> words_{};
  bool sending_ = false;       // packer_.out() is not issued yet
  // Requests without an answer, and arrivals that lie ahead: of the last beat of a read, of a write's answer.
  unsigned reads_ = 0;
  Ring<Arrival, 32> read_arrivals_;
  Ring<Arrival, 8> write_arrivals_;
  std::uint64_t next_arrival_ = kNoClock;  // the earliest of both
  // Answers come in order: what is not known arrives in these clocks at the earliest.
  std::uint64_t read_from_ = 0, write_from_ = 0;
  Ring<unsigned, 8> parts_;    // of each write under way, without an answer
  bool part_error_ = false;
};

}  // namespace fovea::engine
