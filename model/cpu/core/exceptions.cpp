// Processor modes, register banks and exceptions (ARM DDI 0100, A2.6; aborts restore the base).
#include <algorithm>
#include <cstdio>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

Core::Core(const CpuParams& params, BusPort& port, std::span<std::uint8_t> tcm)
    : port_(port),
      tcm_(tcm),
      tcm_port_({static_cast<unsigned>(params.tcm_dma_word_clocks()),
                 static_cast<unsigned>(params.tcm_dma_latency()),
                 static_cast<unsigned>(params.tcm_banks()), params.tcm_first.is("core")},
                tcm.size()),
      ratio_(static_cast<unsigned>(params.ahb_ratio())),
      fill_latency_(static_cast<unsigned>(params.fill_latency())),
      walk_cycles_(static_cast<unsigned>(params.walk_cycles())),
      cache_op_cycles_(static_cast<unsigned>(params.cache_op_cycles())),
      test_clean_cycles_(static_cast<unsigned>(params.test_clean_cycles())),
      invalidate_all_cycles_(static_cast<unsigned>(params.invalidate_all_cycles())),
      tcm_wait_(static_cast<unsigned>(params.tcm_wait_states())),
      tcm_own_conflict_(static_cast<unsigned>(params.tcm_own_conflict())),
      shifted_cycle_(params.shifted_address_cycle()),
      ahb_mask_(ratio_ & (ratio_ - 1) ? 0 : ~std::uint64_t{ratio_ - 1}),
      decoded_(params.icache.size() / Cache::kLineBytes),
      tcm_decoded_(tcm.size() / Cache::kLineBytes),
      icache_(params.icache.size()),
      dcache_(params.dcache.size()),
      params_(params) {
  flat_.mask = ~0u;
  fetch_access_.port = BusAccess::Port::kInstruction;
  write_access_.write = write_access_.buffered = true;
}

std::vector<AccessRecord> Core::last_accesses() const {
  constexpr std::size_t kShown = 8;
  std::vector<AccessRecord> out;
  const std::size_t first = ring_at_ / sizeof(Access);  // the oldest access
  for (std::size_t n = first; n < first + ring_.size(); ++n) {
    const Access& a = ring_[n % ring_.size()];
    for (std::uint32_t k = 0; a.what && k <= a.what >> 16; ++k)
      out.push_back({a.pc, a.address + 4 * k, static_cast<std::uint8_t>(a.what),
                     (a.what & kWritten) != 0});
  }
  if (out.size() > kShown) out.erase(out.begin(), out.end() - kShown);
  return out;
}

void Core::set_clock(Frequency f, Picoseconds at) {
  // Bus activity that is under way keeps its end time; convert it into clocks of the new frequency.
  const std::array<std::uint64_t*, 5> clocks = {&data_port_free_, &ifill_.first, &ifill_.last,
                                                &dfill_.first, &dfill_.last};
  std::array<Picoseconds, clocks.size()> times{};
  // What has ended may be older than the new clock, which has no numbers for those times.
  const std::uint64_t future = clock_.running() ? clock_.edge_after(at) : 0;
  for (std::size_t k = 0; clock_.running() && k < clocks.size(); ++k)
    if (*clocks[k] >= future) times[k] = time(*clocks[k]);
  clock_.restart(f, at);
  if (clock_.running()) {
    clock_floor_ = clock_.edge_after(at);
    for (std::size_t k = 0; k < clocks.size(); ++k)
      if (times[k] > at) *clocks[k] = clock_.edge_at_or_after(times[k]);
  }
  write_over_ = write_floor_ = 0;
  whole_of_ = whole_ = 0;
  act_time_cycle_ = kNoCycle;
  attention_ = true;
}

void Core::reset(std::uint32_t entry, Picoseconds now) {
  switch_mode(0x13);  // the general registers keep their values (ARM DDI 0100: UNPREDICTABLE)
  cpsr_ = 0xD3u | ((entry & 1u) << 5);
  pc_ = next_pc_ = entry & ~1u;
  branched_ = aborted_ = swapping_ = failing_ = failed_jump_ = held_ = stop_requested_ = false;
  chain_ = 0;
  jumped_to_ = kNoJump;
  reset_coprocessor();
  forget_accesses();
  cycle_ = clock_.running() ? clock_.edge_after(now) : 0;
  attention_ = true;
}

/// CP15, the TLB and the caches. What they held is lost, dirty lines too.
void Core::reset_coprocessor() {
  control_ = fetch_control_ = 0x0005'0078;
  counts_.translate(false);
  ttbr_ = dacr_ = dfsr_ = ifsr_ = far_ = 0;
  fcse_pid_ = process_ = fetch_process_ = context_id_ = 0;
  old_fetch_left_ = 0;
  dlock_ = ilock_ = tlb_lock_ = 0;
  debug_override_ = cache_debug_ = 0;
  // On this chip both TCMs are enabled after reset: 32 KB each (size code 6), backed by one RAM.
  const bool tcm = !tcm_.empty();
  itcm_region_ = tcm ? 6u << 2 | 1u : 0;
  dtcm_region_ = tcm ? kDtcmBase | 6u << 2 | 1u : 0;
  itcm_size_ = dtcm_size_ = tcm ? 32 * 1024 : 0;
  tlb_ = {};
  icache_.invalidate_all();
  dcache_.invalidate_all();
  // A loader may have changed internal RAM without the core's knowledge.
  for (auto* lines : {&decoded_, &tcm_decoded_})
    for (DecodedLine& line : *lines) line.valid = 0;
  jumps_ = all_to(&no_line_);
  current_line_ = nullptr;
  flush_memos();
}

