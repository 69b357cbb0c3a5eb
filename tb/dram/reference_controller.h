// The DDR controller once more, as an oracle: a slow, stepwise scheduler that keeps nothing but its
// queue and the list of commands given, and derives every answer from them when asked. It shares no
// header with model/mem; the rules are those of SPRU986B and SPRUH82C ch. 14 and the
// relations of JESD79-2.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "model/common/clock.h"

namespace fovea::dram {

/// Number of address bits of a power of two.
inline unsigned log2_of(std::uint64_t n) {
  unsigned bits = 0;
  while (n > 1) n /= 2, ++bits;
  return bits;
}

struct ReferenceConfig {
  // clocks
  unsigned CL = 5, tRFC = 31, tRP = 5, tRCD = 5, tWR = 4, tRAS = 11, tRC = 16, tRRD = 3, tWTR = 3;
  unsigned tRTP = 2;
  unsigned banks = 8, page_log2 = 11, read_latency = 5;
  unsigned refresh_interval = 1895;  ///< 0: none
  unsigned old_count = 0xFF;         ///< 0xFF: never
  bool bank_on_top = false;
  bool mobile = false;
  unsigned tXP = 3, tXSNR = 34, tXSRD = 200, tCKE = 3;
  enum class Sleep { kNever, kSelfRefresh, kPowerDown, kClockStop } sleep = Sleep::kNever;
  unsigned row_intervals = 16;  ///< refresh intervals that a row may be open
  unsigned refreshed_log2 = 0;  ///< self-refresh keeps the first 1/2^n of the array, n <= 4
};

/// What the silicon fixes.
struct ReferenceLimits {
  unsigned command_fifo = 7, write_fifo = 88, read_fifo = 136;  // entries, bytes, bytes
  unsigned request_latency = 8, return_latency = 2;             // DDR clocks
  unsigned release = 3, need = 7, must = 11, gap = 7;           // refresh intervals
  unsigned clock_restart = 1;                                   // DDR clocks
  Picoseconds retention = 64'000'000'000;                       // without refresh
  std::uint64_t size = 128u << 20;
  enum class Order { kTi, kFcfs, kFrFcfs, kClosedPage } order = Order::kTi;
  bool ready_rows_first = false;  // kTi, kClosedPage: an open row counts when its column is legal
};

struct ReferenceRequest {
  std::size_t id = 0;
  unsigned master = 0, priority = 0;
  bool write = false;
  unsigned bytes = 0;
  std::uint32_t address = 0;
};

class ReferenceController {
 public:
  enum class Kind : std::uint8_t {
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
  struct Given {
    Kind kind;
    unsigned bank;
    std::uint32_t row;
    std::uint64_t clock;
    std::size_t config;        // in force then: it decides what the command puts off
    std::uint64_t closes = 0;  // kRda, kWra: clock of the precharge that the part gives itself
  };
  struct Read {
    std::size_t id;
    Picoseconds first, last;
  };
  struct Accepted {
    std::size_t id;
    Picoseconds at;
    unsigned unblocked_by;  // master of the request that made room
  };

  /// Starts with the defaults of ReferenceConfig.
  explicit ReferenceController(const ReferenceLimits& limits);
  void set_clocks(Frequency ddr, Frequency scr, Picoseconds at);
  void configure(const ReferenceConfig& config, Picoseconds at);
  bool submit(const ReferenceRequest& request, Picoseconds at);
  /// Time of the next command for a request or an urgent refresh; kNever if nothing is queued.
  Picoseconds next() const;
  void step();
  /// Refreshes of an idle controller up to `at`.
  void idle_until(Picoseconds at);
  void idle_while_empty(std::uint64_t end);

  // What it did.
  std::vector<Given> commands;
  std::vector<Read> reads;
  std::vector<Accepted> accepted;  // from the input register
  std::uint64_t hits = 0, misses = 0, conflicts = 0;
  std::uint64_t count(Kind kind) const;
  /// Clocks with a row open, asleep with a row open, in power-down, in self-refresh, and of these
  /// with the memory's clock standing, up to `at`.
  std::array<std::uint64_t, 5> residency(Picoseconds at) const;
  /// How often the part has lost what stood at this address.
  unsigned losses(std::uint32_t address) const;

