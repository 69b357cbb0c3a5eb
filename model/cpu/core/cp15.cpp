// CP15: control, MMU and cache registers, cache operations, wait for interrupt.
#include "model/cpu/core/core.h"

namespace fovea::cpu {
namespace {

/// Number of a register: opc1, CRn, CRm, opc2.
constexpr std::uint32_t id(unsigned op1, unsigned crn, unsigned crm, unsigned op2) {
  return op1 << 12 | crn << 8 | crm << 4 | op2;
}

/// Bit 8 of a fault status register reads as zero, and writes to it are ignored (ARM DDI 0198D 2.3.7).
constexpr std::uint32_t kFaultStatusZero = 1u << 8;

/// Size field of the cache type register: write-back, lockdown format C (ARM DDI 0198D 2.3).
std::uint32_t size_field(std::uint64_t bytes) {
  unsigned code = 0;
  for (std::uint64_t s = 512; s < bytes; s *= 2) ++code;
  return code << 6 | 2u << 3 | 2u;  // 4 ways, 8 words a line
}

}  // namespace

void Core::coprocessor_move(const Instruction& i) {
  if (i.rs != 15) return undefined();
  const unsigned op1 = (i.raw >> 21) & 7u, crn = (i.raw >> 16) & 15u, crm = i.raw & 15u,
                 op2 = (i.raw >> 5) & 7u;
  if (!regs_.privileged()) return undefined();
  const std::uint32_t reg = id(op1, crn, crm, op2);
  spend(1);
  ++ledger_.counts.coprocessor;
  if (i.op == Op::kMrc) {
    std::uint32_t value = 0;
    if (!cp15_read(reg, value)) return undefined();
    if (i.rd == 15) {
      regs_.cpsr = (regs_.cpsr & 0x0FFFFFFFu) | (value & 0xF0000000u);
      spend(2);
    } else {
      regs_.r[i.rd] = value;
      produce(i.rd, 1);
    }
    return;
  }
  if (!cp15_write(reg, i.rd == 15 ? regs_.pc + 12 : regs_.r[i.rd])) return undefined();
}

bool Core::cp15_read(std::uint32_t reg, std::uint32_t& v) {
  switch (reg) {
    case id(0, 0, 0, 0): v = 0x41069265u; return true;
    case id(0, 0, 0, 1):
      v = 0x1D000000u | size_field(params_.dcache.size()) << 12 |
          size_field(params_.icache.size());
      return true;
    case id(0, 0, 0, 2): v = ram_.empty() ? 0 : 0x00010001u; return true;
    case id(0, 1, 0, 0): v = system_.control; return true;
    case id(0, 2, 0, 0): v = system_.ttbr; return true;
    case id(0, 3, 0, 0): v = system_.dacr; return true;
    case id(0, 5, 0, 0): v = system_.dfsr; return true;
    case id(0, 5, 0, 1): v = system_.ifsr; return true;
    case id(0, 6, 0, 0): v = system_.far; return true;
    case id(0, 7, 10, 3): v = test_and_clean(false); return true;
    case id(0, 7, 14, 3): v = test_and_clean(true); return true;
    case id(0, 9, 0, 0): v = system_.dlock; return true;
    case id(0, 9, 0, 1): v = system_.ilock; return true;
    case id(0, 9, 1, 0): v = system_.dtcm_region; return true;
    case id(0, 9, 1, 1): v = system_.itcm_region; return true;
    case id(0, 10, 0, 0): v = system_.tlb_lock; return true;
    case id(0, 13, 0, 0): v = system_.fcse_pid; return true;
    case id(0, 13, 0, 1): v = system_.context_id; return true;
    case id(0, 15, 0, 0): v = system_.debug_override; return true;
    case id(7, 15, 0, 0): v = system_.cache_debug; return true;
    default: break;
  }
  if ((reg >> 8 & 15u) == 0) {  // c0: undefined codes read the main ID register
    v = 0x41069265u;
    return true;
  }
  return false;
}

/// Writes back one dirty line. If all lines are clean, reports so in Z and, if asked, invalidates
/// the cache.
std::uint32_t Core::test_and_clean(bool invalidate) {
  ledger_.stall_to(ledger_.cycle + test_clean_cycles_, Cause::kCacheOp);
  Cache& lines = data_.lines();
  for (unsigned n = 0; n < lines.lines(); ++n) {
    if (lines.line(n).tag == 1 || lines.line(n).dirty == 0) continue;
    data_.write_back(n, Cause::kCacheOp);
    return 0;
  }
  if (invalidate) lines.invalidate_all();
  return kZ;
}

/// Called after a change of the process ID or of the control register.
void Core::settings_changed() {
  system_.process = system_.mmu_on() ? system_.fcse_pid : 0;
  fetch_.settings_changed(next_pc_);
  forget_translations();
}

/// The chip fixes the address and size of the regions of internal RAM; only the enable bit can be
/// changed.
void Core::set_ram_region(bool data, std::uint32_t value) {
  if (ram_.empty()) return;
  std::uint32_t& region = data ? system_.dtcm_region : system_.itcm_region;
  if ((value & 0xFFFFF000u) != (region & 0xFFFFF000u)) diagnostics_.not_modelled("moving a TCM region by CP15 c9,c1");
  region = (region & ~1u) | (value & 1u);
  const std::uint32_t bytes = (value & 1u) ? ram_.size() : 0;
  data ? ram_.set_dtcm(bytes) : ram_.set_itcm(bytes);
  forget_translations();
}

bool Core::cp15_write(std::uint32_t reg, std::uint32_t v) {
  switch (reg) {
    case id(0, 1, 0, 0):
      system_.control = (v & 0x0000F387u) | 0x0005'0078u;
      ledger_.counts.translate(system_.mmu_on());
      settings_changed();
      return true;
    case id(0, 2, 0, 0): system_.ttbr = v; return true;
    case id(0, 3, 0, 0): system_.dacr = v; forget_translations(); return true;
    case id(0, 5, 0, 0): system_.dfsr = v & ~kFaultStatusZero; return true;
    case id(0, 5, 0, 1): system_.ifsr = v & ~kFaultStatusZero; return true;
    case id(0, 6, 0, 0): system_.far = v; return true;
    case id(0, 9, 0, 0): system_.dlock = v & 15u; return true;
    case id(0, 9, 0, 1): system_.ilock = v & 15u; return true;
    case id(0, 9, 1, 0): set_ram_region(true, v); return true;
    case id(0, 9, 1, 1): set_ram_region(false, v); return true;
    case id(0, 10, 0, 0): system_.tlb_lock = v & 0x1C000001u; return true;
    case id(0, 13, 0, 0):
      system_.fcse_pid = v & 0xFE000000u;
      settings_changed();
      return true;
    case id(0, 13, 0, 1): system_.context_id = v; return true;
    case id(0, 15, 0, 0): system_.debug_override = v; return true;
    case id(7, 15, 0, 0): system_.cache_debug = v & 7u; return true;
    default: break;
  }
  if ((reg >> 8) == 8) {  // TLB operations; all three values of CRm act on the unified TLB
    if ((reg & 15u) == 0) mmu_.invalidate_all();
    else mmu_.invalidate(v & ~0x3FFu);
    forget_translations();
    return true;
  }
  if ((reg >> 8) == 7) return cache_operation((reg >> 4) & 15u, reg & 15u, v);
  return false;
}

void Core::clean_line(int line) {
  if (line >= 0 && data_.lines().line(static_cast<unsigned>(line)).tag != 1)
    data_.write_back(static_cast<unsigned>(line), Cause::kCacheOp);
}

void Core::clean_and_invalidate_line(int line) {
  clean_line(line);
  if (line >= 0) data_.lines().invalidate(static_cast<unsigned>(line));
}

void Core::prefetch_line(std::uint32_t mva) {
  const bool mmu = system_.mmu_on();
  const Translation* const t =
      mmu ? translated(mmu_.translate(mva, Access::kFetch, !regs_.privileged())) : &mmu_.flat();
  if (t && (system_.control & kIcacheOn) && (t->cacheable || !mmu) &&
      !ram_.contains(t->physical(mva)) && fetch_.icache().find(mva) < 0)
    fetch_.fill_line(mva, t->physical(mva));
  fetch_.leave_line();
}

bool Core::cache_operation(unsigned crm, unsigned op2, std::uint32_t v) {
  const auto all = [this] {
    ledger_.stall_to(ledger_.cycle + invalidate_all_cycles_, Cause::kCacheOp);
  };
  const auto one = [this] {
    ledger_.stall_to(ledger_.cycle + cache_op_cycles_, Cause::kCacheOp);
  };
  const auto by_set_way = [v](const Cache& c) {
    return static_cast<int>(((v >> 5) & (c.sets() - 1)) * Cache::kWays + (v >> 30));
  };
  const auto invalidate_i = [this](int line) {
    if (line >= 0) fetch_.invalidate_line(static_cast<unsigned>(line));
  };
  Cache& data = data_.lines();
  const auto invalidate_d = [&data](int line) {
    if (line >= 0) data.invalidate(static_cast<unsigned>(line));
  };
  // The register holds a modified address, so FCSE does not apply (ARM DDI 0198D 2-34).
  const std::uint32_t mva = v & ~31u;
  switch (crm << 4 | op2) {
    case 0x04: wait_for_interrupt(); return true;
    case 0x50: all(); fetch_.invalidate_all(); return true;
    case 0x51: one(); invalidate_i(fetch_.icache().find(mva)); return true;
    case 0x52: one(); invalidate_i(by_set_way(fetch_.icache())); return true;
    case 0x60: all(); data.invalidate_all(); return true;
    case 0x61: one(); invalidate_d(data.find(mva)); return true;
    case 0x62: one(); invalidate_d(by_set_way(data)); return true;
    case 0x70: all(); fetch_.invalidate_all(); data.invalidate_all(); return true;
    case 0xA1: one(); clean_line(data.find(mva)); return true;
    case 0xA2: one(); clean_line(by_set_way(data)); return true;
    case 0xA4: bus_.drain(Cause::kDrain); return true;
    case 0xD1: prefetch_line(mva); return true;
    case 0xE1: one(); clean_and_invalidate_line(data.find(mva)); return true;
    case 0xE2: one(); clean_and_invalidate_line(by_set_way(data)); return true;
    default: return false;
  }
}

Counts Core::counts_asleep(Picoseconds t) const {
  const Clock& clock = interface_.clock;
  Counts c = ledger_.counts;
  c.cycles = clock.running() ? std::max(ledger_.cycle, clock.edge_after(t)) : ledger_.cycle;
  c.idle += c.cycles - ledger_.cycle;
  c.idle_by[static_cast<std::size_t>(WakeEvent::kOther)] += c.cycles - ledger_.cycle;
  return c;
}

/// Sleeps until IRQ or FIQ is asserted, even if masked.
void Core::wait_for_interrupt() {
  bus_.drain(Cause::kDrain);
  interface_.attention = true;
  const std::uint64_t begin = ledger_.cycle;
  const Picoseconds now = time(begin);
  if ((irq_.level && irq_.since < now) || (fiq_.level && fiq_.since < now)) return;
  const Picoseconds at = interface_.port.wait_for_interrupt(now);
  const std::uint64_t wake = std::max(begin, interface_.clock.edge_after(at));
  const WakeEvent by = wake_event ? wake_event() : WakeEvent::kOther;
  while (marks_pending()) {
    // The edge of the measurement window is within the sleep: split the idle time there.
    const std::uint64_t split = std::max(begin, interface_.clock.edge_after(next_mark()));
    if (split > wake) break;
    ledger_.sleep_to(split, by);
    take_marks(interface_.time(split));
  }
  ledger_.sleep_to(wake, by);
  woke_ = wake;
  interface_.attention = true;
}

}  // namespace fovea::cpu
