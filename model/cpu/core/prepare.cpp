// Prepares decoded records: chooses the handler, and finds out which checks the neighbours make
// unnecessary.
#include <bit>
#include <cstring>

#include "model/cpu/core/handlers.h"
#include "model/cpu/core/isa.h"

namespace fovea::cpu {
namespace {

/// Registers whose value arrives after the end of the instruction's issue, and by how many clocks
/// at most in the fast handlers. (A rotated word is loaded by the general routine.)
struct Late {
  std::uint32_t registers = 0;
  unsigned latency = 0;
  bool load = false;
};

Late late_results(const Instruction& i) {
  switch (i.op) {
    case Op::kLdr: return {1u << i.rd, 1, true};
    case Op::kLdrb: case Op::kLdrh: case Op::kLdrsb: case Op::kLdrsh: return {1u << i.rd, 2, true};
    case Op::kLdm: {
      if (i.imm == 0) return {};
      return {1u << (31 - std::countl_zero(i.imm)), 1, true};
    }
    case Op::kMul: case Op::kMla: case Op::kUmull: case Op::kUmlal: case Op::kSmull:
    case Op::kSmlal:
      return {1u << i.rn, 1, false};
    default: return {};  // other instructions end the chain, and the next one is executed on its
                         // own
  }
}

std::uint32_t operands(const Instruction& i) {
  return static_cast<std::uint32_t>(i.sources) | i.stored;
}

/// Registers that may not be available yet after the instruction.
std::uint16_t perhaps_late(const Instruction& i) {
  switch (i.op) {
    case Op::kStr: case Op::kStrb: case Op::kStrh: case Op::kStrd: case Op::kStm: case Op::kPld:
    case Op::kB: case Op::kBl: case Op::kBxReg: case Op::kBlxReg: case Op::kThumbBlPrefix:
    case Op::kThumbBlSuffix: case Op::kClz:
      return 0;
    default: break;
  }
  if (is_data_processing(i.op)) return 0;
  const std::uint32_t known = late_results(i).registers;
  return static_cast<std::uint16_t>(known ? known : 0xFFFFu);
}

}  // namespace

Instruction decode_at(const std::uint8_t* bytes, unsigned index, bool thumb) {
  if (thumb) {
    std::uint16_t half;
    std::memcpy(&half, bytes + 2 * index, 2);
    return decode_thumb(half);
  }
  std::uint32_t word;
  std::memcpy(&word, bytes + 4 * index, 4);
  return decode_arm(word);
}

void DecodedLine::prepare_record(const Instruction& decoded, unsigned index, RecordContext context,
                                 bool shifted_cycle) {
  const bool thumb = decoded.flags & kThumbInsn;
  const unsigned count = thumb ? 16 : 8;
  records[index] = decoded;
  prepare(records[index], index * 32 / count, context, shifted_cycle);
  // The last two may delay the first ones of the next line.
  if (index + 2 >= count)
    records[count].sources =
        static_cast<std::uint16_t>(records[count].sources | perhaps_late(decoded));
}

/// Within a chain only the two preceding records can delay a record, and a taken branch takes
/// longer than any result.
RecordContext record_context(const DecodedLine& d, unsigned index, const std::uint8_t* bytes,
                             bool thumb) {
  const unsigned count = thumb ? 16 : 8;
  const auto at = [&](unsigned k) {
    return d.records[k].body ? d.records[k] : decode_at(bytes, k, thumb);
  };
  const Instruction& i = d.records[index];
  using Check = RecordContext::Check;
  RecordContext context;
  context.check = Check::kNone;
  const std::uint32_t needs = operands(i);
  if (needs && index >= 1) {
    const Instruction before = at(index - 1);
    const Late young = late_results(before);
    const Late old = index >= 2 ? late_results(at(index - 2)) : Late{};
    const bool waits_for_young = young.registers & needs;
    const bool waits_for_old = old.latency == 2 && (old.registers & needs);
    // If the preceding record is always executed, its result is the latest one.
    const bool in_full = (young.registers & i.sources) || young.load;
    if (waits_for_young && in_full && before.cond == 14)
      context.check = Check::kYoungest;
    else if (waits_for_young || waits_for_old)
      context.check = Check::kAll;
  }
  const Late mine = late_results(i);
  if (mine.registers) {
    context.track = index + mine.latency >= count;  // line_end() checks the next line
    for (unsigned k = 1; k <= mine.latency && index + k < count; ++k)
      if (operands(at(index + k)) & mine.registers) context.track = true;
  }
  return context;
}

void DecodedLine::clear(bool thumb, bool counted) {
  const unsigned count = thumb ? 16 : 8;
  for (unsigned k = 0; k < count; ++k) {
    records[k] = Instruction{};
    records[k].handler = &Core::Ops::leave;
    records[k].at = static_cast<std::uint8_t>(k * 32 / count);
  }
  records[count] = Instruction{};
  using Ops = Core::Ops;
  records[count].handler = counted ? thumb ? &Ops::line_end<true, true> : &Ops::line_end<false, true>
                           : thumb ? &Ops::line_end<true, false>
                                   : &Ops::line_end<false, false>;
  records[count].at = 32;
}

const Instruction* DecodedLine::hold_one(const Instruction& decoded, std::uint32_t pc,
                                         RecordContext context, bool shifted_cycle) {
  const unsigned size = (decoded.flags & kThumbInsn) ? 2 : 4;
  va = pc & ~31u;
  Instruction* const i = &records[(pc & 31u) / size];
  i[0] = decoded;
  prepare(i[0], pc & 31u, context, shifted_cycle);
  i[1] = Instruction{};
  i[1].at = static_cast<std::uint8_t>(i->at + size);
  i[1].handler = &Core::Ops::leave;
  return i;
}

template <unsigned kCond, RecordContext::Check kCheck, bool kPc, bool kCounted>
Core::Ops::Next Core::Ops::before(Core& c, Next i, Cycle cycle) {
  if (!passes<kCond>(c)) {
    if constexpr (kCounted) ++c.fetch_.current->tally(*i).special;
    return next(c, i + 1, cycle + 1);
  }
  if constexpr (kCheck == Context::Check::kYoungest) {
    if (cycle < c.scoreboard_.latest) stall<kCounted>(c, i, cycle, c.scoreboard_.latest);
  } else if constexpr (kCheck == Context::Check::kAll) {
    if (cycle < c.scoreboard_.latest)
      stall<kCounted>(c, i, cycle, c.scoreboard_.operands_ready(*i, cycle));
  }
  if constexpr (kPc)
    c.regs_.r[15] = pc_ahead(*i, c.chain_.va + i->at);
  return i->body(c, i, cycle);
}

/// Index of a handler: condition + check * 15 + pc * 45 + counted * 90.
template <std::size_t... k>
constexpr std::array<Handler, sizeof...(k)> Core::Ops::before_table(std::index_sequence<k...>) {
  return {&before<k % 15, static_cast<Context::Check>(k / 15 % 3), k / 45 % 2 != 0, k / 90 != 0>...};
}

void prepare(Instruction& i, unsigned at, RecordContext context, bool shifted_cycle) {
  using Ops = Core::Ops;
  using Check = RecordContext::Check;
  i.at = static_cast<std::uint8_t>(at);
  Handler body = nullptr;
  bool own_condition = false;
  if (i.flags & kUnpredictable) {
    body = &Ops::warned;
  } else if (is_data_processing(i.op)) {
    body = Ops::data_body(i);
  } else {
    switch (i.op) {
      case Op::kMul: case Op::kMla: case Op::kUmull: case Op::kUmlal: case Op::kSmull:
      case Op::kSmlal:
        body = Ops::multiply_body(i);
        break;
      case Op::kLdr: case Op::kLdrb: case Op::kLdrh: case Op::kLdrsb: case Op::kLdrsh:
      case Op::kStr: case Op::kStrb: case Op::kStrh:
        if (i.operand == Operand::kShiftImm) i.rs = shifted_cycle;
        body = Ops::memory_body(i, context);
        break;
      case Op::kLdm: case Op::kStm:
        body = Ops::block_body(i, context);
        break;
      case Op::kB: case Op::kBl:
        own_condition = !context.away;
        [[fallthrough]];
      case Op::kBxReg: case Op::kBlxReg: case Op::kThumbBlPrefix: case Op::kThumbBlSuffix:
        body = Ops::branch_body(i, context);
        break;
      case Op::kClz:
        body = &Ops::count_zeros;
        break;
      default: break;
    }
  }
  i.body = body ? body : &Ops::generic;
  const unsigned cond = own_condition ? kAlways : i.cond;
  const auto check = operands(i) ? context.check : Check::kNone;
  const bool pc = body && (i.flags & kReadsPc);
  if (cond == kAlways && check == Check::kNone && !pc) {
    i.handler = i.body;
    return;
  }
  static constexpr auto kTable = Ops::before_table(std::make_index_sequence<180>{});
  i.handler = kTable[cond + 15 * (static_cast<unsigned>(check) +
                                  3 * (unsigned{pc} + 2 * unsigned{context.counted}))];
}

Core::Ops::Next Core::Ops::warned(Core& c, Next i, Cycle cycle) {
  c.settle(i, cycle);
  c.ends_before(i);
  const bool thumb = i->flags & kThumbInsn;
  c.unpredictable(isa_rows()[static_cast<std::size_t>(isa_row(i->raw, thumb))].name);
  Instruction own = thumb ? decode_thumb(static_cast<std::uint16_t>(i->raw)) : decode_arm(i->raw);
  own.flags = static_cast<std::uint16_t>(own.flags & ~kUnpredictable);
  c.log_.line_changes(c.unpredictable_);
  const Next record =
      c.unpredictable_.hold_one(own, c.regs_.pc, c.fetch_.context(own, c.regs_.pc), c.shifted_cycle_);
  c.chain_.stop = 0;  // execute one record, then return to run()
  c.chain_.first = reinterpret_cast<std::intptr_t>(record);
  c.count_alone(own, [&] {
    for (Next k = record->body(c, record, c.ledger_.cycle); k;)
      k = k->handler(c, k, c.chain_.cycle);
  });
  return nullptr;
}

template <bool kThumb, bool kCounted>
Core::Ops::Next Core::Ops::enter_line(Core& c, Next i, Cycle cycle, DecodedLine& d) {
  const Next to = &d.records[0];
  c.chain_.va += 32;
  c.fetch_.current = &d;
  c.chain_.first += reinterpret_cast<std::intptr_t>(to) - reinterpret_cast<std::intptr_t>(i);
  if constexpr (kCounted) ++d.tallies[0].flow;
  return go(c, to, cycle);
}

template <bool kThumb, bool kCounted>
Core::Ops::Next Core::Ops::line_end(Core& c, Next i, Cycle cycle) {
  const std::uint32_t va = c.chain_.va + 32;
  DecodedLine* const d = c.fetch_.current->next;
  if (d->valid != (c.fetch_.epoch | va | kThumb)) [[unlikely]] return leave(c, i, cycle);
  if (cycle < c.scoreboard_.latest) [[unlikely]] return line_end_busy<kThumb, kCounted>(c, i, cycle, *d);
  return enter_line<kThumb, kCounted>(c, i, cycle, *d);
}

/// The records of a line are prepared without knowing the preceding line.
template <bool kThumb, bool kCounted>
[[gnu::noinline]] Core::Ops::Next Core::Ops::line_end_busy(Core& c, Next i, Cycle cycle,
                                                           DecodedLine& d) {
  if (!d.records[0].body) [[unlikely]] return leave(c, i, cycle);
  if (!((operands(d.records[0]) | operands(d.records[1])) & i->sources))
    return enter_line<kThumb, kCounted>(c, i, cycle, d);
  const Cycle start = held(c, &d.records[0], cycle, i->sources);
  if (start == kNever) [[unlikely]] return leave(c, i, cycle);
  if (start > cycle) {
    if constexpr (kCounted) d.tallies[0].waited += static_cast<std::uint32_t>(start - cycle);
    stall<false>(c, i, cycle, start);
  }
  return enter_line<kThumb, kCounted>(c, i, cycle, d);
}

[[gnu::noinline]] Core::Ops::Cycle Core::Ops::held_until(const Core& c, Next i, Cycle cycle) {
  return held(c, i, cycle, ~0u);
}

[[gnu::always_inline]] inline Core::Ops::Cycle Core::Ops::held(const Core& c, Next i, Cycle cycle,
                                                              std::uint32_t late) {
  const Cycle start = c.scoreboard_.operands_ready(*i, cycle, late);
  if (start > cycle && i->cond != 14) return kNever;
  // No result takes longer than two clocks.
  if (c.scoreboard_.latest > start + 1 &&
      c.scoreboard_.any_later(operands(i[1]) & late, start + 1))
    return kNever;
  return start;
}

}  // namespace fovea::cpu
