// Construction, changes of clock and mode, and exceptions (ARM DDI 0100, A2.6; aborts restore the
// base).
#include <algorithm>
#include <cstdio>

#include "model/cpu/core/core.h"

namespace fovea::cpu {

Core::Core(const CpuParams& params, BusPort& port, std::span<std::uint8_t> tcm, const DiagnosticsRef& diagnostics)
    : interface_(port, static_cast<unsigned>(params.ahb_ratio())),
      bus_(interface_, ledger_, static_cast<unsigned>(params.fill_latency())),
      ram_(params, interface_, ledger_, tcm),
      mmu_(ledger_, bus_, ram_, system_, static_cast<unsigned>(params.walk_cycles())),
      data_(params.dcache.size(), ledger_, bus_, system_, diagnostics),
      fetch_({.cache_bytes = params.icache.size(),
              .ram_bytes = tcm.size(),
              .fill_latency = static_cast<unsigned>(params.fill_latency()),
              .shifted_cycle = params.shifted_address_cycle()},
             interface_, ledger_, bus_, log_, system_),
      cache_op_cycles_(static_cast<unsigned>(params.cache_op_cycles())),
      test_clean_cycles_(static_cast<unsigned>(params.test_clean_cycles())),
      invalidate_all_cycles_(static_cast<unsigned>(params.invalidate_all_cycles())),
      shifted_cycle_(params.shifted_address_cycle()),
      params_(params),
      diagnostics_(diagnostics) {}

void Core::set_clock(Frequency f, Picoseconds at) {
  // Bus activity that is under way keeps its end time; convert it into clocks of the new frequency.
  const std::array<std::uint64_t*, 5> clocks = {&bus_.port_free(), &fetch_.fill.first,
                                                &fetch_.fill.last, &data_.fill.first,
                                                &data_.fill.last};
  std::array<Picoseconds, clocks.size()> times{};
  Clock& clock = interface_.clock;
  // What has ended may be older than the new clock, which has no numbers for those times.
  const std::uint64_t future = clock.running() ? clock.edge_after(at) : 0;
  for (std::size_t k = 0; clock.running() && k < clocks.size(); ++k)
    if (*clocks[k] >= future) times[k] = time(*clocks[k]);
  clock.restart(f, at);
  if (clock.running()) {
    interface_.clock_floor = clock.edge_after(at);
    for (std::size_t k = 0; k < clocks.size(); ++k)
      if (times[k] > at) *clocks[k] = clock.edge_at_or_after(times[k]);
  }
  bus_.clock_changed();
  interface_.attention = true;
}

/// What the caches and buffers held is lost: dirty lines and writes that have not been sent.
void Core::reset(std::uint32_t entry, Picoseconds now) {
  // The general registers keep their values (ARM DDI 0100: UNPREDICTABLE).
  regs_.switch_mode(static_cast<std::uint32_t>(CpuMode::kSvc));
  regs_.cpsr = 0xD3u | ((entry & 1u) << 5);
  regs_.pc = next_pc_ = entry & ~1u;
  branched_ = aborted_ = swapping_ = held_ = stop_requested_ = false;
  failure_ = {};
  scoreboard_ = {};
  system_ = {};
  ledger_.counts.translate(false);
  ledger_.bus_waited = false;
  // On this chip both TCMs are enabled after reset: 32 KB each (size code 6), backed by one RAM.
  const bool ram = !ram_.empty();
  system_.itcm_region = ram ? 6u << 2 | 1u : 0;
  system_.dtcm_region = ram ? InternalRam::kDtcmBase | 6u << 2 | 1u : 0;
  ram_.set_itcm(ram_.size());
  ram_.set_dtcm(ram_.size());
  mmu_.reset();
  data_.reset();
  fetch_.reset();
  bus_.reset();
  ledger_.cycle = interface_.clock.running() ? interface_.clock.edge_after(now) : 0;
  interface_.attention = true;
  if (ledger_.profile) ledger_.profile->stacks.start(ledger_.cycle, regs_.pc);
  forget_translations();
}

void Core::restart(std::uint32_t entry, Picoseconds now) {
  const std::uint64_t before = ledger_.cycle;
  reset(entry, now);
  const std::uint64_t cycle = std::max(ledger_.cycle, before);
  ledger_.cycle = before;
  ledger_.sleep_to(cycle, WakeEvent::kOther);
  if (ledger_.profile) ledger_.profile->mask.set(true, awake(), regs_.pc);
}

void Core::set_cpsr(std::uint32_t value) {
  const bool was_privileged = regs_.privileged();
  regs_.switch_mode(value);
  regs_.cpsr = value;
  if (ledger_.profile) ledger_.profile->mask.set(value & kIrqMask, awake(), regs_.pc);
  if (was_privileged != regs_.privileged()) forget_translations();
  interface_.attention = true;  // interrupts may have been unmasked
}

/// Keeps for a message what an exception interrupted, if it is the first of a chain of exceptions.
/// @throws GuestFailure if the chain has become too long: no instruction completes between the
/// exceptions, so the vector itself fails and always will
void Core::note_failure(Exception e) {
  constexpr const char* kNames[] = {"reset", "undefined instruction", "SWI", "prefetch abort",
                                    "data abort", "IRQ", "FIQ"};
  if (failure_.exceptions == 0) {
    failure_.pc = regs_.pc;
    failure_.cpsr = regs_.cpsr;
    failure_.by = kNames[static_cast<unsigned>(e)];
    failure_.at_jump = regs_.pc == 0 && failure_.jumped_to == 0;
    failure_.from = failure_.jumped_from;
  }
  if (++failure_.exceptions <= 3) return;
  failure_.failed = true;
  const std::string jump =
      failure_.at_jump ? "jumped to 0 from " + address_text(failure_.from) + "; " : "";
  throw GuestFailure(jump + failure_.by + " with no handler: its vector faults again");
}

namespace {
std::uint32_t entries_at(std::uint32_t control) {
  return (control & kHighVectors) ? 0xFFFF0000u : 0u;
}
}  // namespace

void Core::take(Exception e, std::uint32_t return_address) {
  struct Entry {
    std::uint32_t vector;
    CpuMode mode;
  };
  constexpr Entry kEntries[] = {{0x00, CpuMode::kSvc}, {0x04, CpuMode::kUnd},
                                {0x08, CpuMode::kSvc}, {0x0C, CpuMode::kAbt},
                                {0x10, CpuMode::kAbt}, {0x18, CpuMode::kIrq},
                                {0x1C, CpuMode::kFiq}};
  note_failure(e);
  if (ledger_.profile) {
    ledger_.profile->begin();
    // An SWI and an undefined instruction are over; the others come again, or were not executed.
    const bool over = e == Exception::kSwi || e == Exception::kUndefined;
    ledger_.profile->stacks.exception(
        ledger_.cycle, entries_at(system_.control) + kEntries[static_cast<unsigned>(e)].vector,
        over ? return_address : regs_.pc, regs_.r[13]);
  }
  const Entry& entry = kEntries[static_cast<unsigned>(e)];
  const std::uint32_t saved = regs_.cpsr;
  const bool was_privileged = regs_.privileged();
  regs_.switch_mode(static_cast<std::uint32_t>(entry.mode));
  regs_.spsr() = saved;
  regs_.cpsr = (regs_.cpsr & ~kThumbState) | kIrqMask;
  if (e == Exception::kFiq || e == Exception::kReset) regs_.cpsr |= kFiqMask;
  if (ledger_.profile) ledger_.profile->mask.set(true, awake(), regs_.pc);
  regs_.r[14] = return_address;
  go_to(entry.vector | entries_at(system_.control));
  failure_.jumped_to = kNoJump;
  fetch_.branched = true;
  if (!was_privileged) forget_translations();
  aborted_ = true;
  ++ledger_.counts.exceptions;
  spend(3);
}

/// An aborted instruction continues to its end, for `left` more clocks. In the next clock its last
/// word arrives together with the abort, and in the one after it the core reacts (ARM DDI 0165B
/// 5.3). Then the exception entry begins.
void Core::data_abort(unsigned left) {
  spend(left + 2);
  take(Exception::kDataAbort, regs_.pc + 8);
}

void Core::undefined() {
  take(Exception::kUndefined, regs_.pc + (regs_.thumb() ? 2u : 4u));
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
  ++ledger_.counts.unpredictable;
  std::string& text = unpredictable_texts_[what];
  if (text.empty())
    text = std::string("UNPREDICTABLE: ") + what + ", first at " + address_text(regs_.pc);
  diagnostics_.guest(text);
}

}  // namespace fovea::cpu
