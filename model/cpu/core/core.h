// The ARM926EJ-S: instructions, caches with data, MMU, write buffer, and their timing. No SystemC.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
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
#include "model/cpu/core/tcm_port.h"
#include "model/cpu/core/tlb.h"
#include "model/cpu/core/write_buffer.h"

namespace fovea::cpu {

class CoreControl;

enum class CpuMode : std::uint32_t {
  kUsr = 0x10, kFiq = 0x11, kIrq = 0x12, kSvc = 0x13, kAbt = 0x17, kUnd = 0x1B, kSys = 0x1F
};

/// One of the last data accesses, for messages about a guest failure.
struct AccessRecord {
  std::uint32_t pc = 0, address = 0;
  std::uint8_t bytes = 0;
  bool write = false;
};

/// The core counts time in clocks (edge numbers of its clock) and converts it into picoseconds only
/// for the bus. An instruction boundary at clock c has the time of edge c.
class Core : public Background {
 public:
  /// @param tcm the RAM of 32 KB that is visible through both TCM windows (0x0 and 0x10000); its
  ///        size is a power of two. Empty: a core without TCMs
  Core(const CpuParams& params, BusPort& port, std::span<std::uint8_t> tcm);

  void set_clock(Frequency f, Picoseconds at);
  /// Sets an interrupt line. A change at t is visible to instruction boundaries strictly after t.
  void set_irq(bool level, Picoseconds at) { irq_.set(level, at); attention_ = true; }
  void set_fiq(bool level, Picoseconds at) { fiq_.set(level, at); attention_ = true; }

  /// Returns to the state after power-up; accesses under way must have ended. General registers,
  /// internal RAM and all counters are kept.
  /// @param entry address of the first instruction; bit 0 selects the Thumb state
  void reset(std::uint32_t entry, Picoseconds now);
  /// The same at the end of a reset. The clocks that have passed since it began count as idle.
  void restart(std::uint32_t entry, Picoseconds now);
  /// Sets the reset line. Like an interrupt, a change at t is visible to instruction boundaries
  /// strictly after t. There run() ends, and held() is true until the next reset().
  void set_reset(bool level, Picoseconds at) { reset_.set(level, at); attention_ = true; }
  bool held() const { return held_; }
  /// Runs until request_stop() or a reset, blocking inside calls of BusPort. @throws GuestFailure
  void run();
  void request_stop() { stop_requested_ = true; attention_ = true; }

  // Background: the write and victim buffers on the D-AHB.
  Picoseconds next_act() const final { return read_waiting_ ? kNever : time_of_next_act(); }
  void act() final;
  /// Number of BusAccess objects that the core owns.
  static constexpr std::size_t kAccesses = 3;

  /// Marks the start (first call) or end (second call) of the measurement window at time t. The
  /// core copies its counters at its first instruction boundary after t, or exactly at t during a
  /// wait for interrupt.
  void mark_window(Picoseconds t);
  bool mark_done() const { return !mark_pending_; }
  const CoreStats& window_stats() const { return window_; }
  const Counts& counts() const { return counts_; }
  const Clock& clock() const { return clock_; }
  /// Clocks that the core waited for room in the write and victim buffers, and how often it waited
  /// until both were empty; for a recorder of bus traffic.
  std::uint64_t room_waits() const { return room_waits_; }
  std::uint64_t drains() const { return drains_; }
  /// The counters as of time t, for a core that waits for an interrupt until then.
  Counts counts_asleep(Picoseconds t) const;
  /// Names for the addresses in the stall statistics; must be set before the first instruction.
  void set_regions(RegionMap regions) { regions_ = std::move(regions); }
  const RegionMap& regions() const { return regions_; }
  std::uint64_t instructions_executed() const { return counts_.instructions; }

