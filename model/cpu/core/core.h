// The ARM926EJ-S: instructions, caches with data, MMU, write buffer, and their timing. No SystemC.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "model/common/check.h"
#include "model/common/clock.h"
#include "model/common/observers.h"
#include "model/common/ram_watch.h"
#include "model/cpu/core/access_log.h"
#include "model/cpu/core/addressing.h"
#include "model/cpu/core/bus_interface.h"
#include "model/cpu/core/bus_port.h"
#include "model/cpu/core/data_bus.h"
#include "model/cpu/core/data_cache.h"
#include "model/cpu/core/fetch_unit.h"
#include "model/cpu/core/instruction.h"
#include "model/cpu/core/internal_ram.h"
#include "model/cpu/core/measurement_window.h"
#include "model/cpu/core/mmu.h"
#include "model/cpu/core/params.h"
#include "model/cpu/core/registers.h"
#include "model/cpu/core/scoreboard.h"
#include "model/cpu/core/stall_ledger.h"
#include "model/cpu/core/system_registers.h"

namespace fovea::cpu {

class Core;

/// An interrupt line: a change at t is visible to instruction boundaries strictly after t.
struct InterruptLine {
  bool level = false, before = false;
  Picoseconds since = 0;
  void set(bool v, Picoseconds at) {
    if (at != since) before = level;
    level = v;
    since = at;
  }
  bool at(Picoseconds boundary) const { return since < boundary ? level : before; }
};

/// Called on the core's own thread at every instruction boundary, before the instruction at the pc.
class BoundaryObserver {
 public:
  virtual ~BoundaryObserver() = default;
  virtual void at_boundary() = 0;
};

/// Handles an SWI instead of the guest's vector. Returns false if it is not one of its own.
using SwiHandler = std::function<bool(Core&, std::uint32_t number)>;

/// The parts of a core for a debugger, which reads them between instructions or during an SWI.
struct CoreView {
  const RegisterFile& registers;
  const SystemRegisters& system;
  const Mmu& mmu;
  const InternalRam& ram;
  const DataCache& data;
  const FetchUnit& fetch;
  const DataBus& bus;
  const Scoreboard& scoreboard;
  const InterruptLine& irq;
  const InterruptLine& fiq;
};

/// Joins the parts: this class executes instructions and decides which part serves an access. It
/// counts time in clocks (edge numbers of its clock) and converts it into picoseconds only for the
/// bus. An instruction boundary at clock c has the time of edge c.
class Core : public Background {
  // First, so that every handler reaches them with a short offset.
  /// The running chain of records (handlers.h).
  struct {
    std::uint64_t stop = 0;   // clock at which it ends
    std::intptr_t first = 0;  // address of a record: those from here on are not counted yet
    std::uint32_t va = 0;     // address of its line
    std::uint64_t cycle = 0;  // clock between two records (builds without tail calls)
  } chain_;
  RegisterFile regs_;

 public:
  /// @param tcm the RAM of 32 KB that is visible through both TCM windows (0x0 and 0x10000); its
  ///        size is a power of two. Empty: a core without TCMs
  /// @param diagnostics receives what the program does wrong and what is not modelled
  Core(const CpuParams& params, BusPort& port, std::span<std::uint8_t> tcm, const DiagnosticsRef& diagnostics);
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;

  void set_clock(Frequency f, Picoseconds at);
  void set_irq(bool level, Picoseconds at) {
    irq_.set(level, at);
    interface_.attention = true;
  }
  void set_fiq(bool level, Picoseconds at) {
    fiq_.set(level, at);
    interface_.attention = true;
  }

  /// Returns to the state after power-up; accesses under way must have ended. General registers,
  /// internal RAM and all counters are kept.
  /// @param entry address of the first instruction; bit 0 selects the Thumb state
  void reset(std::uint32_t entry, Picoseconds now);
  /// The same at the end of a reset. The clocks that have passed since it began count as idle.
  void restart(std::uint32_t entry, Picoseconds now);
  /// Sets the reset line. Like an interrupt, a change at t is visible to instruction boundaries
  /// strictly after t. There run() ends, and held() is true until the next reset().
  void set_reset(bool level, Picoseconds at) {
    reset_.set(level, at);
    interface_.attention = true;
  }
  bool held() const { return held_; }
  /// Runs until request_stop() or a reset, blocking inside calls of BusPort. @throws GuestFailure
  void run();
  void request_stop() {
    stop_requested_ = true;
    interface_.attention = true;
  }
  bool stop_requested() const { return stop_requested_; }

