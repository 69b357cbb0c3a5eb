#include "model/cpu/core/fetch_unit.h"

#include <algorithm>

namespace fovea::cpu {

FetchUnit::FetchUnit(const Sizes& sizes, BusInterface& interface, StallLedger& ledger,
                     DataBus& data_bus, AccessLog& log, const SystemRegisters& registers)
    : interface_(interface),
      ledger_(ledger),
      data_bus_(data_bus),
      log_(log),
      registers_(registers),
      fill_latency_(sizes.fill_latency),
      shifted_cycle_(sizes.shifted_cycle),
      icache_(sizes.cache_bytes),
      decoded_(sizes.cache_bytes / Cache::kLineBytes),
      ram_decoded_(sizes.ram_bytes / Cache::kLineBytes) {
  jumps.fill(&no_line_);
  for (auto* lines : {&decoded_, &ram_decoded_})
    for (auto& d : *lines) d.next = &no_line_;
  access_.port = BusAccess::Port::kInstruction;
}

/// Decoded instructions go too: a loader may have changed internal RAM without the unit's knowledge.
void FetchUnit::reset() {
  process_ = 0;
  control_ = registers_.control;
  lag_ = 0;
  fill = {};
  branched = used_bus = false;
  invalidate_all();
  for (auto& d : ram_decoded_) d.valid = 0;
  jumps.fill(&no_line_);
}

void FetchUnit::forget() {
  leave_line();
  knows_ram_ = false;
  epoch += kEpoch;
  if (epoch >= kEpoch) [[likely]]
    return;
  epoch += kEpoch;  // the numbers start again: no line may keep an old one
  for (auto* lines : {&decoded_, &ram_decoded_})
    for (auto& d : *lines)
      if (d.valid) d.look_up_again();
}

void FetchUnit::collect_tallies() {
  for (auto* lines : {&decoded_, &ram_decoded_})
    for (auto& d : *lines) profile_->collect(d);
}

RecordContext FetchUnit::context(const Instruction& decoded, std::uint32_t pc) const {
  RecordContext context;
  if (!profile_) return context;
  context.counted = true;
  const std::uint32_t ahead = (decoded.flags & kThumbInsn) ? 4 : 8;
  context.away =
      decoded.op == Op::kB && !profile_->stacks.same_function(pc, pc + ahead + decoded.imm);
  return context;
}

void FetchUnit::use_new_settings() {
  process_ = registers_.process;
  if (control_ != registers_.control) buffer_pa_ = 1;
  control_ = registers_.control;
}

/// If a second change follows, the instructions after it see both at once (assumed).
void FetchUnit::settings_changed(std::uint32_t next_pc) {
  const bool same = lag_ || (registers_.process == process_ &&
                             !((registers_.control ^ control_) & kFetchBits));
  lag_ = same ? 0 : 3;
  lag_pc_ = next_pc;
  if (same) use_new_settings();
}

/// Two instructions were fetched before the change took effect, unless the program branches (ARM
/// DDI 0198D 2-34 for the process ID; two for the control register as well, from the length of the
/// pipeline).
bool FetchUnit::instruction_done(std::uint32_t pc, bool thumb) {
  if (pc == lag_pc_ && --lag_) {
    lag_pc_ += thumb ? 2u : 4u;
    return false;
  }
  lag_ = 0;
  use_new_settings();
  return true;
}

/// Executes a read on the instruction port, which carries one transaction at a time. The core
/// continues at its first word (a line) or its last one.
/// @param wanted the instruction's address, to which the wait for the AHB's edge is attributed
void FetchUnit::read(BusAccess::Kind kind, std::uint32_t wanted, std::uint32_t pa,
                     unsigned bytes) {
  used_bus = true;
  data_bus_.run_buffers(ledger_.cycle);
  ledger_.stall_to(interface_.ahb(ledger_.cycle), Cause::kBusSync, wanted, kCore);
  BusAccess& a = access_;
  a.kind = kind;
  a.write = a.buffered = false;
  a.address = pa;
  a.bytes = static_cast<std::uint8_t>(bytes);
  ledger_.counts.i_read_beats += beats(bytes);
  interface_.submit(a, ledger_.cycle);
  interface_.port.finish(a);
}

void FetchUnit::fill_line(std::uint32_t mva, std::uint32_t pa) {
  access_.asked = data_bus_.asked_now();
  ledger_.stall_to(fill.last, Cause::kIcache, fill.pa, kService);
  const unsigned index = icache_.victim(icache_.set_of(mva), registers_.control & kRoundRobin,
                                        registers_.ilock & 15u);
  icache_.invalidate(index);
  decoded_[index].valid = 0;
  read(BusAccess::Kind::kWrap8, pa, pa & ~3u, 32);
  ++ledger_.counts.icache_fills;
  const std::uint64_t there = interface_.clock.edge_at_or_after(access_.first);
  ledger_.stall_on(access_, access_.first, there, there + fill_latency_, Cause::kIcache);
  if (access_.error) return;
  std::memcpy(icache_.data(index), access_.data, 32);
  icache_.line(index).tag = mva & ~31u;
  icache_.line(index).pa = pa & ~31u;
  fill = {mva & ~31u, (pa >> 2) & 7u, pa, ledger_.cycle,
          std::max(ledger_.cycle,
                   interface_.clock.edge_at_or_after(access_.last) + fill_latency_)};
}

int FetchUnit::find_line(std::uint32_t mva, std::uint32_t pa) {
  if (ledger_.cycle < fill.last && fill.line != (mva & ~31u))
    ledger_.stall_to(fill.last, Cause::kIcache, fill.pa, kService);
  if (const int index = icache_.find(mva); index >= 0) {
    if (ledger_.cycle < fill.last)  // of this line
      ledger_.stall_to(fill.word(mva), Cause::kIcache, fill.pa, kService);
    return index;
  }
  fill_line(mva, pa);
  return icache_.find(mva);
}

void FetchUnit::forget_lines() {
  for (auto* lines : {&decoded_, &ram_decoded_})
    for (DecodedLine& d : *lines) d.valid = 0;
  jumps.fill(&no_line_);
  icache_.forget();
  leave_line();
}

bool FetchUnit::read_ahead(std::uint32_t pa) {
  if ((pa & ~15u) != buffer_pa_ || branched || redirects_seen_ != ledger_.counts.redirects) {
    access_.asked = data_bus_.asked_now();
    ledger_.stall_to(fill.last, Cause::kIcache, fill.pa, kService);
    const std::uint32_t first = pa & ~15u;
    read(BusAccess::Kind::kIncr4, pa, first, 16);
    const std::uint64_t there = interface_.clock.edge_at_or_after(access_.last);
    ledger_.stall_on(access_, access_.last, there, there + fill_latency_, Cause::kUncached);
    if (access_.error) {
      buffer_pa_ = 1;
      return false;
    }
    std::memcpy(words_, access_.data, 16);
    buffer_pa_ = first;
  }
  branched = false;
  redirects_seen_ = ledger_.counts.redirects;
  return true;
}

const Instruction* FetchUnit::decode(DecodedLine& d, const std::uint8_t* bytes,
                                     const FetchTarget& target, bool ram) {
  const std::uint32_t line = target.pc & ~31u;
  if (d.stale(target.thumb) || d.va != line) {
    log_.line_changes(d);
    if (profile_) profile_->collect(d);
  }
  if (d.stale(target.thumb)) d.clear(target.thumb, profile_);
  d.valid = key(target.pc, target.thumb);
  d.va = line;
  const unsigned at = target.index();
  Instruction& i = d.records[at];
  if (!i.body) {
    i = decode_at(bytes, at, target.thumb);
    RecordContext context = ram ? RecordContext{} : record_context(d, at, bytes, target.thumb);
    context.in_line = true;
    if (profile_) {
      const RecordContext counting = this->context(i, target.pc);
      context.counted = counting.counted;
      context.away = counting.away;
    }
    d.prepare_record(Instruction(i), at, context, shifted_cycle_);
  }
  if (current && current->va + 32 == line) current->next = &d;
  knows_ram_ |= ram;
  line_va = line;
  line_thumb = target.thumb ? 0x20u : 0u;
  current = &d;
  jumps[target.pc / 32 % kJumps] = &d;
  return &i;
}

const Instruction* FetchUnit::decode_uncached(std::uint32_t pa, const FetchTarget& target) {
  leave_line();
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(words_);
  log_.line_changes(uncached_);
  const Instruction decoded = decode_at(bytes, (pa & 15u) >> target.shift(), target.thumb);
  return uncached_.hold_one(decoded, target.pc, context(decoded, target.pc), shifted_cycle_);
}

void FetchUnit::invalidate_all() {
  icache_.invalidate_all();
  for (auto& d : decoded_) d.valid = 0;
  leave_line();
  buffer_pa_ = 1;
}

void FetchUnit::patch(std::uint32_t mva, std::uint32_t pa, std::span<const std::uint8_t> bytes) {
  if (const int i = icache_.find(mva); i >= 0) {
    const auto n = static_cast<unsigned>(i);
    std::memcpy(icache_.data(n) + (mva & 31u), bytes.data(), bytes.size());
    decoded_[n].valid = 0;
    leave_line();
  }
  auto* const words = reinterpret_cast<std::uint8_t*>(words_);
  for (std::size_t k = 0; k < bytes.size(); ++k)
    if (const std::uint32_t d = pa + static_cast<std::uint32_t>(k) - buffer_pa_;
        buffer_pa_ != 1 && d < sizeof words_)
      words[d] = bytes[k];
}

}  // namespace fovea::cpu