/// Buffered writes that have not been sent are lost.
void Core::forget_accesses() {
  writes_ = {};
  write_in_flight_ = write_is_victim_ = filling_ = read_waiting_ = false;
  ifill_ = dfill_ = {};
  fetch_buffer_pa_ = 1;
  fetch_branched_ = bus_fetch_ = bus_waited_ = false;
  ready_ = {};
  busy_until_ = next_write_cycle_ = data_port_free_ = write_floor_ = write_over_ = 0;
  act_time_cycle_ = kNoCycle;
}

void Core::restart(std::uint32_t entry, Picoseconds now) {
  const std::uint64_t before = cycle_;
  reset(entry, now);
  cycle_ = std::max(cycle_, before);
  counts_.idle += cycle_ - before;
}

unsigned Core::bank(std::uint32_t mode) {
  switch (mode & 31u) {
    case 0x11: return 1;
    case 0x12: return 2;
    case 0x13: return 3;
    case 0x17: return 4;
    case 0x1B: return 5;
    default: return 0;  // user and system mode
  }
}

void Core::switch_mode(std::uint32_t mode) {
  const unsigned from = bank(cpsr_), to = bank(mode);
  if (from != to) {
    banked_[from][0] = r_[13];
    banked_[from][1] = r_[14];
    if (from == 1 || to == 1) {
      auto& keep = from == 1 ? fiq_high_ : user_high_;
      auto& bring = to == 1 ? fiq_high_ : user_high_;
      for (unsigned k = 0; k < 5; ++k) {
        keep[k] = r_[8 + k];
        r_[8 + k] = bring[k];
      }
    }
    r_[13] = banked_[to][0];
    r_[14] = banked_[to][1];
  }
  cpsr_ = (cpsr_ & ~31u) | (mode & 31u);
}

void Core::set_cpsr(std::uint32_t value) {
  const bool was_privileged = privileged();
  switch_mode(value);
  cpsr_ = value;
  if (was_privileged != privileged()) flush_memos();
  attention_ = true;  // interrupts may have been unmasked
}

void Core::take(Exception e, std::uint32_t return_address) {
  struct Entry {
    std::uint32_t vector, mode;
  };
  constexpr Entry kEntries[] = {{0x00, 0x13}, {0x04, 0x1B}, {0x08, 0x13}, {0x0C, 0x17},
                                {0x10, 0x17}, {0x18, 0x12}, {0x1C, 0x11}};
  constexpr const char* kNames[] = {"reset", "undefined instruction", "SWI", "prefetch abort",
                                    "data abort", "IRQ", "FIQ"};
  if (chain_ == 0) {
    failed_pc_ = pc_;
    failed_cpsr_ = cpsr_;
    failed_by_ = kNames[static_cast<unsigned>(e)];
    failed_jump_ = pc_ == 0 && jumped_to_ == 0;
    failed_from_ = jumped_from_;
  }
  // If no instruction completes between exceptions, the vector itself fails and always will.
  if (++chain_ > 3) {
    failing_ = true;
    const std::string jump =
        failed_jump_ ? "jumped to 0 from " + address_text(failed_from_) + "; " : "";
    throw GuestFailure(jump + failed_by_ + " with no handler: its vector faults again");
  }
  const Entry& entry = kEntries[static_cast<unsigned>(e)];
  const std::uint32_t saved = cpsr_;
  const bool was_privileged = privileged();
  switch_mode(entry.mode);
  spsr_[bank(entry.mode)] = saved;
  cpsr_ = (cpsr_ & ~0x20u) | 0x80u;
  if (e == Exception::kFiq || e == Exception::kReset) cpsr_ |= 0x40u;
  r_[14] = return_address;
  branch_to(entry.vector | ((control_ >> 13 & 1u) ? 0xFFFF0000u : 0u));
  jumped_to_ = kNoJump;
  fetch_branched_ = true;
  if (!was_privileged) flush_memos();
  aborted_ = true;
  ++counts_.exceptions;
  spend(3);
}

/// An aborted instruction continues to its end, for `left` more clocks. In the next clock its last
/// word arrives together with the abort, and in the one after it the core reacts (ARM DDI 0165B
/// 5.3). Then the exception entry begins.
void Core::data_abort(unsigned left) {
  spend(left + 2);
  take(Exception::kDataAbort, pc_ + 8);
}

void Core::undefined() {
  take(Exception::kUndefined, pc_ + ((cpsr_ & 0x20u) ? 2u : 4u));
}

/// An address for a message, with its symbol if one is known.
std::string Core::address_text(std::uint32_t address) const {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08x", address);
  const std::string name = describe ? describe(address) : "";
  return name.empty() ? text : text + (" (" + name + ")");
}

/// Warns once for each form, with the address of its first execution.
void Core::unpredictable(const char* what) {
  ++counts_.unpredictable;
  std::string& text = unpredictable_[what];
  if (text.empty())
    text = std::string("UNPREDICTABLE: ") + what + ", first at " + address_text(pc_);
  Diagnostics::instance().guest(text);
}

void Core::mark_window(Picoseconds t) {
  (mark_pending_ ? mark_next_ : mark_at_) = t;
  mark_pending_ = true;
  attention_ = true;
}

void Core::snapshot() {
  mark_pending_ = mark_next_ != kNever;
  mark_at_ = mark_next_;
  mark_next_ = kNever;
  counts_.cycles = cycle_;
  (first_mark_ ? window_.from : window_.to) = counts_;
  if (first_mark_) window_.to = counts_;
  first_mark_ = false;
}

}  // namespace fovea::cpu