  // Background: the write and victim buffers on the D-AHB.
  Picoseconds next_act() const final { return bus_.next_act(); }
  void act() final { bus_.act(); }
  /// Number of BusAccess objects that the core owns.
  static constexpr std::size_t kAccesses = 3;

  /// Marks the start (first call) or end (second call) of the measurement window at time t. The
  /// core copies its counters at its first instruction boundary after t, or exactly at t during a
  /// wait for interrupt.
  void mark_window(Picoseconds t) {
    window_.mark(t);
    interface_.attention = true;
  }
  bool mark_done() const { return !window_.edge_pending(); }
  /// Has `f` called with the counters as mark_window() copies them at time t, which must not be
  /// before the present time. The counters' `cycles` are those of that boundary.
  void sample_counts(Picoseconds t, MeasurementWindow::Sample f) {
    window_.sample(t, std::move(f));
    interface_.attention = true;
  }
  /// Attributes every clock to an instruction from now on, in section 0 of the profile. Before the
  /// first instruction; changes no simulated time.
  ClockProfile& start_profile();
  const ClockProfile* profile() const { return own_profile_.get(); }
  ClockProfile* profile() { return own_profile_.get(); }
  /// Lets the profile's clocks after time t belong to a section; as mark_window().
  void mark_section(Picoseconds t, std::size_t section) {
    own_profile_->mark(t, section);
    interface_.attention = true;
  }
  /// Lets the profile keep the counters at time t; as mark_window().
  void mark_snapshot(Picoseconds t) {
    own_profile_->snapshot(t);
    interface_.attention = true;
  }
  /// Lets the profile count sleeps from time t on as waits for work that the program has given away, or no
  /// longer; as mark_window().
  void mark_given_away(Picoseconds t, bool begins) {
    own_profile_->mark_given_away(t, begins);
    interface_.attention = true;
  }
  /// Completes the profile. The core is between two instructions, asleep, or has failed.
  /// @param end the counters up to which clocks count, as of counts_asleep()
  void finish_profile(const Counts& end);
  /// Says which event has ended a sleep; called when it ends. May be empty.
  std::function<WakeEvent()> wake_event;
  const CoreStats& window_stats() const { return window_.stats(); }
  const Counts& counts() const { return ledger_.counts; }
  const Clock& clock() const { return interface_.clock; }
  /// Clocks that the core waited for room in the write and victim buffers, and how often it waited
  /// until both were empty; for a recorder of bus traffic.
  std::uint64_t room_waits() const { return bus_.room_waits(); }
  std::uint64_t drains() const { return bus_.drains(); }
  /// The counters as of time t, for a core that waits for an interrupt until then.
  Counts counts_asleep(Picoseconds t) const;
  /// Names for the addresses in the stall statistics; must be set before the first instruction.
  void set_regions(RegionMap regions) { ledger_.set_regions(std::move(regions)); }
  const RegionMap& regions() const { return ledger_.regions(); }
  std::uint64_t instructions_executed() const { return ledger_.counts.instructions; }

