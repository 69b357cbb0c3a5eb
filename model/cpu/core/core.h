// ARM926EJ-S: instructions, caches with data, MMU, write buffer and their time. Knows no SystemC.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "model/common/clock.h"
#include "model/cpu/core/bus_port.h"
#include "model/cpu/core/cache.h"
#include "model/cpu/core/instruction.h"
#include "model/cpu/core/params.h"
#include "model/cpu/core/stats.h"
#include "model/cpu/core/tlb.h"
#include "model/cpu/core/write_buffer.h"

namespace fovea::cpu {

enum class CpuMode : std::uint32_t {
  kUsr = 0x10, kFiq = 0x11, kIrq = 0x12, kSvc = 0x13, kAbt = 0x17, kUnd = 0x1B, kSys = 0x1F
};

/// One of the last data accesses, for messages about a failed guest.
struct AccessRecord {
  std::uint32_t pc = 0, address = 0;
  std::uint8_t bytes = 0;
  bool write = false;
};

/// Time is counted in core clocks (edge numbers of the core's clock) and becomes picoseconds only at
/// the bus. An instruction boundary at clock c has the time of edge c.
class Core : public Background {
 public:
  /// @param tcm the 32 KB RAM behind both TCM windows (0x0 and 0x10000), a power of two of bytes;
  ///   empty: a core without TCMs
  Core(const CpuParams& params, BusPort& port, std::span<std::uint8_t> tcm);

  void set_clock(Frequency f, Picoseconds at);
  /// Interrupt lines; a change at t is seen by instruction boundaries strictly after t.
  void set_irq(bool level, Picoseconds at) { irq_.set(level, at); attention_ = true; }
  void set_fiq(bool level, Picoseconds at) { fiq_.set(level, at); attention_ = true; }

  /// @param entry first instruction; bit 0 set means Thumb
  void reset(std::uint32_t entry, Picoseconds now);
  /// Runs until request_stop(); blocks inside BusPort calls. @throws GuestFailure
  void run();
  void request_stop() { stop_requested_ = true; attention_ = true; }

  // Background: the write and victim buffers on the D-AHB.
  Picoseconds next_act() const override;
  void act() override;

  /// Marks an edge of the measured window at time t: the core notes its counters at its first
  /// instruction boundary after t, or within a wait-for-interrupt at t exactly. First call: from,
  /// second: to.
  void mark_window(Picoseconds t);
  bool mark_done() const { return !mark_pending_; }
  const CoreStats& window_stats() const { return window_; }
  const Counts& counts() const { return counts_; }
  std::uint64_t instructions_executed() const { return counts_.instructions; }

  std::uint32_t reg(unsigned i) const { return i == 15 ? pc_ : r_[i]; }
  void set_reg(unsigned i, std::uint32_t v) { r_[i] = v; }
  std::uint32_t cpsr() const { return cpsr_; }
  /// The instruction being executed; after a guest failure, where its chain of exceptions began.
  std::uint32_t current_pc() const { return failing_ ? failed_pc_ : pc_; }
  std::uint64_t clock_count() const { return cycle_; }
  std::vector<AccessRecord> last_accesses() const;
  /// Test harness: sees every SWI first; true means it was handled. Empty in production.
  std::function<bool(Core&, std::uint32_t number)> swi_hook;
  /// Reads internal RAM, the D-cache and the buffers without any effect; false if the address is in
  /// none of them (memory has it then).
  bool peek(std::uint32_t address, std::uint8_t& byte) const;

 private:
  friend class CoreTest;
  friend class CoreDebug;
  static constexpr unsigned kPcDelayArm = 8;
  enum class Result : std::uint8_t { kOk, kAbort };
  struct Line {
    bool level = false, before = false;
    Picoseconds since = 0;
    void set(bool v, Picoseconds at) {
      if (at != since) before = level;
      level = v;
      since = at;
    }
    bool at(Picoseconds boundary) const { return since < boundary ? level : before; }
  };

  // execute.cpp
  void step_attention();
  void execute(const Instruction& i);
  void execute_rare(const Instruction& i);
  std::uint32_t offset(const Instruction& i) const;
  /// One function per operation, operand form and S bit (data_processing.cpp).
  using DataHandler = void (*)(Core&, const Instruction&);
  template <Op kOp, Operand kOperand, bool kSet>
  static void data_op(Core& c, const Instruction& i);
  template <std::size_t... k>
  static constexpr std::array<DataHandler, 128> make_data_handlers(std::index_sequence<k...>);
  static const std::array<DataHandler, 128> kDataHandlers;
  void data_processing(const Instruction& i) {
    kDataHandlers[static_cast<unsigned>(i.op) | static_cast<unsigned>(i.operand) << 4 |
                  (i.flags & kSetFlags) << 6](*this, i);
  }
  void multiply(const Instruction& i);
  void dsp(const Instruction& i);
  void load_store(const Instruction& i);
  void load_multiple(const Instruction& i);
  void store_multiple(const Instruction& i);
  void swap(const Instruction& i);
  void status(const Instruction& i);
  void branch_to(std::uint32_t target) { next_pc_ = target; branched_ = true; }
  void interwork(std::uint32_t target);
  void interlock(const Instruction& i);
  /// The result of an instruction whose issue ends now is usable `latency` clocks later.
  void produce(unsigned r, unsigned latency) {
    ready_[r] = cycle_ + latency;
    producer_[r] = Producer::kOther;
    busy_until_ = std::max(busy_until_, ready_[r] + 1);
  }
  void loaded(unsigned r, unsigned latency) {
    produce(r, latency);
    producer_[r] = Producer::kLoad;
  }
  void multiplied(unsigned r, unsigned latency) {
    produce(r, latency);
    producer_[r] = Producer::kMultiply;
  }
  void snapshot();
  bool mark_due(Picoseconds boundary) const { return mark_pending_ && boundary > mark_at_; }
  void spend(unsigned n) { cycle_ += n; counts_.issue += n; }

