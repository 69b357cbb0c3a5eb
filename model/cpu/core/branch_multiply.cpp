// Handlers of branches, multiplies and CLZ. Cycle counts: ARM DDI 0222B chapter 8.
#include "model/cpu/core/handlers.h"

namespace fovea::cpu {

template <Op kOp, bool kSet>
Core::Ops::Next Core::Ops::multiply(Core& c, Next i, Cycle cycle) {
  ++c.ledger_.counts.multiplies;
  if constexpr (kOp == Op::kMul || kOp == Op::kMla) {
    // In the encoding, Rd is in bits 19:16 and the accumulator in bits 15:12.
    const auto& r = c.regs_.r;
    const std::uint32_t v = r[i->rm] * r[i->rs] + (kOp == Op::kMla ? r[i->rd] : 0);
    c.regs_.r[i->rn] = v;
    if constexpr (kSet) {
      c.regs_.n = c.regs_.z = v;
      return next(c, i + 1, cycle + 4);
    }
    track(c, i->rn, cycle + 3, Scoreboard::kMultiply);
    return next(c, i + 1, cycle + 2);
  } else {
    std::uint64_t v;
    if constexpr (kOp == Op::kUmull || kOp == Op::kUmlal)
      v = std::uint64_t{c.regs_.r[i->rm]} * c.regs_.r[i->rs];
    else
      v = static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(c.regs_.r[i->rm])} *
                                     static_cast<std::int32_t>(c.regs_.r[i->rs]));
    if constexpr (kOp == Op::kUmlal || kOp == Op::kSmlal)
      v += std::uint64_t{c.regs_.r[i->rn]} << 32 | c.regs_.r[i->rd];
    c.regs_.r[i->rd] = static_cast<std::uint32_t>(v);
    c.regs_.r[i->rn] = static_cast<std::uint32_t>(v >> 32);
    if constexpr (kSet) {
      c.regs_.n = c.regs_.r[i->rn];
      c.regs_.z = v != 0;
      return next(c, i + 1, cycle + 5);
    }
    track(c, i->rn, cycle + 4, Scoreboard::kMultiply);
    return next(c, i + 1, cycle + 3);
  }
}

Handler Core::Ops::multiply_body(Instruction& i) {
  const bool set = i.flags & kSetFlags;
  switch (i.op) {
    case Op::kMul: return set ? &multiply<Op::kMul, true> : &multiply<Op::kMul, false>;
    case Op::kMla: return set ? &multiply<Op::kMla, true> : &multiply<Op::kMla, false>;
    case Op::kUmull: return set ? &multiply<Op::kUmull, true> : &multiply<Op::kUmull, false>;
    case Op::kUmlal: return set ? &multiply<Op::kUmlal, true> : &multiply<Op::kUmlal, false>;
    case Op::kSmull: return set ? &multiply<Op::kSmull, true> : &multiply<Op::kSmull, false>;
    default: return set ? &multiply<Op::kSmlal, true> : &multiply<Op::kSmlal, false>;
  }
}

Core::Ops::Next Core::Ops::count_zeros(Core& c, Next i, Cycle cycle) {
  c.regs_.r[i->rd] = static_cast<std::uint32_t>(std::countl_zero(c.regs_.r[i->rm]));
  return next(c, i + 1, cycle + 1);
}

/// B and BL. imm: target relative to the first byte of the line. kNear: the target is in the same
/// line, and raw is the distance of its record in host memory, in bytes; otherwise raw is its
/// record_offset().
template <unsigned kCond, bool kLink, bool kThumb, bool kNear, bool kCounted>
Core::Ops::Next Core::Ops::branch(Core& c, Next i, Cycle cycle) {
  if (!passes<kCond>(c)) return next(c, i + 1, cycle + 1);
  if constexpr (kLink) c.regs_.r[14] = c.chain_.va + i->at + 4;
  if constexpr (kCounted) ++c.fetch_.current->tally(*i).special;
  if constexpr (kCounted && kLink) c.follow_call(i, cycle + 3, c.chain_.va + i->imm);
  if constexpr (kNear) {
    ++c.ledger_.counts.redirects;
    const std::intptr_t distance = static_cast<std::int32_t>(i->raw);
    c.chain_.first += distance - static_cast<std::intptr_t>(sizeof(Instruction));
    return next(c, reinterpret_cast<Next>(reinterpret_cast<const char*>(i) + distance), cycle + 3);
  } else {
    return jump<kThumb, false, kCounted>(c, i, cycle + 3, c.chain_.va + i->imm, i->raw);
  }
}

