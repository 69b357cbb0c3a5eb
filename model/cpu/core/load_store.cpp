// Handlers of loads and stores that hit a hint. Everything else ends the chain and is executed in
// transfers.cpp. Cycle counts and interlocks: ARM DDI 0222B chapter 8.
#include <bit>

#include "model/cpu/core/handlers.h"

namespace fovea::cpu {
namespace {

template <Op kOp>
[[gnu::always_inline]] inline std::uint32_t read(const std::uint8_t* from) {
  if constexpr (kOp == Op::kLdr) {
    std::uint32_t v;
    std::memcpy(&v, from, 4);
    return v;
  } else if constexpr (access_bytes(kOp) == 2) {
    std::uint16_t v;
    std::memcpy(&v, from, 2);
    return kOp == Op::kLdrh ? v : static_cast<std::uint32_t>(static_cast<std::int16_t>(v));
  } else {
    return kOp == Op::kLdrb ? *from : static_cast<std::uint32_t>(static_cast<std::int8_t>(*from));
  }
}

[[gnu::always_inline]] inline std::uint8_t* host(std::uintptr_t bias, std::uint32_t va) {
  return reinterpret_cast<std::uint8_t*>(bias + va);
}

/// Number of the lowest set bit; `set` must not be 0.
[[gnu::always_inline]] inline unsigned lowest(std::uint32_t set) {
  return static_cast<unsigned>(__builtin_ctz(set));
}

/// Copies 1 to 16 words.
[[gnu::always_inline]] inline void copy_words(void* to, const void* from, unsigned words) {
  auto* t = static_cast<std::uint8_t*>(to);
  const auto* f = static_cast<const std::uint8_t*>(from);
  if (words & 1u) {
    std::memcpy(t, f, 4);
    t += 4, f += 4;
  }
  if (words & 2u) {
    std::memcpy(t, f, 8);
    t += 8, f += 8;
  }
  for (words /= 4; words; --words, t += 16, f += 16) std::memcpy(t, f, 16);
}

/// Registers of a block that follow each other from its first one on.
[[gnu::always_inline]] inline unsigned first_run(const Instruction& i) { return i.raw & 0xFFu; }

/// Base plus offset; an immediate offset is signed (see memory_body()).
template <Address kAddress>
[[gnu::always_inline]] inline std::uint32_t moved(const std::array<std::uint32_t, 16>& r,
                                                  const Instruction& i) {
  switch (kAddress) {
    case Address::kImm: return r[i.rn] + i.imm;
    case Address::kRegUp: return r[i.rn] + r[i.rm];
    case Address::kRegDown: return r[i.rn] - r[i.rm];
    default: return r[i.rn] + (r[i.rm] << i.amount);
  }
}

}  // namespace

template <Op kOp, Address kAddress, Indexed kIndexed, bool kTrack>
Core::Ops::Next Core::Ops::load(Core& c, Next i, Cycle cycle) {
  constexpr unsigned kBytes = access_bytes(kOp);
  const std::uint32_t end = moved<kAddress>(c.regs_.r, *i);
  const std::uint32_t va = kIndexed == Indexed::kPost ? c.regs_.r[i->rn] : end;
  const Hint& hint = c.data_.read_hint(va);
  if (hint.key != (va & ~(kReadSpan - kBytes)) || cycle < c.data_.fill.last) [[unlikely]]
    return load_line<kOp, kIndexed, kTrack>(c, i, cycle, va, end,
                                            kAddress == Address::kLsl ? 1u + i->rs : 1u);
  ++c.counter(hint);
  c.log_.note(i, va);
  const std::uint32_t value = read<kOp>(host(hint.bias, va));
  const unsigned rd = i->rd;
  if constexpr (kIndexed != Indexed::kOffset) c.regs_.r[i->rn] = end;
  c.regs_.r[rd] = value;
  // rs: the extra clock for a shifted offset.
  cycle += kAddress == Address::kLsl ? 1u + i->rs : 1u;
  if constexpr (kTrack) track(c, rd, cycle + (kOp == Op::kLdr ? 1 : 2), Scoreboard::kLoad);
  return next(c, i + 1, cycle);
}

/// A load without a hint (perhaps of a line that must be filled first), or during a line fill.
template <Op kOp, Indexed kIndexed, bool kTrack>
[[gnu::noinline]] Core::Ops::Next Core::Ops::load_line(Core& c, Next i, Cycle cycle,
                                                       std::uint32_t va, std::uint32_t end,
                                                       unsigned cycles) {
  constexpr unsigned kBytes = access_bytes(kOp);
  c.settle(i, cycle);
  const std::uint8_t* from;
  const Hint& hint = c.data_.read_hints[va / kReadSpan % kHints];
  if (hint.key == (va & ~(kReadSpan - kBytes)) &&
      hint.counter == c.data_.counter_offset(c.ledger_.counts.dcache_reads)) {
    c.log_.note(i, va);
    ++c.ledger_.counts.dcache_reads;
    c.data_.wait_for_fill(c.system_.modified(va));
    from = host(hint.bias, va);
  } else {
    from = c.load_cached<kBytes>(i, va);
    if (!from) return generic(c, i, cycle);
  }
  const std::uint32_t value = read<kOp>(from);
  if constexpr (kIndexed != Indexed::kOffset) c.regs_.r[i->rn] = end;
  c.regs_.r[i->rd] = value;
  c.spend(cycles);
  if constexpr (kTrack)
    track(c, i->rd, c.ledger_.cycle + (kOp == Op::kLdr ? 1 : 2), Scoreboard::kLoad);
  return over(c, i);
}

template <Op kOp, Address kAddress, Indexed kIndexed>
Core::Ops::Next Core::Ops::store(Core& c, Next i, Cycle cycle) {
  constexpr unsigned kBytes = access_bytes(kOp);
  const std::uint32_t end = moved<kAddress>(c.regs_.r, *i);
  const std::uint32_t va = kIndexed == Indexed::kPost ? c.regs_.r[i->rn] : end;
  const Hint& hint = c.data_.write_hints[va / kWriteSpan % kHints];
  if (hint.key != (va & ~(kWriteSpan - kBytes)) || cycle < c.data_.fill.last) [[unlikely]]
    return store_out<kOp, kAddress, kIndexed>(c, i, cycle);
  ++c.counter(hint);
  c.log_.note(i, va);
  const std::uint32_t value = c.regs_.r[i->rd];
  std::memcpy(host(hint.bias, va), &value, kBytes);
  if constexpr (kIndexed != Indexed::kOffset) c.regs_.r[i->rn] = end;
  return next(c, i + 1, cycle + (kAddress == Address::kLsl ? 1u + i->rs : 1u));
}

/// A store without a hint, perhaps to the write buffer.
template <Op kOp, Address kAddress, Indexed kIndexed>
[[gnu::noinline]] Core::Ops::Next Core::Ops::store_out(Core& c, Next i, Cycle cycle) {
  const std::uint32_t end = moved<kAddress>(c.regs_.r, *i);
  const std::uint32_t va = kIndexed == Indexed::kPost ? c.regs_.r[i->rn] : end;
  c.settle(i, cycle);
  if (c.data_.absent.key == (va & ~(kReadSpan - access_bytes(kOp))))
    c.store_absent<access_bytes(kOp)>(i, va, c.data_.absent.pa | va % kReadSpan, c.regs_.r[i->rd]);
  else if (!c.store_beside_cache<access_bytes(kOp)>(i, va, c.regs_.r[i->rd]))
    return generic(c, i, cycle);
  if constexpr (kIndexed != Indexed::kOffset) c.regs_.r[i->rn] = end;
  c.spend(kAddress == Address::kLsl ? 1u + i->rs : 1u);
  return over(c, i);
}

/// Continues after record i, a load or store that used the bus.
[[gnu::always_inline]] inline Core::Ops::Next Core::Ops::over(Core& c, Next i) {
  ++c.ledger_.counts.instructions;
  c.regs_.pc = c.chain_.va + i[1].at;
  c.chain_.first = reinterpret_cast<std::intptr_t>(i + 1);
  // As chain_goes_on(), without the conditions that such an access cannot change.
  const Cycle cycle = c.ledger_.cycle;
  if (cycle >= c.chain_.stop || cycle >= c.interface_.stop_cycle || c.interface_.attention ||
      !c.fetch_.current->valid || cycle < c.fetch_.fill.last) {
    c.ends_before(i + 1);
    return nullptr;
  }
  return go(c, i + 1, cycle);
}

/// A load relative to the pc; imm is relative to the first byte of the line.
Core::Ops::Next Core::Ops::load_literal(Core& c, Next i, Cycle cycle) {
  const std::uint32_t va = c.chain_.va + i->imm;
  const Hint& hint = c.data_.read_hint(va);
  if (hint.key != (va & ~(kReadSpan - 4)) || cycle < c.data_.fill.last) [[unlikely]] {
    c.regs_.r[15] = c.chain_.va;  // base to which the general routine adds the offset
    return generic(c, i, cycle);
  }
  ++c.counter(hint);
  c.log_.note(i, va);
  const unsigned rd = i->rd;
  c.regs_.r[rd] = read<Op::kLdr>(host(hint.bias, va));
  track(c, rd, cycle + 2, Scoreboard::kLoad);
  return next(c, i + 1, cycle + 1);
}

Handler Core::Ops::memory_body(Instruction& i, Context context) {
  if (i.op == Op::kLdrd || i.op == Op::kStrd || (i.flags & kUserBank) || i.rd == 15)
    return nullptr;
  if (i.rn == 15 && (i.flags & kWriteBack)) return nullptr;
  const bool up = i.flags & kUp;
  Address address;
  if (i.operand == Operand::kImm) {
    if (!up) {
      i.imm = 0u - i.imm;
      i.flags |= kUp;
    }
    if (i.rn == 15 && i.op == Op::kLdr) {
      const std::uint32_t pc = i.at + ((i.flags & kThumbInsn) ? 4u : kPcDelayArm);
      i.imm += (i.flags & kAlignPc) ? pc & ~3u : pc;
      i.flags = static_cast<std::uint16_t>(i.flags & ~(kReadsPc | kAlignPc));
      return &load_literal;
    }
    address = Address::kImm;
  } else if (i.operand == Operand::kReg) {
    address = up ? Address::kRegUp : Address::kRegDown;
  } else if (i.shift == 0 && up) {
    address = Address::kLsl;
  } else {
    return nullptr;
  }
  const Indexed indexed = !(i.flags & kPre)       ? Indexed::kPost
                          : (i.flags & kWriteBack) ? Indexed::kPre
                                                   : Indexed::kOffset;
  // Each step below selects one template parameter.
  const auto by_index = [&]<Op kOp, Address kAddress, bool kTrack>() -> Handler {
    const auto one = []<Indexed kIndexed>() -> Handler {
      if constexpr (kOp == Op::kStr || kOp == Op::kStrb || kOp == Op::kStrh)
        return &store<kOp, kAddress, kIndexed>;
      else
        return &load<kOp, kAddress, kIndexed, kTrack>;
    };
    switch (indexed) {
      case Indexed::kOffset: return one.template operator()<Indexed::kOffset>();
      case Indexed::kPre: return one.template operator()<Indexed::kPre>();
      default: return one.template operator()<Indexed::kPost>();
    }
  };
  const auto by_address = [&]<Op kOp, bool kTrack>() -> Handler {
    switch (address) {
      case Address::kImm: return by_index.template operator()<kOp, Address::kImm, kTrack>();
      case Address::kRegUp: return by_index.template operator()<kOp, Address::kRegUp, kTrack>();
      case Address::kRegDown: return by_index.template operator()<kOp, Address::kRegDown, kTrack>();
      default: return by_index.template operator()<kOp, Address::kLsl, kTrack>();
    }
  };
  const auto a_load = [&]<Op kOp>() -> Handler {
    return context.track ? by_address.template operator()<kOp, true>()
                       : by_address.template operator()<kOp, false>();
  };
  switch (i.op) {
    case Op::kLdr: return a_load.template operator()<Op::kLdr>();
    case Op::kLdrb: return a_load.template operator()<Op::kLdrb>();
    case Op::kLdrh: return a_load.template operator()<Op::kLdrh>();
    case Op::kLdrsb: return a_load.template operator()<Op::kLdrsb>();
    case Op::kLdrsh: return a_load.template operator()<Op::kLdrsh>();
    case Op::kStr: return by_address.template operator()<Op::kStr, false>();
    case Op::kStrb: return by_address.template operator()<Op::kStrb, false>();
    default: return by_address.template operator()<Op::kStrh, false>();
  }
}

/// LDM. rm and rs: first address and new base, in words relative to the base, signed; amount:
/// number of registers; shift and rd: the first and the last one; raw: how many of them follow each
/// other from the first one on, and a list of the others << 16. Most blocks lie in one line; kLong
/// is for the others.
template <bool kPc, bool kThumb, bool kLong, bool kCounted>
Core::Ops::Next Core::Ops::load_block(Core& c, Next i, Cycle cycle) {
  const std::uint32_t base = c.regs_.r[i->rn];
  std::uint32_t va = base + 4u * static_cast<std::uint32_t>(static_cast<std::int8_t>(i->rm));
  const std::uint32_t last = va + 4u * i->amount - 4;
  if ((va & 3u) || cycle < c.data_.fill.last) [[unlikely]] return generic(c, i, cycle);
  if (kPc && (c.system_.control & kArmV4Loads)) [[unlikely]] return generic(c, i, cycle);
  if (!kLong && (va ^ last) >= kReadSpan) 
    return load_block<kPc, kThumb, true, kCounted>(c, i, cycle);
  for (std::uint32_t line = va & ~(kReadSpan - 1);; line += kReadSpan) {
    if (c.data_.read_hints[line / kReadSpan % kHints].key != line) [[unlikely]]
      return generic(c, i, cycle);
    if (!kLong || line == (last & ~(kReadSpan - 1))) break;
  }
  c.log_.note(i, va);
  std::uint32_t target = 0;
  auto& r = c.regs_.r;
  const auto load = [&](std::uint32_t set, const std::uint8_t* from, unsigned words) {
    for (; words; --words, set &= set - 1, from += 4) {
      const unsigned to = lowest(set);
      if (kPc && to == 15) target = read<Op::kLdr>(from);
      else r[to] = read<Op::kLdr>(from);
    }
    return set;
  };
  if constexpr (!kLong) {
    const Hint& hint = c.data_.read_hint(va);
    c.counter(hint) += i->amount;
    const std::uint8_t* const from = host(hint.bias, va);
    const unsigned words = first_run(*i);
    copy_words(&r[i->shift], from, words);
    load(i->raw >> 16, from + 4 * words, i->amount - words);
  } else {
    std::uint32_t set = i->imm;
    for (unsigned left = i->amount; left;) {
      const Hint& hint = c.data_.read_hint(va);
      const unsigned here = std::min(left, (kReadSpan - va % kReadSpan) / 4);
      c.counter(hint) += here;
      set = load(set, host(hint.bias, va), here);
      va += 4 * here;
      left -= here;
    }
  }
  if (i->flags & kWriteBack)
    r[i->rn] = base + 4u * static_cast<std::uint32_t>(static_cast<std::int8_t>(i->rs));
  if constexpr (kPc && kCounted) c.follow_pop(i, cycle + i->amount + 4, target, base);
  if constexpr (kPc) return exchange<kThumb, kCounted>(c, i, cycle + i->amount + 4, target);
  if (i->amount == 1) return next(c, i + 1, cycle + 2);
  cycle += i->amount;
  track(c, i->rd, cycle + 1, Scoreboard::kLoad);
  return next(c, i + 1, cycle);
}

template <bool kLong>
Core::Ops::Next Core::Ops::store_block(Core& c, Next i, Cycle cycle) {
  const std::uint32_t base = c.regs_.r[i->rn];
  std::uint32_t va = base + 4u * static_cast<std::uint32_t>(static_cast<std::int8_t>(i->rm));
  const std::uint32_t last = va + 4u * i->amount - 4;
  if ((va & 3u) || cycle < c.data_.fill.last) [[unlikely]] return generic(c, i, cycle);
  if (!kLong && (va ^ last) >= kReadSpan) return store_block<true>(c, i, cycle);
  for (std::uint32_t half = va & ~(kWriteSpan - 1);; half += kWriteSpan) {
    if (c.data_.write_hints[half / kWriteSpan % kHints].key != half) [[unlikely]]
      return generic(c, i, cycle);
    if (half == (last & ~(kWriteSpan - 1))) break;
  }
  c.log_.note(i, va);
  const auto store = [&](std::uint32_t set, std::uint8_t* to, unsigned words) {
    for (; words; --words, set &= set - 1, to += 4) std::memcpy(to, &c.regs_.r[lowest(set)], 4);
    return set;
  };
  if constexpr (!kLong) {
    const Hint& hint = c.data_.write_hints[va / kWriteSpan % kHints];
    c.counter(hint) += i->amount;
    std::uint8_t* const to = host(hint.bias, va);  // a line's halves are adjacent in host memory
    const unsigned words = first_run(*i);
    copy_words(to, &c.regs_.r[i->shift], words);
    store(i->raw >> 16, to + 4 * words, i->amount - words);
  } else {
    std::uint32_t set = i->imm;
    for (unsigned left = i->amount; left;) {
      const Hint& hint = c.data_.write_hints[va / kWriteSpan % kHints];
      const unsigned here = std::min(left, (kReadSpan - va % kReadSpan) / 4);
      c.counter(hint) += here;
      set = store(set, host(hint.bias, va), here);
      va += 4 * here;
      left -= here;
    }
  }
  if (i->flags & kWriteBack)
    c.regs_.r[i->rn] = base + 4u * static_cast<std::uint32_t>(static_cast<std::int8_t>(i->rs));
  return next(c, i + 1, cycle + i->amount + (i->amount == 1 ? 1u : 0u));
}

Handler Core::Ops::block_body(Instruction& i, Context context) {
  if ((i.flags & kUserBank) || i.imm == 0 || i.rn == 15) return nullptr;
  const bool pc = i.imm & 0x8000u;
  if (i.op == Op::kStm && pc) return nullptr;
  const BlockShape shape = block_shape(i.imm, i.flags & kUp, i.flags & kPre);
  i.amount = static_cast<std::uint8_t>(shape.words);
  i.rm = static_cast<std::uint8_t>(shape.first);
  i.rs = static_cast<std::uint8_t>(shape.moved);
  i.rd = static_cast<std::uint8_t>(31 - std::countl_zero(i.imm));
  i.shift = static_cast<std::uint8_t>(std::countr_zero(i.imm));
  const int run = std::countr_one((i.imm & 0x7FFFu) >> i.shift);
  i.raw = static_cast<std::uint32_t>(run) |
          (i.imm & ~(((1u << run) - 1) << i.shift) & 0xFFFFu) << 16;
  if (i.op == Op::kStm) return &store_block<false>;
  // The write-back wins, unless the base is the last of several registers.
  if (shape.words > 1 && i.imm >> i.rn == 1u)
    i.flags = static_cast<std::uint16_t>(i.flags & ~kWriteBack);
  const bool thumb = i.flags & kThumbInsn;
  if (!pc) return &load_block<false, false, false, false>;
  if (context.counted)
    return thumb ? &load_block<true, true, false, true> : &load_block<true, false, false, true>;
  return thumb ? &load_block<true, true, false, false> : &load_block<true, false, false, false>;
}

}  // namespace fovea::cpu