  std::uint32_t reg(unsigned i) const { return i == 15 ? regs_.pc : regs_.r[i]; }
  void set_reg(unsigned i, std::uint32_t v) { regs_.r[i] = v; }
  std::uint32_t cpsr() const { return regs_.status(); }
  /// Address of the instruction that is executed; after a guest failure, of the one that began the
  /// chain of exceptions.
  std::uint32_t current_pc() const { return failure_.failed ? failure_.pc : regs_.pc; }
  std::uint64_t clock_count() const { return ledger_.cycle; }
  /// Time of the last instruction boundary; may be ahead of the other agents' time.
  Picoseconds boundary_time() const { return interface_.time(ledger_.cycle); }
  Picoseconds time(std::uint64_t cycle) const { return interface_.time(cycle); }
  std::vector<AccessRecord> last_accesses() const { return log_.newest(); }
  /// Core clocks that each access to internal RAM takes beyond its first one, from now on.
  void set_tcm_wait_states(unsigned clocks) {
    ram_.set_wait_states(clocks);
    forget_translations();
  }
  /// Adds a handler of SWIs. They are asked in the order in which they were added.
  Subscription handle_swi(SwiHandler handler) { return swi_handlers_.add(std::move(handler)); }
  /// For messages: returns "name+0x12" for an address, or "" if it has no name. May be empty.
  std::function<std::string(std::uint32_t)> describe;
  /// The DMA port of internal RAM, used by model/cpu/tcm_dma.h. A burst arrives at `at`; its data
  /// are moved at tcm_burst_over(), a time that accesses of the core may postpone until then.
  void tcm_burst_begins(const TcmPort::Burst& burst, Picoseconds at);
  Picoseconds tcm_burst_over() const { return interface_.time(ram_.port().end() - 1); }
  void tcm_burst_ends(bool write, std::uint8_t* data);
  const TcmPort& tcm_port() const { return ram_.port(); }
  /// Tells `watch` of loads from internal RAM and of bursts to it from now on; null: no observer is told.
  void watch_ram(RamWatch* watch) {
    ram_watch_ = watch;
    forget_translations();
  }
  /// Clock at which the latest sleep ended; 0 before the first.
  std::uint64_t woke() const { return woke_; }
  /// Reads internal RAM, the D-cache and the buffers without side effects. Returns false if none of
  /// them holds the address, so that memory has the current value.
  bool peek(std::uint32_t address, std::uint8_t& byte) const;

  /// Calls the observer for what happens to the D-cache's lines, until the subscription ends.
  Subscription observe_lines(LineWatch& observer) { return data_.observe(observer); }
  /// Whether each access to a line is announced to the observers, until the line is filled again. An
  /// observer calls this once when it begins to need that, and once when it no longer does.
  void watch_line(unsigned line, bool on) { data_.watch_line(line, on); }

  /// Forgets all that is remembered to save host time: translations, hints, decoded lines, times, and up to when
  /// no other process acts. It changes no result, which tests show by doing so at any time.
  void forget_for_a_test();

  // For debuggers: only at an instruction boundary or during an SWI, without simulated time.
  CoreView view() const {
    return {regs_, system_, mmu_, ram_, data_, fetch_, bus_, scoreboard_, irq_, fiq_};
  }
  /// While there are observers, the core executes its instructions one by one, which costs host
  /// time but no simulated time.
  Subscription observe_boundaries(BoundaryObserver& observer);
  /// Ends the chain of instructions that is under way, so that the next boundary is looked at.
  void end_chain() { interface_.attention = true; }
  /// Lets the core's own buffers and the bus do everything that is due at this boundary.
  void settle_bus();
  /// To be called when something outside the core was changed at this boundary: the core asks for
  /// the next event again.
  void disturb();
  /// Chooses the next instruction; bit 0 does not select the Thumb state.
  void redirect(std::uint32_t pc);
  /// Changes mode and Thumb state too.
  void change_status(std::uint32_t cpsr);
  void change_banked(unsigned bank, unsigned number, std::uint32_t value) {
    regs_.banked(bank, number) = value;
  }
  void change_spsr(unsigned bank, std::uint32_t value) { regs_.spsr(bank) = value; }
  /// Writes a CP15 register with the side effects of an MCR. `number`: see cp15.cpp.
  void change_system_register(std::uint32_t number, std::uint32_t value) {
    cp15_write(number, value);
  }
  /// Changes every copy that the core has of bytes within one line: in internal RAM, or in the
  /// caches, the buffers and decoded instructions.
  void patch_ram(std::uint32_t pa, std::span<const std::uint8_t> bytes);
  void patch(std::uint32_t mva, std::uint32_t pa, std::span<const std::uint8_t> bytes);
  /// After a GuestFailure: restores mode and pc of the instruction with which the failure began.
  void back_to_failure();