/// A branch to another function; its condition is met. imm: as branch().
template <bool kThumb>
Core::Ops::Next Core::Ops::branch_away(Core& c, Next i, Cycle cycle) {
  const std::uint32_t target = c.chain_.va + i->imm;
  c.follow_tail_call(cycle + 3, target);
  return jump<kThumb, true, true>(c, i, cycle + 3, target);
}

template <bool kThumb, bool kLink, bool kCounted>
Core::Ops::Next Core::Ops::branch_exchange(Core& c, Next i, Cycle cycle) {
  const std::uint32_t target = c.regs_.r[i->rm];
  if constexpr (kLink) {
    const std::uint32_t pc = c.chain_.va + i->at;
    c.regs_.r[14] = kThumb ? (pc + 2) | 1u : pc + 4;
  }
  if constexpr (kCounted) {
    if (kLink)
      c.follow_call(i, cycle + 3, target);
    else
      c.follow_jump(i, cycle + 3, target);
  }
  return exchange<kThumb, kCounted>(c, i, cycle + 3, target);
}

/// imm: relative to the first byte of the line.
Core::Ops::Next Core::Ops::thumb_link_prefix(Core& c, Next i, Cycle cycle) {
  c.regs_.r[14] = c.chain_.va + i->imm;
  return next(c, i + 1, cycle + 1);
}
template <bool kCounted>
Core::Ops::Next Core::Ops::thumb_link_suffix(Core& c, Next i, Cycle cycle) {
  const std::uint32_t target = c.regs_.r[14] + i->imm;
  c.regs_.r[14] = (c.chain_.va + i->at + 2) | 1u;
  if constexpr (kCounted) c.follow_call(i, cycle + 3, target);
  return jump<true, true, kCounted>(c, i, cycle + 3, target & ~1u);
}

Handler Core::Ops::branch_body(Instruction& i, Context context) {
  return context.counted ? branch_handler<true>(i, context) : branch_handler<false>(i, context);
}

template <bool kCounted>
Handler Core::Ops::branch_handler(Instruction& i, Context context) {
  const bool thumb = i.flags & kThumbInsn;
  if (i.op == Op::kBxReg)
    return thumb ? &branch_exchange<true, false, kCounted>
                 : &branch_exchange<false, false, kCounted>;
  if (i.op == Op::kBlxReg)
    return thumb ? &branch_exchange<true, true, kCounted> : &branch_exchange<false, true, kCounted>;
  if (i.op == Op::kThumbBlSuffix)
    return (i.flags & kSpsr) ? nullptr : &thumb_link_suffix<kCounted>;
  // From here on, imm is not relative to the pc but to the beginning of the line.
  i.imm += i.at + (thumb ? 4u : kPcDelayArm);
  i.flags = static_cast<std::uint16_t>(i.flags & ~kReadsPc);
  if (i.op == Op::kThumbBlPrefix) return &thumb_link_prefix;
  if (kCounted && context.away) {
    i.flags = static_cast<std::uint16_t>(i.flags | kAway);
    return thumb ? &branch_away<true> : &branch_away<false>;
  }
  const bool near = context.in_line && i.imm < 32;
  if (near) {
    const auto from = static_cast<std::int32_t>(i.at), to = static_cast<std::int32_t>(i.imm);
    i.raw = static_cast<std::uint32_t>((to - from) / (thumb ? 2 : 4) *
                                       static_cast<std::int32_t>(sizeof(Instruction)));
  } else {
    i.raw = thumb ? record_offset<true>(i.imm) : record_offset<false>(i.imm);
  }
  const bool link = i.op == Op::kBl;
  return select(i.cond, [&](auto k) -> Handler {
    constexpr auto kCond = static_cast<unsigned>(decltype(k)::value);
    if (link)
      return near ? &branch<kCond, true, false, true, kCounted>
                  : &branch<kCond, true, false, false, kCounted>;
    if (thumb)
      return near ? &branch<kCond, false, true, true, kCounted>
                  : &branch<kCond, false, true, false, kCounted>;
    return near ? &branch<kCond, false, false, true, kCounted>
                : &branch<kCond, false, false, false, kCounted>;
  }, std::make_index_sequence<15>{});
}

}  // namespace fovea::cpu