  std::uint32_t reg(unsigned i) const { return i == 15 ? pc_ : r_[i]; }
  void set_reg(unsigned i, std::uint32_t v) { r_[i] = v; }
  std::uint32_t cpsr() const { return flags_live_ ? packed_cpsr() : cpsr_; }
  /// Address of the instruction that is executed; after a guest failure, of the one that began the
  /// chain of exceptions.
  std::uint32_t current_pc() const { return failing_ ? failed_pc_ : pc_; }
  std::uint64_t clock_count() const { return cycle_; }
  /// Time of the last instruction boundary; may be ahead of the other agents' time.
  Picoseconds boundary_time() const { return time(cycle_); }
  std::vector<AccessRecord> last_accesses() const;
  /// Core clocks that each access to internal RAM takes beyond its first one, from now on.
  void set_tcm_wait_states(unsigned clocks) {
    tcm_wait_ = clocks;
    flush_memos();
  }
  /// For test programs: called for every SWI first; returns true if it has handled it. Otherwise
  /// empty.
  std::function<bool(Core&, std::uint32_t number)> swi_hook;
  /// For messages: returns "name+0x12" for an address, or "" if it has no name. May be empty.
  std::function<std::string(std::uint32_t)> describe;
  /// The DMA port of internal RAM, used by model/cpu/tcm_dma.h. A burst arrives at `at`; its data
  /// are moved at tcm_burst_over(), a time that accesses of the core may postpone until then.
  void tcm_burst_begins(const TcmPort::Burst& burst, Picoseconds at);
  Picoseconds tcm_burst_over() const { return time(tcm_port_.end() - 1); }
  void tcm_burst_ends(bool write, std::uint8_t* data);
  const TcmPort& tcm_port() const { return tcm_port_; }
  /// Reads internal RAM, the D-cache and the buffers without side effects. Returns false if none of
  /// them holds the address, so that memory has the current value.
  bool peek(std::uint32_t address, std::uint8_t& byte) const;

 private:
  friend class CoreTest;
  friend class CoreDebug;
  friend class CoreControl;
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

  /// The handlers of decoded records (handlers.h).
  struct Ops;