 private:
  struct Queued {
    ReferenceRequest request;
    std::uint64_t ready;
    unsigned columns_given = 0;
    bool classified = false;
  };
  /// A read from its arrival on, with its own data's edges once they are known.
  struct Unanswered {
    std::size_t id;
    unsigned master;
    bool has_data = false;
    Picoseconds first = 0;
    std::uint64_t edges = 0;  // from the first to the last
  };
  struct Plan {
    Kind kind;
    std::uint64_t clock;
    std::optional<std::size_t> of;  // place in queue_; none: refresh, or PRE of an overdue row
    unsigned bank = 0;              // of that row
  };
  enum class Refresh { kMay, kNeed, kMust };

  const ReferenceConfig& config() const { return configs_.back(); }
  unsigned bank_of(const ReferenceRequest& r) const { return bank_of(r.address); }
  std::uint32_t row_of(const ReferenceRequest& r) const { return row_of(r.address); }
  unsigned bank_of(std::uint32_t address) const;
  std::uint32_t row_of(std::uint32_t address) const;
  static unsigned columns_of(const ReferenceRequest& r);
  std::optional<std::uint32_t> open_row(unsigned bank) const;
  bool all_closed() const;
  std::uint64_t legal_from(Kind kind, unsigned bank, std::uint64_t not_before) const;
  unsigned apart(const Given& before, Kind kind, unsigned bank) const;
  bool offered(std::size_t place) const;
  Kind wanted(const Queued& q) const;
  Plan plan() const;
  Plan plan_at(std::uint64_t edge) const;
  Plan refresh_at(std::uint64_t edge) const;
  std::uint64_t due_at(unsigned bank) const;
  std::optional<Plan> overdue_at(std::uint64_t edge) const;
  Refresh refresh_level(std::uint64_t edge) const;
  std::uint64_t clock_after_last() const;
  void expire(std::uint64_t clock);
  void give(Kind kind, unsigned bank, std::uint32_t row, std::uint64_t clock);
  void refresh_cycle(Kind kind, std::uint64_t clock);
  std::uint64_t awake_from(Kind kind, std::uint64_t clock) const;
  void idle_at(std::uint64_t clock);
  bool may_sleep(std::uint64_t clock) const;
  void wake(std::uint64_t clock);
  void answer(const ReferenceRequest& r, std::uint64_t clock);
  void hand_out(const ReferenceRequest& r, std::uint64_t start, std::uint64_t end);
  void enter(const ReferenceRequest& r, std::uint64_t arrived);
  void leave(std::size_t place, std::uint64_t clock);
  bool fits(const ReferenceRequest& r) const;

  ReferenceLimits limits_;
  std::vector<ReferenceConfig> configs_;
  Clock ddr_, scr_;
  std::vector<Queued> queue_;  // oldest first
  std::vector<Unanswered> unanswered_;         // in the order of their arrival; kFrFcfs
  std::vector<Picoseconds> handed_out_until_;  // by master
  std::optional<ReferenceRequest> input_;
  std::uint64_t input_arrived_ = 0, last_arrival_ = 0;
  std::uint64_t not_before_ = 0;  // the last change of clocks or configuration
  std::uint64_t passed_ = 0;      // transfers served while the oldest request waited
  std::uint64_t expiry_ = 0;         // the interval counter runs out then
  std::uint64_t backlog_ = 0, since_refresh_ = 0;
  std::uint64_t series_ = 0;         // REFR that are still to come of four
  bool cycle_begun_ = false;         // its DCAB is given, its REFR not yet
  bool far_behind_ = false;          // the backlog was above `must`, and is above `release`
  std::vector<std::pair<bool, std::uint64_t>> clock_changes_;  // in self-refresh: stands, from when
  std::vector<unsigned> losses_;  // refreshed_log2 of each self-refresh that was too long
  Picoseconds asleep_at_ = 0;
  ReferenceConfig::Sleep asleep_ = ReferenceConfig::Sleep::kNever;
  std::uint64_t clock_runs_from_ = 0;  // again, after a stop
  std::uint64_t channel_free_ = 0, channel_start_ = 0, read_room_ = 0;
};

}  // namespace fovea::dram