  /// The handlers of decoded records (handlers.h).
  struct Ops;

 private:
  friend class CoreTest;
  static constexpr unsigned kPcDelayArm = 8;
  enum class Result : std::uint8_t { kOk, kAbort };

  // execute.cpp
  void step_attention();
  /// What step_attention() does next.
  enum class Boundary : std::uint8_t { kExecute, kRepeat };
  bool take_interrupt(Picoseconds at);
  bool interrupt_pending() const;
  Boundary wait_for_others(Picoseconds t);
  void execute_alone(const Instruction& i);
  void enter_exception();
  void end_old_fetch();
  // For a profile.
  void start_counted(const Instruction* i);
  [[gnu::noinline]] void execute_one_counted(const Instruction& i);
  void enter_section(std::size_t section);
  std::uint64_t awake() const { return ledger_.cycle - ledger_.counts.idle; }
  void take_marks(Picoseconds boundary);
  bool marks_pending() const {
    return window_.pending() || (ledger_.profile && ledger_.profile->pending());
  }
  // For the profile's call stacks; each in a handler, with the clock at the end of its record.
  [[gnu::noinline]] void follow_call(const Instruction* i, std::uint64_t cycle,
                                     std::uint32_t target);
  [[gnu::noinline]] void follow_jump(const Instruction* i, std::uint64_t cycle,
                                     std::uint32_t target);
  [[gnu::noinline]] void follow_tail_call(std::uint64_t cycle, std::uint32_t target);
  [[gnu::noinline]] void follow_pop(const Instruction* i, std::uint64_t cycle, std::uint32_t target,
                                    std::uint32_t base);
  [[gnu::noinline]] void follow_branch(std::uint32_t target);
  Picoseconds next_mark() const {
    const Picoseconds window = window_.pending() ? window_.at() : kNever;
    return ledger_.profile && ledger_.profile->pending()
               ? std::min(window, ledger_.profile->next_mark())
               : window;
  }
  /// The flow comes to a record of the current line otherwise than from the one before it...
  void starts_at(const Instruction* i) {
    if (profile_) [[unlikely]]
      ++fetch_.current->tally(*i).flow;
  }
  /// ... or ends in front of it.
  void ends_before(const Instruction* i) {
    if (profile_) [[unlikely]]
      --fetch_.current->tally(*i).flow;
  }
  /// Calls f(), which executes an instruction outside of the flow that the tallies describe.
  template <class F>
  void count_alone(const Instruction& i, F f) {
    if (!profile_) [[likely]] return f();
    ClockProfile* const p = std::exchange(profile_, nullptr);
    const std::uint32_t pc = regs_.pc;
    // The handler of a branch counts all the same, if the record is of a line.
    DecodedLine* const line = fetch_.current;
    const std::uint32_t special = line->tally(i).special;
    p->begin();
    f();
    p->end(pc);
    if (i.op == Op::kB || i.op == Op::kBl) line->tally(i).special = special;
    profile_ = p;
  }
  [[gnu::noinline]] void execute_one(const Instruction& i);
  bool chain_goes_on(const Instruction* next) const;
  void execute(const Instruction& i);
  void execute_rare(const Instruction& i);
  void branch_to(std::uint32_t target) {
    if (ledger_.profile) [[unlikely]]
      follow_branch(target);
    go_to(target);
  }
  void go_to(std::uint32_t target) {
    next_pc_ = target;
    branched_ = true;
    failure_.jumped_from = regs_.pc;
    failure_.jumped_to = target;
    ++ledger_.counts.redirects;
  }
  void interwork(std::uint32_t target);
  void set_pc_ahead(const Instruction& i) {
    if (i.flags & kReadsPc) regs_.r[15] = pc_ahead(i, regs_.pc);
  }
  /// The result of an instruction whose issue ends now can be used `latency` clocks later.
  void produce(unsigned r, unsigned latency) {
    scoreboard_.ready_at(r, ledger_.cycle + latency, Scoreboard::kOther);
  }
  void loaded(unsigned r, unsigned latency) {
    scoreboard_.ready_at(r, ledger_.cycle + latency, Scoreboard::kLoad);
  }
  void multiplied(unsigned r, unsigned latency) {
    scoreboard_.ready_at(r, ledger_.cycle + latency, Scoreboard::kMultiply);
  }
  /// Adds what a chain of records did before record `i` to the counters, and sets pc and clock.
  void settle(const Instruction* i, std::uint64_t cycle) {
    regs_.pc = chain_.va + i->at;
    fetch_.move_to_line(chain_.va);
    ledger_.counts.issue += cycle - ledger_.cycle;
    ledger_.cycle = cycle;
    const auto at = reinterpret_cast<std::intptr_t>(i);
    ledger_.counts.instructions += static_cast<std::uint64_t>(
        (at - chain_.first) / static_cast<std::intptr_t>(sizeof(Instruction)));
    chain_.first = at;
  }
  void spend(unsigned n) { ledger_.spend(n); }

