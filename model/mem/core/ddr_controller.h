// TI's DDR2/mDDR controller (the family's scheduler) as a passive state machine: it is advanced to
// a time by whoever is entitled to, and never runs ahead of what may still arrive.
#pragma once
#include <array>
#include <cstdint>

#include "model/common/clock.h"
#include "model/common/masters.h"
#include "model/mem/core/backing_store.h"
#include "model/mem/core/ddr_params.h"
#include "model/mem/core/ddr_stats.h"
#include "model/mem/core/ddr_timing.h"

namespace fovea::mem {

/// One request as the crossbar hands it over. `address` is the byte offset in the SDRAM.
struct DdrRequest {
  void* cookie = nullptr;  ///< given back with the outcome
  Master master = Master::kArmD;
  std::uint8_t priority = 0;
  bool write = false;
  std::uint8_t bytes = 0;  ///< 1..64, inside one aligned 64-byte block
  std::uint32_t address = 0;
  std::uint32_t critical = 0;    ///< offset wanted first; the 16 bytes around it are read first
  std::uint8_t* data = nullptr;  ///< read: where to; write: copied when accepted
};

/// What the registers say (SDBCR, SDTIMR, SDTIMR2, SDRCR, PBBPR, DDRPHYCR), decoded.
struct DdrConfig {
  DdrTiming timing;
  unsigned read_latency = 5;         ///< DDRPHYCR.RL, clocks; CL is the floor
  unsigned refresh_interval = 1895;  ///< SDRCR.RR, clocks; 0: no refresh
  unsigned old_count = 0xFF;         ///< PBBPR.PR_OLD_COUNT; 0xFF: never
  unsigned page_log2 = 11;           ///< bytes of a row on the 16-bit bus
  bool bank_on_top = false;          ///< SDBCR.IBANK_POS: row stays in its bank
};

class DdrClient {
 public:
  virtual ~DdrClient() = default;
  /// The request waiting at the door was taken into the FIFOs at `at`.
  virtual void ddr_accepted(void* cookie, Picoseconds at) = 0;
  /// A read's data is on the crossbar from `first` (its first 8 bytes) to `last`; both lie ahead.
  /// Called with its first column command: from there on nothing interrupts the burst.
  virtual void ddr_read_done(void* cookie, Picoseconds first, Picoseconds last) = 0;
};

class DdrController {
 public:
  DdrController(const DdrParams& params, BackingStore& store, DdrClient& client);

  void set_clocks(Frequency ddr, Frequency scr, Picoseconds at);
  /// New timing from the registers; takes effect for commands after the call's time.
  void configure(const DdrConfig& config, Picoseconds at);
  bool running() const { return ddr_.running() && scr_.running(); }

  /// Catches up the refreshes done while nothing was queued, up to `at`. They change nothing that a
  /// master can see before its next request; whoever reads the statistics calls this first.
  void catch_up(Picoseconds at);

  /// A request arrives at time `at`; true: taken at once. False: it waits at the door until
  /// ddr_accepted; the caller sends no other one before.
  bool submit(const DdrRequest& request, Picoseconds at);

  /// Time of the next DRAM command, kNever if nothing is queued. Depends only on arrivals strictly
  /// before it.
  Picoseconds next_decision() const { return next_; }
  const Picoseconds* next_decision_place() const { return &next_; }
  void step();

  DdrStats stats;
  std::uint64_t busy_clocks() const { return stats.bursts.count() * DdrTiming::kBurstClocks; }
  const DdrDevice& device() const { return device_; }
  const Clock& ddr_clock() const { return ddr_; }
  /// Called with each DRAM command, for checkers and traces. Null in production.
  using CommandHook = void (*)(void* self, Cmd, unsigned bank, std::uint32_t row,
                               std::uint64_t clock);
  void set_command_hook(CommandHook hook, void* self) {
    hook_ = hook;
    hook_self_ = self;
  }

 private:
  static constexpr std::size_t kMaxEntries = 16;
  static constexpr std::uint64_t kNoClock = ~std::uint64_t{0};
  struct Entry {
    DdrRequest request;
    std::uint64_t ready = 0;  // first edge at which the scheduler sees it
    std::uint32_t row = 0;
    std::uint8_t bank = 0;
    std::uint8_t chunks = 0, issued = 0;  // column commands: needed, given
    bool classified = false;
    std::array<std::uint8_t, 64> data;
  };
  struct Choice {
    int slot = -1;  // kRefresh: not for a request
    Cmd cmd = Cmd::kAct;
    std::uint64_t at = 0;
  };
  static constexpr int kRefresh = -2;

  void take(const DdrRequest& request, std::uint64_t arrived);
  void plan();
  Choice choose(std::uint64_t edge, std::size_t ready) const;
  Choice choose_refresh(std::uint64_t edge) const;
  enum class Urgency { kMay, kNeed, kMust };
  Urgency refresh_urgency(std::uint64_t edge) const;
  Cmd needed(const Entry& e) const;
  std::uint64_t earliest(const Entry& e, Cmd cmd, std::uint64_t edge) const;
  bool passes_older(std::size_t i) const;
  void refresh_while_idle(std::uint64_t until);
  void count_owed(std::uint64_t clock);
  void issue(Cmd cmd, unsigned bank, std::uint32_t row, std::uint64_t clock);
  void issue_refresh(std::uint64_t clock);
  void column(std::size_t slot, std::uint64_t clock);
  void finish(std::size_t slot, std::uint64_t clock);
  void answer_read(const Entry& e, std::uint64_t clock);

  const DdrParams& params_;
  BackingStore& store_;
  DdrClient& client_;
  Clock ddr_, scr_;
  DdrDevice device_;
  DdrConfig config_;
  unsigned bank_shift_ = 11, row_shift_ = 14;

  // Configuration copied out of the parameters once: read in the hot path.
  std::size_t fifo_entries_;
  unsigned write_fifo_bytes_, read_fifo_bytes_, request_latency_, return_latency_;
  unsigned need_, must_, gap_limit_;

  std::array<Entry, kMaxEntries> slots_;
  std::array<std::uint8_t, kMaxEntries> order_{};  // slots in use, oldest first
  std::uint32_t free_slots_ = (1u << kMaxEntries) - 1;
  std::size_t count_ = 0;
  std::uint64_t last_arrival_ = 0;
  unsigned write_bytes_held_ = 0;
  bool door_full_ = false;
  DdrRequest door_;
  std::uint64_t door_arrived_ = 0;

  std::uint64_t command_free_ = 0;  // edge after the last command
  Choice choice_;
  Picoseconds next_ = kNever;
  int in_service_ = -1;  // slot whose columns are being issued
  std::uint64_t served_while_oldest_ = 0;

  std::uint64_t next_expiry_ = 0;  // edge at which the refresh interval runs out next
  unsigned owed_ = 0, forced_ = 0;
  unsigned gap_ = 0;  // intervals that ended since the last REF
  std::uint64_t idle_since_ = 0;
  std::uint64_t lane_free_ = 0;  // first free crossbar edge of the read return lane
  std::uint64_t start_of_lane_ = 0;
  std::uint64_t read_room_ = 0;  // first clock at which the read FIFO has room
  std::uint64_t floor_ = 0;      // no command before this edge: configuration changed there

  CommandHook hook_ = nullptr;
  void* hook_self_ = nullptr;
};

}  // namespace fovea::mem
