// Enhanced DSP instructions, and moves of the status registers. Cycle counts: ARM DDI 0222B chapter
// 8.
#include "model/cpu/core/core.h"

namespace fovea::cpu {
namespace {

std::int32_t half(std::uint32_t v, bool top) {
  return static_cast<std::int16_t>(top ? v >> 16 : v);
}

std::uint32_t saturate(std::int64_t v, bool& q) {
  if (v > INT32_MAX) {
    q = true;
    return INT32_MAX;
  }
  if (v < INT32_MIN) {
    q = true;
    return 0x80000000u;
  }
  return static_cast<std::uint32_t>(v);
}

}  // namespace

void Core::dsp(const Instruction& i) {
  bool q = false;
  if (is_multiplication(i.op)) ++ledger_.counts.multiplies;
  const auto s = [this](unsigned r) { return std::int64_t{static_cast<std::int32_t>(regs_.r[r])}; };
  unsigned cycles = 1;
  switch (i.op) {
    case Op::kSmulxy:
      regs_.r[i.rn] = static_cast<std::uint32_t>(half(regs_.r[i.rm], i.flags & kTop1) *
                                            half(regs_.r[i.rs], i.flags & kTop2));
      multiplied(i.rn, 2);
      break;
    case Op::kSmlaxy: {
      const std::int64_t v = std::int64_t{half(regs_.r[i.rm], i.flags & kTop1)} *
                                 half(regs_.r[i.rs], i.flags & kTop2) + s(i.rd);
      if (v != static_cast<std::int32_t>(v)) q = true;
      regs_.r[i.rn] = static_cast<std::uint32_t>(v);
      multiplied(i.rn, 2);
      break;
    }
    case Op::kSmulwy:
      regs_.r[i.rn] = static_cast<std::uint32_t>(
          (s(i.rm) * half(regs_.r[i.rs], i.flags & kTop2)) >> 16);
      multiplied(i.rn, 2);
      break;
    case Op::kSmlawy: {
      const std::int64_t v = ((s(i.rm) * half(regs_.r[i.rs], i.flags & kTop2)) >> 16) + s(i.rd);
      if (v != static_cast<std::int32_t>(v)) q = true;
      regs_.r[i.rn] = static_cast<std::uint32_t>(v);
      multiplied(i.rn, 2);
      break;
    }
    case Op::kSmlalxy: {
      std::uint64_t v = std::uint64_t{regs_.r[i.rn]} << 32 | regs_.r[i.rd];
      v += static_cast<std::uint64_t>(std::int64_t{half(regs_.r[i.rm], i.flags & kTop1)} *
                                      half(regs_.r[i.rs], i.flags & kTop2));
      regs_.r[i.rd] = static_cast<std::uint32_t>(v);
      regs_.r[i.rn] = static_cast<std::uint32_t>(v >> 32);
      cycles = 2;
      break;
    }
    case Op::kQadd: regs_.r[i.rd] = saturate(s(i.rm) + s(i.rn), q); produce(i.rd, 2); break;
    case Op::kQsub: regs_.r[i.rd] = saturate(s(i.rm) - s(i.rn), q); produce(i.rd, 2); break;
    case Op::kQdadd: {
      const std::uint32_t twice = saturate(2 * s(i.rn), q);
      regs_.r[i.rd] = saturate(s(i.rm) + static_cast<std::int32_t>(twice), q);
      produce(i.rd, 2);
      break;
    }
    default: {
      const std::uint32_t twice = saturate(2 * s(i.rn), q);
      regs_.r[i.rd] = saturate(s(i.rm) - static_cast<std::int32_t>(twice), q);
      produce(i.rd, 2);
      break;
    }
  }
  if (q) regs_.cpsr |= kQ;
  spend(cycles);
}

void Core::status(const Instruction& i) {
  if (i.op == Op::kMrs) {
    regs_.r[i.rd] = (i.flags & kSpsr) ? regs_.spsr() : regs_.cpsr;
    spend(2);
    return;
  }
  const std::uint32_t v = i.operand == Operand::kReg ? regs_.r[i.rm] : i.imm;
  std::uint32_t fields = 0;
  for (unsigned f = 0; f < 4; ++f)
    if (i.rs >> f & 1u) fields |= 0xFFu << (8 * f);
  fields &= 0xF80000FFu;
  if (i.flags & kSpsr) {
    std::uint32_t& s = regs_.spsr();
    s = (s & ~fields) | (v & fields);
  } else {
    if (!regs_.privileged()) fields &= 0xF8000000u;
    // MSR does not change the T bit.
    set_cpsr((regs_.cpsr & ~fields) | (v & fields & ~kThumbState) | (regs_.cpsr & kThumbState));
  }
  spend(i.rs == 8 && !(i.flags & kSpsr) ? 1 : 3);
}

}  // namespace fovea::cpu