  // arithmetic.cpp, data_processing.cpp
  void data_processing(const Instruction& i);
  void dsp(const Instruction& i);
  void status(const Instruction& i);

  // transfers.cpp
  void load_store(const Instruction& i);
  void store_register(const Instruction& i, const DataAddress& at, unsigned cycles);
  void load_register(const Instruction& i, const DataAddress& at, unsigned cycles);
  void load_pair(const Instruction& i, const DataAddress& at);
  void store_pair(const Instruction& i, const DataAddress& at);
  void load_multiple(const Instruction& i);
  void store_multiple(const Instruction& i);
  void swap(const Instruction& i);
  void write_back_base(const Instruction& i, const DataAddress& at) {
    if ((i.flags & kWriteBack) && i.rn != 15) regs_.r[i.rn] = at.moved;
  }

  // exceptions.cpp
  enum class Exception { kReset, kUndefined, kSwi, kPrefetchAbort, kDataAbort, kIrq, kFiq };
  void take(Exception e, std::uint32_t return_address);
  void note_failure(Exception e);
  void data_abort(unsigned left);
  void undefined();
  void set_cpsr(std::uint32_t value);
  void unpredictable(const char* what);
  std::string address_text(std::uint32_t address) const;

  // cp15.cpp
  void coprocessor_move(const Instruction& i);
  void settings_changed();
  bool cp15_read(std::uint32_t opc, std::uint32_t& value);
  bool cp15_write(std::uint32_t opc, std::uint32_t value);
  void set_ram_region(bool data, std::uint32_t value);
  bool cache_operation(unsigned crm, unsigned op2, std::uint32_t value);
  std::uint32_t test_and_clean(bool invalidate);
  void clean_line(int line);
  void clean_and_invalidate_line(int line);
  void prefetch_line(std::uint32_t mva);
  void wait_for_interrupt();