  // execute.cpp
  void step_attention();
  std::uint64_t let_others_act(std::uint64_t cycle);
  void await_clock();
  void execute_alone(const Instruction& i);
  void enter_exception();
  void end_old_fetch();
  [[gnu::noinline]] void execute_one(const Instruction& i);
  bool chain_goes_on(const Instruction* next) const;
  void execute(const Instruction& i);
  void execute_rare(const Instruction& i);
  std::uint32_t offset(const Instruction& i) const;
  void data_processing(const Instruction& i);
  void dsp(const Instruction& i);
  void load_store(const Instruction& i);
  void load_multiple(const Instruction& i);
  void store_multiple(const Instruction& i);
  void swap(const Instruction& i);
  void status(const Instruction& i);
  void branch_to(std::uint32_t target) {
    next_pc_ = target;
    branched_ = true;
    jumped_from_ = pc_;
    jumped_to_ = target;
    ++counts_.redirects;
  }
  void interwork(std::uint32_t target);
  void interlock(const Instruction& i);
  std::uint64_t operands_ready(const Instruction& i, std::uint64_t cycle) const;
  enum Producer : std::uint8_t { kOther, kLoad, kMultiply };
  /// The result of an instruction whose issue ends now can be used `latency` clocks later.
  void produce(unsigned r, unsigned latency) { produced(r, cycle_ + latency, kOther); }
  void loaded(unsigned r, unsigned latency) { produced(r, cycle_ + latency, kLoad); }
  void multiplied(unsigned r, unsigned latency) { produced(r, cycle_ + latency, kMultiply); }
  /// Latencies are at most two clocks and each instruction takes at least one, so a younger result
  /// is never available before an older one.
  void produced(unsigned r, std::uint64_t ready, Producer by) {
    ready_[r] = ready << 2 | by;
    busy_until_ = ready;
  }
  /// N, Z, C and V are kept in members of their own while run() is active. Code that needs them in
  /// the CPSR calls pack_flags() first, and unpack_flags() after any change of the CPSR.
  std::uint32_t packed_cpsr() const {
    return (cpsr_ & 0x0FFF'FFFFu) | (n_ & 1u << 31) | (z_ ? 0 : 1u << 30) |
           std::uint32_t{c_} << 29 | std::uint32_t{v_} << 28;
  }
  void pack_flags() { cpsr_ = packed_cpsr(); }
  void unpack_flags() {
    n_ = cpsr_;
    z_ = ~cpsr_ & 1u << 30;
    c_ = cpsr_ >> 29 & 1u;
    v_ = cpsr_ >> 28 & 1u;
  }
  /// Adds what a chain of records did before record `i` to the counters, and sets pc_ and cycle_.
  void settle(const Instruction* i, std::uint64_t cycle) {
    pc_ = run_va_ + i->at;
    counts_.issue += cycle - cycle_;
    cycle_ = cycle;
    const auto at = reinterpret_cast<std::intptr_t>(i);
    counts_.instructions += static_cast<std::uint64_t>(
        (at - run_first_) / static_cast<std::intptr_t>(sizeof(Instruction)));
    run_first_ = at;
  }
  void snapshot();
  bool mark_due(Picoseconds boundary) const { return mark_pending_ && boundary > mark_at_; }
  void spend(unsigned n) { cycle_ += n; counts_.issue += n; }

  // exceptions.cpp
  void reset_coprocessor();
  void forget_accesses();
  enum class Exception { kReset, kUndefined, kSwi, kPrefetchAbort, kDataAbort, kIrq, kFiq };
  void take(Exception e, std::uint32_t return_address);
  void data_abort(unsigned left);
  void undefined();
  void set_cpsr(std::uint32_t value);
  void switch_mode(std::uint32_t mode);
  static unsigned bank(std::uint32_t mode);
  bool privileged() const { return (cpsr_ & 31u) != 0x10u; }
  void unpredictable(const char* what);
  std::string address_text(std::uint32_t address) const;

  // cp15.cpp
  void coprocessor_move(const Instruction& i);
  void begin_old_fetch();
  bool cp15_read(std::uint32_t opc, std::uint32_t& value);
  bool cp15_write(std::uint32_t opc, std::uint32_t value);
  bool cache_operation(unsigned crm, unsigned op2, std::uint32_t value);
  void wait_for_interrupt();

  // prepare.cpp
  struct DecodedLine;
  /// What the neighbours in a line allow a record to leave out. The default is correct anywhere.
  struct Context {
    enum class Check : std::uint8_t { kNone, kYoungest, kAll } check = Check::kAll;
    bool track = true;    // a later record may have to wait for its result
    bool in_line = false;  // the record belongs to a line that holds all its records
  };
  void prepare(Instruction& i, unsigned at, Context context) const;
  static void clear_line(DecodedLine& d, bool thumb);
  static Instruction decode_at(const std::uint8_t* bytes, unsigned index, bool thumb);
  static Context record_context(const DecodedLine& d, unsigned index, const std::uint8_t* bytes,
                           bool thumb);

  // tcm.cpp
  void tcm_access(std::uint32_t pa, TcmPort::Side side);
  /// True if accesses to internal RAM cost no extra clocks and no DMA can interfere.
  bool tcm_quick() const {
    return (tcm_wait_ | tcm_own_conflict_) == 0 && !tcm_port_.busy();
  }
  std::uint32_t tcm_offset(std::uint32_t pa) const {
    return pa & static_cast<std::uint32_t>(tcm_.size() - 1);
  }
  bool code_shares_bank(std::uint32_t offset) const;

  // memory.cpp
  const Instruction* fetch();
  const Instruction* fetch_slow();
  template <unsigned kBytes>
  [[gnu::noinline]] bool store_beside_cache(std::uint32_t va, std::uint32_t value);
  template <unsigned kBytes>
  [[gnu::noinline]] void store_absent(std::uint32_t va, std::uint32_t pa, std::uint32_t value);
  template <unsigned kBytes>
  [[gnu::noinline]] const std::uint8_t* load_cached(std::uint32_t va);
  const std::uint8_t* load_line(std::uint32_t va, std::uint32_t mva, const Translation& t);
  Result load(std::uint32_t va, unsigned bytes, std::uint32_t& value, bool user = false);
  Result store(std::uint32_t va, unsigned bytes, std::uint32_t value, bool user = false);
  Result store_words(std::uint32_t va, const std::uint32_t* words, unsigned count, bool user);
  /// The physical address selects internal RAM (model/decisions/0008-internal-ram.md). Data
  /// accesses reach it through both windows, instruction fetches only through that of the
  /// instruction TCM.
  bool in_itcm(std::uint32_t pa) const { return pa < itcm_size_; }
  bool in_dtcm(std::uint32_t pa) const { return pa - kDtcmBase < dtcm_size_; }
  bool in_tcm(std::uint32_t pa) const { return in_itcm(pa) || in_dtcm(pa); }
  std::uint8_t* tcm(std::uint32_t pa) { return tcm_.data() + tcm_offset(pa); }
  DecodedLine& tcm_decoded(std::uint32_t pa) { return tcm_decoded_[tcm_offset(pa) >> 5]; }
  std::uint32_t modified(std::uint32_t va) const {
    return va < 0x0200'0000u ? va | process_ : va;
  }
  /// Modified virtual address of an instruction.
  std::uint32_t fetched_at(std::uint32_t va) const {
    return va < 0x0200'0000u ? va | fetch_process_ : va;
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
  void external_abort_at(std::uint32_t last);
  /// For an access of several words: records a fault if the address is not a word's and alignment
  /// is checked.
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
  void record(std::uint32_t pc, std::uint32_t va, std::uint32_t what) {
    auto* const a = reinterpret_cast<Access*>(reinterpret_cast<char*>(ring_.data()) + ring_at_);
    ring_at_ = static_cast<std::uint8_t>(ring_at_ + sizeof(Access));
    a->pc = pc;
    a->address = va;
    a->what = what;
  }

  // bus.cpp
  Picoseconds time(std::uint64_t cycle) const { return clock_.edge(cycle); }
  std::uint64_t ahb(std::uint64_t cycle) const {
    const std::uint64_t n = cycle + ratio_ - 1;
    return ahb_mask_ ? n & ahb_mask_ : n / ratio_ * ratio_;
  }
  /// Stalls the core for a reason without an address, with the core itself as culprit.
  void stall_to(std::uint64_t cycle, Cause cause) {
    if (cycle > cycle_) {
      counts_.stall[index(cause)] += cycle - cycle_;
      if (cause != Cause::kInterlock)
        counts_.stalls.add(cause, RegionMap::kNone, kCore, cycle - cycle_);
      cycle_ = cycle;
    }
  }
  /// Stalls the core for an access to a physical address. The culprit is one of kStallCulprits.
  void stall_to(std::uint64_t cycle, Cause cause, std::uint32_t pa, std::size_t culprit) {
    if (cycle > cycle_) charge_stall(cycle, cause, pa, culprit);
  }
  void charge_stall(std::uint64_t cycle, Cause cause, std::uint32_t pa, std::size_t culprit);
  void stall_on(const BusAccess& a, Picoseconds outcome, std::uint64_t bus, std::uint64_t cycle,
                Cause cause);
  void stall_for_port(Cause cause);
  void sync_to_ahb(std::uint32_t pa) { stall_to(ahb(cycle_), Cause::kBusSync, pa, kCore); }
  void submit(BusAccess& a, std::uint64_t cycle);
  /// Sends the buffered writes that are due before a clock, in order of time.
  void run_buffers(std::uint64_t cycle) {
    if (write_in_flight_ ? !write_access_.done && cycle < write_floor_
                         : writes_.empty() && writes_.victim_bytes == 0)
      return;
    run_buffers_slow(cycle);
  }
  void run_buffers_slow(std::uint64_t cycle);
  Picoseconds time_of_next_act() const;
  std::uint64_t next_act_cycle() const;
  void act_at(std::uint64_t cycle);
  std::uint64_t write_over() const;
  bool write_is_over(std::uint64_t cycle);
  void bus_read(BusAccess& a, Cause cause);
  template <class Put>
  void enqueue(unsigned count, Put put);
  void enqueue_write(std::uint32_t pa, const std::uint8_t* bytes, unsigned count);
  void make_room(unsigned count);
  /// BusAccess::asked of an access that the program reaches now.
  std::uint64_t asked_now() const { return cycle_ - room_waits_; }
  void finish_write(Cause cause);
  void wait_for_write(Cause cause);
  void retire_write();
  void count_whole(Picoseconds t);
  void drain(Cause cause);
  void start_write(std::uint64_t ahb_cycle);
  void write_back(unsigned index, Cause cause);

  static constexpr std::uint32_t kDtcmBase = 0x0001'0000;

  BusPort& port_;
  std::span<std::uint8_t> tcm_;
  TcmPort tcm_port_;
  bool bus_waited_ = false;  // set by a bus access since tcm_access() last looked
  Clock clock_;
  unsigned ratio_, fill_latency_, walk_cycles_, cache_op_cycles_, test_clean_cycles_,
      invalidate_all_cycles_, tcm_wait_, tcm_own_conflict_;
  bool shifted_cycle_;
  std::uint64_t ahb_mask_;  // selects the core clocks at AHB edges; 0: their ratio is not a power
                            // of two

  // Registers.
  std::array<std::uint32_t, 16> r_{};
  std::uint32_t pc_ = 0, next_pc_ = 0;
  std::uint32_t cpsr_ = 0xD3;
  std::array<std::array<std::uint32_t, 7>, 6> banked_{};  // for each bank: r13, r14, (r8..r12)
  std::array<std::uint32_t, 5> user_high_{};              // r8..r12 outside FIQ mode
  std::array<std::uint32_t, 5> fiq_high_{};
  std::array<std::uint32_t, 6> spsr_{};
  bool branched_ = false;

  // Flags in the form in which results provide them: bit 31 of n_ is N, and Z is set if z_ is zero.
  // The order of the members keeps compilers from merging the stores of two flags, which takes
  // longer than two stores.
  std::uint32_t n_ = 0;
  std::uint8_t c_ = 0;
  std::uint32_t z_ = 1;
  std::uint8_t v_ = 0;
  bool flags_live_ = false;

  // Time.
  std::uint64_t cycle_ = 0;
  std::uint64_t clock_floor_ = 0;  // first edge after the last change of the clock
  std::uint64_t stop_cycle_ = 0;  // first clock at which step_attention() has to be called
  bool port_runs_buffers_ = false;  // the port is executing the buffers' work, at its own time
  bool attention_ = true;
  std::uint64_t chain_stop_ = 0;  // clock at which a chain of records ends
  std::uint64_t chain_cycle_ = 0;  // clock between two records (builds without tail calls)
  std::array<std::uint64_t, 16> ready_{};  // clock << 2 | Producer
  std::uint64_t busy_until_ = 0;           // the latest entry of ready_

  // Fetch.
  std::uint32_t line_va_ = 1;               // line of the current records; 1: none
  std::uint32_t line_thumb_ = 0;
  unsigned line_shift_ = 2;                 // log2 of the instruction size in that line
  std::uint32_t run_va_ = 0;                // line of the running chain
  std::intptr_t run_first_ = 0;             // address of a record: those from here on are not
                                            // counted yet
  /// Holds one more record than a line: the one after the last leads to the next line.
  struct DecodedLine {
    std::uint64_t valid = 0;                // line_key() of the last lookup; 0: nothing is decoded
    std::array<Instruction, 17> records;
  };
  /// Identifies a line's address and the translation under which it was found; never 0. Bit 0 is
  /// the Thumb state, bit 2 internal RAM. A chain never leaves one of these (Counts::fetch_from).
  std::uint64_t line_key(std::uint32_t va) const {
    return line_epoch_ | (va & ~31u) | (cpsr_ >> 5 & 1u);
  }
  static constexpr std::uint64_t kEpoch = std::uint64_t{1} << 32;
  static constexpr std::uint64_t kLineInRam = 4;
  std::uint64_t line_epoch_ = kEpoch | 2u;  // changes at each flush_memos()
  std::vector<DecodedLine> decoded_;        // one per I-cache line
  DecodedLine* current_line_ = nullptr;
  std::vector<DecodedLine> tcm_decoded_;
  DecodedLine no_line_;
  static constexpr unsigned kJumps = 1024;
  static std::array<DecodedLine*, kJumps> all_to(DecodedLine* line) {
    std::array<DecodedLine*, kJumps> out;
    out.fill(line);
    return out;
  }
  std::array<DecodedLine*, kJumps> jumps_ = all_to(&no_line_);  // targets found last, by address
  std::array<Instruction, 2> uncached_record_;
  std::array<Instruction, 2> unpredictable_record_;  // separate copy of an UNPREDICTABLE form
  bool fetch_branched_ = false;
  std::uint64_t redirects_seen_ = 0;  // value at the last fetch that bypassed the caches
  bool bus_fetch_ = false;  // the last fetch used the bus: time has passed since the boundary
  std::uint32_t fetch_buffer_pa_ = 1, fetch_words_[4] = {};
  BusAccess fetch_access_;
  struct Fill {
    std::uint32_t line = 1;                 // MVA of the line that is being filled; 1: none
    std::uint32_t critical = 0;             // word that arrives first
    std::uint32_t pa = 0;
    std::uint64_t first = 0, last = 0;      // clocks of the first and the last word
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
    std::uint32_t page = 1;  // mva >> 10, or a number that no page has
    Translation translation;
    bool read_ok = false, write_ok = false;
  };
  static constexpr unsigned kMemos = 256;
  std::array<Memo, kMemos> dmemo_{}, imemo_{};
  void flush_memos();
  /// An address range that the core may read or write without further checks: translation,
  /// permission and cache tag were valid when the hint was made, and whatever could change them
  /// removes the hint. A write hint covers half a line whose dirty bit is set.
  struct Hint {
    std::uint32_t key = kNoHint;  // virtual address of its first byte
    std::uint32_t counter = 0;    // offset in counts_ of the counter of these accesses, in bytes
    std::uintptr_t bias = 0;      // host address of the byte at VA is bias + VA
  };
  static constexpr std::uint32_t kNoHint = 4;  // no aligned address has this bit
  static constexpr unsigned kHints = 256, kReadSpan = 32, kWriteSpan = 16;
  std::array<Hint, kHints> read_hints_{}, write_hints_{};
  /// A writable, cacheable line that the D-cache does not hold; valid under the same conditions as
  /// a read hint. Stores to it go to the write buffer.
  struct {
    std::uint32_t key = kNoHint, pa = 0;
  } absent_;
  bool hints_used_ = false;
  std::uint64_t& counter(const Hint& h) {
    return *reinterpret_cast<std::uint64_t*>(reinterpret_cast<char*>(&counts_) + h.counter);
  }
  std::uint64_t& reads_of(std::uint32_t tcm_pa) {
    return in_itcm(tcm_pa) ? counts_.itcm_reads : counts_.dtcm_reads;
  }
  std::uint64_t& writes_of(std::uint32_t tcm_pa) {
    return in_itcm(tcm_pa) ? counts_.itcm_writes : counts_.dtcm_writes;
  }
  void note_read(std::uint32_t va, std::uint32_t mva, std::uint8_t* line, std::uint64_t& counter);
  void note_write(std::uint32_t va, std::uint32_t mva, std::uint8_t* half, std::uint64_t& counter);
  std::uint32_t counter_offset(const std::uint64_t& counter) const {
    return static_cast<std::uint32_t>(reinterpret_cast<const char*>(&counter) -
                                      reinterpret_cast<const char*>(&counts_));
  }
  void flush_hints();
  void drop_hints(std::uint32_t line_mva);
  Translation flat_;          // used while the MMU is off
  BusAccess data_access_;
  WriteBuffer writes_;
  BusAccess write_access_;
  std::uint64_t room_waits_ = 0;  // clocks waited for room in the buffers, for all causes
  std::uint64_t drains_ = 0;      // number of times that the core waited until the buffers were
                                  // empty
  bool write_in_flight_ = false;
  bool write_is_victim_ = false;
  std::uint64_t write_floor_ = 0;  // the write under way does not end before this clock
  Picoseconds whole_of_ = 0;       // count_whole(): last argument and result
  std::uint64_t whole_ = 0;
  mutable std::uint64_t write_over_ = 0;  // clock at which the write under way can be retired; 0:
                                          // unknown
  static constexpr std::uint64_t kNoCycle = ~std::uint64_t{0};
  mutable std::uint64_t act_time_cycle_ = kNoCycle;  // next_act(): last clock and its time
  mutable Picoseconds act_time_ = 0;
  bool filling_ = false;             // the victim is sent only after the fill has been requested
  std::uint64_t next_write_cycle_ = 0;
  bool read_waiting_ = false;
  std::uint64_t data_port_free_ = 0;  // clock at which the data port is free
  std::uint32_t data_port_pa_ = 0;    // address whose last word occupies the port until then

  // CP15.
  std::uint32_t control_ = 0x0005'0078;
  std::uint32_t ttbr_ = 0, dacr_ = 0, dfsr_ = 0, ifsr_ = 0, far_ = 0;
  std::uint32_t fcse_pid_ = 0, context_id_ = 0;
  std::uint32_t process_ = 0;  // the FCSE PID while the MMU is on, otherwise 0 (ARM DDI 0198D 2-34)
  // Process and control register that apply to fetches: after a change, for a short time the old
  // values.
  std::uint32_t fetch_process_ = 0, fetch_control_ = 0x0005'0078;
  std::uint32_t old_fetch_pc_ = 0;     // pc at which the old values still apply
  unsigned old_fetch_left_ = 0;        // number of instructions that are still fetched with them,
                                       // plus one
  static constexpr std::uint32_t kFetchBits = 1u << 12 | 1u;  // bits I and M of the control
                                                              // register
  std::uint32_t dlock_ = 0, ilock_ = 0, tlb_lock_ = 0;
  std::uint32_t itcm_region_ = 0, dtcm_region_ = 0, debug_override_ = 0, cache_debug_ = 0;
  std::uint32_t itcm_size_ = 0, dtcm_size_ = 0;

  Line irq_, fiq_, reset_;
  bool held_ = false;  // at a boundary that has seen the reset
  bool stop_requested_ = false;
  bool swapping_ = false;             // the two accesses of a SWP are locked
  bool aborted_ = false;              // an access of the current instruction failed
  bool mark_pending_ = false;
  bool first_mark_ = true;
  Picoseconds mark_at_ = 0, mark_next_ = kNever;  // the second mark may be set before the first one
                                                  // is reached
  unsigned chain_ = 0;                // exceptions since the last completed instruction
  bool failing_ = false;
  std::uint32_t failed_pc_ = 0, failed_cpsr_ = 0;
  const char* failed_by_ = "";
  bool failed_jump_ = false;          // the failing address 0 was reached by a jump from
                                      // failed_from_
  std::uint32_t failed_from_ = 0;
  // The last jump to an unknown line; not set by exceptions.
  static constexpr std::uint32_t kNoJump = 1;
  std::uint32_t jumped_from_ = 0, jumped_to_ = kNoJump;
  std::map<std::string, std::string> unpredictable_;  // texts of the warnings, by form

  CoreControl* debugger_ = nullptr;   // called at every instruction boundary if set
  void control_boundary();             // debug_control.cpp

  Counts counts_;
  RegionMap regions_;
  CoreStats window_;
  struct alignas(16) Access {
    std::uint32_t pc = 0, address = 0;
    std::uint32_t what = 0;  // bytes, kWritten, number of further words << 16; 0: no access yet
    std::uint32_t unused = 0;
  };
  static constexpr std::uint32_t kWritten = 1u << 8;
  std::array<Access, 16> ring_{};
  std::uint8_t ring_at_ = 0;  // offset in bytes; wraps at the size of the ring
  const CpuParams& params_;
};

}  // namespace fovea::cpu