  // exceptions.cpp
  enum class Exception { kReset, kUndefined, kSwi, kPrefetchAbort, kDataAbort, kIrq, kFiq };
  void take(Exception e, std::uint32_t return_address);
  void data_abort();
  void undefined();
  void set_cpsr(std::uint32_t value);
  void switch_mode(std::uint32_t mode);
  static unsigned bank(std::uint32_t mode);
  bool privileged() const { return (cpsr_ & 31u) != 0x10u; }
  void unpredictable(const char* what);

  // cp15.cpp
  void coprocessor_move(const Instruction& i);
  bool cp15_read(std::uint32_t opc, std::uint32_t& value);
  bool cp15_write(std::uint32_t opc, std::uint32_t value);
  bool cache_operation(unsigned crm, unsigned op2, std::uint32_t value);
  void wait_for_interrupt();

  // memory.cpp
  const Instruction* fetch();
  const Instruction* fetch_slow();
  /// Hits in internal RAM or the D-cache, without alignment or permission to think about. False:
  /// nothing was done, load() or store() decide.
  template <unsigned kBytes>
  bool load_hit(std::uint32_t va, std::uint32_t& value, bool user);
  template <unsigned kBytes>
  bool store_hit(std::uint32_t va, std::uint32_t value, bool user);
  Result load(std::uint32_t va, unsigned bytes, std::uint32_t& value, bool user = false);
  Result store(std::uint32_t va, unsigned bytes, std::uint32_t value, bool user = false);
  Result store_words(std::uint32_t va, const std::uint32_t* words, unsigned count, bool user);
  bool in_tcm(std::uint32_t mva) const {
    return (mva < itcm_size_) || (mva - kDtcmBase < dtcm_size_);
  }
  std::uint8_t* tcm(std::uint32_t mva) { return tcm_.data() + (mva & (tcm_.size() - 1)); }
  std::uint32_t modified(std::uint32_t va) const {
    return va < 0x0200'0000u ? va | fcse_pid_ : va;
  }
  const Translation* translate(std::uint32_t mva, bool write, bool user, bool instruction);
  const Translation* translate_slow(std::uint32_t mva, bool write, bool user, bool instruction);
  std::uint32_t memo_key(std::uint32_t mva, bool user) const {
    return (mva >> 10) | (user || !privileged() ? 1u << 22 : 0u);
  }
  bool walk(std::uint32_t mva, bool instruction, TlbEntry& out);
  bool walk_read(std::uint32_t address, std::uint32_t& word);
  bool permitted(const Translation& t, bool write, bool user, unsigned& fault) const;
  void fault(bool instruction, unsigned status, unsigned domain, std::uint32_t address);
  /// Several words at an address that is not a word's: notes a fault if alignment is checked.
  bool misaligned(std::uint32_t va) {
    if (!(control_ & 2u) || !(va & 3u)) return false;
    fault(false, 0x1, 0, modified(va));
    return true;
  }
  int dcache_fill(std::uint32_t mva, std::uint32_t pa, bool write_back_line);
  void dcache_wait(std::uint32_t mva);
  bool uncached_read(std::uint32_t pa, unsigned bytes, std::uint32_t& value);
  bool unbuffered_write(std::uint32_t pa, unsigned bytes, std::uint32_t value);
  void icache_fill(std::uint32_t mva, std::uint32_t pa);
  void record(std::uint32_t va, unsigned bytes, bool write);

  // bus.cpp
  Picoseconds time(std::uint64_t cycle) const { return clock_.edge(cycle); }
  std::uint64_t ahb(std::uint64_t cycle) const { return (cycle + ratio_ - 1) / ratio_ * ratio_; }
  void stall_to(std::uint64_t cycle, Cause cause) {
    if (cycle > cycle_) {
      counts_.stall[static_cast<std::size_t>(cause)] += cycle - cycle_;
      cycle_ = cycle;
    }
  }
  void sync_to_ahb() { stall_to(ahb(cycle_), Cause::kBusSync); }
  void play(std::uint64_t cycle);
  std::uint64_t next_act_cycle() const;
  std::uint64_t write_over() const;
  void bus_read(BusAccess& a, Cause cause);
  void enqueue_write(std::uint32_t pa, const std::uint8_t* bytes, unsigned count);
  void finish_write(Cause cause);
  void retire_write();
  void drain(Cause cause);
  void start_write(std::uint64_t ahb_cycle);
  void write_back(unsigned index, Cause cause);