  // memory.cpp
  const Instruction* fetch() {
    const Instruction* const known = fetch_.in_current_line(regs_.pc, regs_.cpsr);
    return known ? known : fetch_slow();
  }
  const Instruction* fetch_slow();
  const Instruction* fetch_from_ram(std::uint32_t pa, const FetchTarget& target);
  const Instruction* prefetch_abort() {
    take(Exception::kPrefetchAbort, regs_.pc + 4);
    return nullptr;
  }
  template <unsigned kBytes>
  [[gnu::noinline]] bool store_beside_cache(const Instruction* i, std::uint32_t va,
                                            std::uint32_t value);
  template <unsigned kBytes>
  [[gnu::noinline]] void store_absent(const Instruction* i, std::uint32_t va, std::uint32_t pa,
                                      std::uint32_t value);
  template <unsigned kBytes>
  [[gnu::noinline]] const std::uint8_t* load_cached(const Instruction* i, std::uint32_t va);
  Result load(std::uint32_t va, unsigned bytes, std::uint32_t& value, Rights rights);
  Result store(std::uint32_t va, unsigned bytes, std::uint32_t value, Rights rights);
  Result store_words(std::uint32_t va, const std::uint32_t* words, unsigned count);
  void store_to_ram(std::uint32_t va, std::uint32_t pa, unsigned bytes, std::uint32_t value);
  /// Translates a data access. @return nullptr if a fault was recorded
  [[gnu::always_inline]] const Translation* translate(std::uint32_t mva, Access access,
                                                      Rights rights) {
    if (!system_.mmu_on()) return &mmu_.flat();
    return translated(mmu_.translate(mva, access, as_user(rights)));
  }
  /// Forgets what the other parts remember if a TLB entry may have been replaced.
  [[gnu::always_inline]] const Translation* translated(const Translation* t) {
    if (mmu_.insertions() != insertions_seen_) [[unlikely]] {
      insertions_seen_ = mmu_.insertions();
      forget_hints_and_lines();
    }
    return t;
  }
  bool as_user(Rights rights) const { return rights == Rights::kUser || !regs_.privileged(); }
  /// For an access that must be aligned if alignment is checked: records a fault if it is not.
  bool misaligned(std::uint32_t va, unsigned bytes) {
    if (!(system_.control & kAlignmentChecked) || !(va & (bytes - 1))) return false;
    mmu_.fault(Access::kLoad, Fault::kAlignment, 0, system_.modified(va));
    return true;
  }
  void ram_access(std::uint32_t pa, TcmPort::Side side);
  [[gnu::noinline]] void tell_load(std::uint32_t pa, unsigned bytes);
  /// To be called when translations or permissions may have changed.
  void forget_translations() {
    mmu_.forget();
    forget_hints_and_lines();
  }
  void forget_hints_and_lines() {
    fetch_.forget();
    data_.forget_hints();
  }
  std::uint64_t& counter(const DataCache::Hint& h) {
    return *reinterpret_cast<std::uint64_t*>(reinterpret_cast<char*>(&ledger_.counts) +
                                             h.counter);
  }

  ClockProfile* profile_ = nullptr;  // null while an instruction is executed outside of the flow
  std::unique_ptr<ClockProfile> own_profile_;
  std::uint64_t collected_ = 0;  // clock at which the tallies were last collected
  std::uint32_t next_pc_ = 0;
  bool branched_ = false;  // the current instruction set next_pc_
  bool exception_return_ = false;  // a branch that follows restores the mode
  bool aborted_ = false;   // an access of the current instruction failed
  Scoreboard scoreboard_;
  AccessLog log_;

  StallLedger ledger_;
  BusInterface interface_;
  DataBus bus_;
  SystemRegisters system_;
  InternalRam ram_;
  Mmu mmu_;
  DataCache data_;
  FetchUnit fetch_;
  std::uint64_t insertions_seen_ = 0;
  RamWatch* ram_watch_ = nullptr;
  std::uint64_t woke_ = 0;

  InterruptLine irq_, fiq_, reset_;
  bool held_ = false;  // at a boundary that has seen the reset
  bool stop_requested_ = false;
  bool swapping_ = false;  // the two accesses of a SWP are locked
  DecodedLine unpredictable_;  // separate copy of an UNPREDICTABLE form
  std::map<std::string, std::string> unpredictable_texts_;  // of the warnings, by form
  MeasurementWindow window_;

  static constexpr std::uint32_t kNoJump = 1;
  /// Exceptions that follow each other without an instruction in between, for the message about a
  /// guest failure.
  struct {
    unsigned exceptions = 0;   // since the last completed instruction
    bool failed = false;
    std::uint32_t pc = 0, cpsr = 0;  // when the first of them was raised
    const char* by = "";
    bool at_jump = false;  // it was raised at address 0, which was reached by a jump from...
    std::uint32_t from = 0;
    // The last jump to an unknown line; not set by exceptions.
    std::uint32_t jumped_from = 0, jumped_to = kNoJump;
  } failure_;

  Observers<BoundaryObserver*> boundary_observers_;
  Observers<SwiHandler> swi_handlers_;

  unsigned cache_op_cycles_, test_clean_cycles_, invalidate_all_cycles_;
  bool shifted_cycle_;  // a shifted register offset costs a clock
  const CpuParams& params_;
  DiagnosticsRef diagnostics_;
};

}  // namespace fovea::cpu
