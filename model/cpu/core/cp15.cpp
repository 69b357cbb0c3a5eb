// CP15: control, MMU and cache registers, cache operations, wait for interrupt.
#include "model/cpu/core/fast_path.h"

namespace fovea::cpu {
namespace {

/// Number of a register: opc1, CRn, CRm, opc2.
constexpr std::uint32_t id(unsigned op1, unsigned crn, unsigned crm, unsigned op2) {
  return op1 << 12 | crn << 8 | crm << 4 | op2;
}

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
  if (!privileged()) return undefined();
  const std::uint32_t reg = id(op1, crn, crm, op2);
  spend(1);
  ++counts_.coprocessor;
  if (i.op == Op::kMrc) {
    std::uint32_t value = 0;
    if (!cp15_read(reg, value)) return undefined();
    if (i.rd == 15) {
      cpsr_ = (cpsr_ & 0x0FFFFFFFu) | (value & 0xF0000000u);
      spend(2);
    } else {
      r_[i.rd] = value;
      produce(i.rd, 1);
    }
    return;
  }
  if (!cp15_write(reg, i.rd == 15 ? pc_ + 12 : r_[i.rd])) return undefined();
}

bool Core::cp15_read(std::uint32_t reg, std::uint32_t& v) {
  switch (reg) {
    case id(0, 0, 0, 0): v = 0x41069265u; return true;
    case id(0, 0, 0, 1):
      v = 0x1D000000u | size_field(params_.dcache.size()) << 12 |
          size_field(params_.icache.size());
      return true;
    case id(0, 0, 0, 2): v = tcm_.empty() ? 0 : 0x00010001u; return true;
    case id(0, 1, 0, 0): v = control_; return true;
    case id(0, 2, 0, 0): v = ttbr_; return true;
    case id(0, 3, 0, 0): v = dacr_; return true;
    case id(0, 5, 0, 0): v = dfsr_; return true;
    case id(0, 5, 0, 1): v = ifsr_; return true;
    case id(0, 6, 0, 0): v = far_; return true;
    case id(0, 7, 10, 3):
    case id(0, 7, 14, 3): {  // test and clean (and invalidate, once all lines are clean)
      stall_to(cycle_ + test_clean_cycles_, Cause::kCacheOp);
      for (unsigned n = 0; n < dcache_.lines(); ++n) {
        if (dcache_.line(n).tag == 1 || dcache_.line(n).dirty == 0) continue;
        write_back(n, Cause::kCacheOp);
        v = 0;
        return true;
      }
      if (reg == id(0, 7, 14, 3)) dcache_.invalidate_all();
      v = 1u << 30;
      return true;
    }
    case id(0, 9, 0, 0): v = dlock_; return true;
    case id(0, 9, 0, 1): v = ilock_; return true;
    case id(0, 9, 1, 0): v = dtcm_region_; return true;
    case id(0, 9, 1, 1): v = itcm_region_; return true;
    case id(0, 10, 0, 0): v = tlb_lock_; return true;
    case id(0, 13, 0, 0): v = fcse_pid_; return true;
    case id(0, 13, 0, 1): v = context_id_; return true;
    case id(0, 15, 0, 0): v = debug_override_; return true;
    case id(7, 15, 0, 0): v = cache_debug_; return true;
    default: break;
  }
  if ((reg >> 8 & 15u) == 0) {  // c0: undefined codes read the main ID register
    v = 0x41069265u;
    return true;
  }
  return false;
}

/// Called after a change of the process ID or of the control register: two instructions are already
/// in the pipeline. If a second change follows, the instructions after it see both at once
/// (assumed).
void Core::begin_old_fetch() {
  const bool same = old_fetch_left_ || (process_ == fetch_process_ &&
                                        !((control_ ^ fetch_control_) & kFetchBits));
  old_fetch_left_ = same ? 0 : 3;
  old_fetch_pc_ = next_pc_;
  if (same) {
    fetch_process_ = process_;
    if (fetch_control_ != control_) fetch_buffer_pa_ = 1;
    fetch_control_ = control_;
  }
  flush_memos();
}

bool Core::cp15_write(std::uint32_t reg, std::uint32_t v) {
  switch (reg) {
    case id(0, 1, 0, 0):
      control_ = (v & 0x0000F387u) | 0x0005'0078u;
      process_ = control_ & 1u ? fcse_pid_ : 0;
      counts_.translate(control_ & 1u);
      begin_old_fetch();
      return true;
    case id(0, 2, 0, 0): ttbr_ = v; return true;
    case id(0, 3, 0, 0): dacr_ = v; flush_memos(); return true;
    case id(0, 5, 0, 0): dfsr_ = v; return true;
    case id(0, 5, 0, 1): ifsr_ = v; return true;
    case id(0, 6, 0, 0): far_ = v; return true;
    case id(0, 9, 0, 0): dlock_ = v & 15u; return true;
    case id(0, 9, 0, 1): ilock_ = v & 15u; return true;
    case id(0, 9, 1, 0):
    case id(0, 9, 1, 1): {
      if (tcm_.empty()) return true;
      // The chip fixes the address and size of the regions; only the enable bit can be changed.
      auto& region = reg == id(0, 9, 1, 0) ? dtcm_region_ : itcm_region_;
      auto& size = reg == id(0, 9, 1, 0) ? dtcm_size_ : itcm_size_;
      if ((v & 0xFFFFF000u) != (region & 0xFFFFF000u))
        Diagnostics::instance().not_modelled("moving a TCM region by CP15 c9,c1");
      region = (region & ~1u) | (v & 1u);
      size = (v & 1u) ? 32 * 1024 : 0;
      flush_memos();
      return true;
    }
    case id(0, 10, 0, 0): tlb_lock_ = v & 0x1C000001u; return true;
    case id(0, 13, 0, 0):
      fcse_pid_ = v & 0xFE000000u;
      process_ = control_ & 1u ? fcse_pid_ : 0;
      begin_old_fetch();
      return true;
    case id(0, 13, 0, 1): context_id_ = v; return true;
    case id(0, 15, 0, 0): debug_override_ = v; return true;
    case id(7, 15, 0, 0): cache_debug_ = v & 7u; return true;
    default: break;
  }
  if ((reg >> 8) == 8) {  // TLB operations; all three values of CRm act on the unified TLB
    if ((reg & 15u) == 0) tlb_.invalidate_all();
    else tlb_.invalidate(v & ~0x3FFu);
    flush_memos();
    return true;
  }
  if ((reg >> 8) == 7) return cache_operation((reg >> 4) & 15u, reg & 15u, v);
  return false;
}

bool Core::cache_operation(unsigned crm, unsigned op2, std::uint32_t v) {
  const auto all = [this] {
    stall_to(cycle_ + invalidate_all_cycles_, Cause::kCacheOp);
  };
  const auto one = [this] { stall_to(cycle_ + cache_op_cycles_, Cause::kCacheOp); };
  const auto invalidate_i = [this](int n) {
    if (n < 0) return;
    icache_.invalidate(static_cast<unsigned>(n));
    decoded_[static_cast<unsigned>(n)].valid = 0;
    line_va_ = 1;
  };
  const auto by_set_way = [](const Cache& c, std::uint32_t w) {
    return static_cast<int>(((w >> 5) & (c.sets() - 1)) * Cache::kWays + (w >> 30));
  };
  const auto clean_d = [this](int n) {
    if (n >= 0 && dcache_.line(static_cast<unsigned>(n)).tag != 1)
      write_back(static_cast<unsigned>(n), Cause::kCacheOp);
  };
  const auto invalidate_d = [this](int n) {
    if (n >= 0) dcache_.invalidate(static_cast<unsigned>(n));
  };
  const auto invalidate_all_i = [this] {
    icache_.invalidate_all();
    for (auto& d : decoded_) d.valid = 0;
    line_va_ = 1;
    fetch_buffer_pa_ = 1;
  };
  // The register holds a modified address, so FCSE does not apply (ARM DDI 0198D 2-34).
  const std::uint32_t mva = v & ~31u;
  switch (crm << 4 | op2) {
    case 0x04: wait_for_interrupt(); return true;
    case 0x50: all(); invalidate_all_i(); return true;
    case 0x51: one(); invalidate_i(icache_.find(mva)); return true;
    case 0x52: one(); invalidate_i(by_set_way(icache_, v)); return true;
    case 0x60: all(); dcache_.invalidate_all(); return true;
    case 0x61: one(); invalidate_d(dcache_.find(mva)); return true;
    case 0x62: one(); invalidate_d(by_set_way(dcache_, v)); return true;
    case 0x70: all(); invalidate_all_i(); dcache_.invalidate_all(); return true;
    case 0xA1: one(); clean_d(dcache_.find(mva)); return true;
    case 0xA2: one(); clean_d(by_set_way(dcache_, v)); return true;
    case 0xA4: drain(Cause::kDrain); return true;
    case 0xD1: {
      const Translation* t = translate(mva, false, false, true);
      if (t && (control_ >> 12 & 1u) && (t->cacheable || !(control_ & 1u)) &&
          !in_tcm(t->physical(mva)) && icache_.find(mva) < 0)
        icache_fill(mva, t->physical(mva));
      line_va_ = 1;
      return true;
    }
    case 0xE1: one(); clean_d(dcache_.find(mva)); invalidate_d(dcache_.find(mva)); return true;
    case 0xE2: {
      one();
      const int n = by_set_way(dcache_, v);
      clean_d(n);
      invalidate_d(n);
      return true;
    }
    default: return false;
  }
}

Counts Core::counts_asleep(Picoseconds t) const {
  Counts c = counts_;
  c.cycles = clock_.running() ? std::max(cycle_, clock_.edge_after(t)) : cycle_;
  c.idle += c.cycles - cycle_;
  return c;
}

/// Sleeps until IRQ or FIQ is asserted, even if masked.
void Core::wait_for_interrupt() {
  drain(Cause::kDrain);
  const std::uint64_t begin = cycle_;
  if (!((irq_.level && irq_.since < time(cycle_)) || (fiq_.level && fiq_.since < time(cycle_)))) {
    const Picoseconds at = port_.wait_for_interrupt(time(cycle_));
    const std::uint64_t wake = std::max(begin, clock_.edge_after(at));
    while (mark_pending_) {
      // The edge of the measurement window is within the sleep: split the idle time there.
      const std::uint64_t split = std::max(begin, clock_.edge_after(mark_at_));
      if (split > wake) break;
      counts_.idle += split - cycle_;
      cycle_ = split;
      snapshot();
    }
    counts_.idle += wake - cycle_;
    cycle_ = wake;
  }
  attention_ = true;
}

}  // namespace fovea::cpu