  static constexpr std::uint32_t kDtcmBase = 0x0001'0000;

  BusPort& port_;
  std::span<std::uint8_t> tcm_;
  Clock clock_;
  unsigned ratio_, fill_latency_, walk_cycles_, cache_op_cycles_, test_clean_cycles_,
      invalidate_all_cycles_, tcm_wait_;
  bool shifted_cycle_;

  // Registers.
  std::array<std::uint32_t, 16> r_{};
  std::uint32_t pc_ = 0, next_pc_ = 0;
  std::uint32_t cpsr_ = 0xD3;
  std::array<std::array<std::uint32_t, 7>, 6> banked_{};  // per bank: r13, r14, (r8..r12)
  std::array<std::uint32_t, 5> user_high_{};              // r8..r12 outside FIQ
  std::array<std::uint32_t, 5> fiq_high_{};
  std::array<std::uint32_t, 6> spsr_{};
  bool branched_ = false;

  // Time.
  std::uint64_t cycle_ = 0;
  std::uint64_t stop_cycle_ = 0;  // first clock that needs step_attention()
  bool attention_ = true;
  std::array<std::uint64_t, 16> ready_{};
  enum class Producer : std::uint8_t { kOther, kLoad, kMultiply };
  std::array<Producer, 16> producer_{};
  std::uint64_t busy_until_ = 0;

  // Fetch.
  std::uint32_t line_va_ = 1;               // line of the current records; 1: none
  std::uint32_t line_thumb_ = 0;
  unsigned line_shift_ = 2;                 // instruction size there, as a power of two
  struct DecodedLine {
    std::array<Instruction, 16> records;
    std::uint32_t valid = 0;                // bit per record
    bool thumb = false;
  };
  std::vector<DecodedLine> decoded_;        // one per I-cache line
  DecodedLine* current_line_ = nullptr;
  std::vector<DecodedLine> tcm_decoded_;
  Instruction uncached_record_;
  bool fetch_branched_ = false;
  std::uint32_t fetch_buffer_pa_ = 1, fetch_words_[4] = {};
  BusAccess fetch_access_;
  struct Fill {
    std::uint32_t line = 1;                 // MVA of the line under fill, 1: none
    std::uint32_t critical = 0;             // word that came first
    std::uint64_t first = 0, last = 0;      // clocks
    std::uint64_t word(std::uint32_t index) const {
      const std::uint32_t order = (index - critical) & 7u;
      return first + (last - first) * order / 7;
    }
  };
  Fill ifill_, dfill_;

  // Memory.
  Cache icache_, dcache_;
  Tlb tlb_;
  struct Memo {
    std::uint32_t page = 1;  // mva >> 10, or a number no page has
    Translation translation;
    bool read_ok = false, write_ok = false;
  };
  static constexpr unsigned kMemos = 64;
  std::array<Memo, kMemos> dmemo_{}, imemo_{};
  void flush_memos();
  Translation flat_;          // MMU off
  BusAccess data_access_;
  WriteBuffer writes_;
  BusAccess write_access_;
  bool write_in_flight_ = false;
  bool write_is_victim_ = false;
  mutable std::uint64_t write_over_ = 0;  // clock at which it can be retired; 0: not yet known
  static constexpr std::uint64_t kNoCycle = ~std::uint64_t{0};
  mutable std::uint64_t act_time_cycle_ = kNoCycle;  // next_act(): last clock and its time
  mutable Picoseconds act_time_ = 0;
  bool filling_ = false;             // the victim waits until the fill has read
  std::uint64_t next_write_cycle_ = 0;
  bool read_waiting_ = false;
  std::uint64_t data_port_free_ = 0;  // clock

  // CP15.
  std::uint32_t control_ = 0x0005'0078;
  std::uint32_t ttbr_ = 0, dacr_ = 0, dfsr_ = 0, ifsr_ = 0, far_ = 0;
  std::uint32_t fcse_pid_ = 0, context_id_ = 0;
  std::uint32_t dlock_ = 0, ilock_ = 0, tlb_lock_ = 0;
  std::uint32_t itcm_region_ = 0, dtcm_region_ = 0, debug_override_ = 0, cache_debug_ = 0;
  std::uint32_t itcm_size_ = 0, dtcm_size_ = 0;

  Line irq_, fiq_;
  bool stop_requested_ = false;
  bool swapping_ = false;             // the two accesses of an SWP are locked
  bool aborted_ = false;              // set by a failed access of this instruction
  bool mark_pending_ = false;
  bool first_mark_ = true;
  Picoseconds mark_at_ = 0, mark_next_ = kNever;  // the second may come before the first is taken
  unsigned chain_ = 0;                // exceptions since the last completed instruction
  bool failing_ = false;
  std::uint32_t failed_pc_ = 0;

  Counts counts_;
  CoreStats window_;
  std::array<AccessRecord, 8> ring_{};
  std::uint64_t ring_count_ = 0;
  const CpuParams& params_;
};

}  // namespace fovea::cpu
