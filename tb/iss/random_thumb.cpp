// Thumb instructions of random programs, with the code that they need around them.
#include <bit>

#include "tb/iss/random_generator.h"

namespace fovea::cpu::test {

void Generator::thumb_step(int row) {
  const IsaRow& form = row_at(row);
  switch (form.kind.insn_class) {
    case InsnClass::kThumbHigh:
      return thumb_high(row);
    case InsnClass::kThumbMemory:
      return thumb_memory(row);
    case InsnClass::kThumbBlock:
      return thumb_block(row);
    case InsnClass::kThumbBranch:
      return thumb_branch(row);
    default:
      break;
  }
  const std::uint32_t h = draw_thumb(row);
  thumb(h);
  if (!isa_has(row, 'd') || isa_fields(row, h)['d'] != kSp) return;
  thumb(0x4668u | r(8));  // mov rd, sp: seen in the result
  thumb(h ^ 0x80u);       // and back
}

void Generator::thumb_high(int row) {
  const Op op = row_at(row).op;
  if (op != Op::kCmp && one_in(8)) {  // to the pc
    const std::uint32_t t = r(8), at = thumb_constant(t, 0);
    const std::uint32_t from = here();
    IsaFields f;
    f['d'] = kPc;
    f['m'] = t;
    thumb(isa_encode(row, f));
    const std::uint32_t target = thumb_landing(false);
    return patch(at, op == Op::kAdd ? target - from - 4 : target);
  }
  thumb(draw(row, [this](IsaFields& f) {
    f['d'] = dest();
    f['n'] = r(15);
    f['m'] = r(16);
  }));
}

void Generator::thumb_memory(int row) {
  const std::uint32_t step = unit(row_at(row).op);
  const std::uint32_t base = r(8), index = other_low(base);
  const bool implied_base = isa_fields(row, isa_bits(row).value)['n'] != 0;  // pc or sp
  if (!implied_base) thumb(0xA800u | base << 8 | r(8));
  if (isa_has(row, 'm')) {
    thumb(0x2000u | index << 8 | r((kDataBytes - 32) / step) * step);
    if (one_in(3)) {  // downwards
      thumb(0xA800u | base << 8 | 31);
      thumb(0x4240u | index << 3 | index);
    }
  }
  thumb(draw(row, [&](IsaFields& f) {
    f['n'] = base;
    f['m'] = index;
    f['d'] = r(8);
    f['i'] = r((kDataBytes - 32) / step);
  }));
}

void Generator::thumb_block(int row) {
  const IsaRow& form = row_at(row);
  const std::uint32_t base = r(8);
  const bool stack = isa_fields(row, isa_bits(row).value)['n'] == kSp;
  const std::uint32_t h = draw(row, [&](IsaFields& f) {
    f['n'] = base;
    if (one_in(2)) f['l'] &= word();
  });
  if (!stack) {
    thumb(0xA800u | base << 8 | r(24));
    return thumb(h);
  }
  const auto n = static_cast<std::uint32_t>(std::popcount(isa_fields(row, h)['l'] | form.also));
  if (form.op == Op::kStm) {
    thumb(0xB010u);  // add sp, #64
    thumb(h);
    thumb(0xB080u | (16 - n));
  } else if (!form.also) {
    thumb(h);
    thumb(0xB080u | n);
  } else {
    const std::uint32_t t = r(8), at = thumb_constant(t, 0);
    thumb(0x9000u | t << 8 | (n - 1));
    thumb(h);
    patch(at, thumb_landing(one_in(2)));
    thumb(0xB080u | n);
  }
}

void Generator::thumb_branch(int row) {
  const IsaRow& form = row_at(row);
  const std::uint32_t at = here();
  switch (form.op) {
    case Op::kB: {
      const bool conditional = isa_has(row, 'c');
      const std::uint32_t mask = conditional ? 0xFFu : 0x7FFu;
      const std::uint32_t h = draw_thumb(row) & ~mask;
      if (one_in(4)) {  // back: b 2f; 1: filler; b 3f; 2: b 1b; 3:
        thumb(0xE001u);
        if (conditional)
          skip([this] { thumb_filler(); });
        else
          thumb_filler();
        skip([this] { thumb(0xE000u); });
        return thumb(h | ((at + 2 - here() - 4) >> 1 & mask));
      }
      thumb(h);
      const std::uint32_t target = thumb_landing(false) & ~1u;
      return patch(at, h | ((target - at - 4) >> 1 & mask), 2);
    }
    case Op::kBxReg:
    case Op::kBlxReg: {
      const std::uint32_t t = r(8), constant = thumb_constant(t, 0);
      thumb(draw(row, [&](IsaFields& f) { f['m'] = t; }));
      return patch(constant, thumb_landing(one_in(2)));
    }
    default:
      break;
  }
  // BL and BLX: both halves, forward or back.
  const bool exchange = std::string(form.name) == "t blx suffix";
  std::uint32_t target = 0, call = at;
  if (one_in(4)) {  // back: b 2f; 1: code; b 3f; 2: bl 1b; 3:
    thumb(0xE000u);
    target = (thumb_back_target(exchange) & ~1u);
    patch(at, 0xE000u | (here() - at - 4) >> 1, 2);
    call = here();
    thumb(0xF000u);
    thumb(exchange ? 0xE800u : 0xF800u);
    patch(target_exit_, 0xE000u | ((here() - target_exit_ - 4) >> 1 & 0x7FFu), 2);
  } else {
    thumb(0xF000u);
    thumb(exchange ? 0xE800u : 0xF800u);
    target = thumb_landing(exchange) & ~1u;
  }
  std::uint32_t by = target - call - 4;
  if (exchange) by = target - ((call + 4) & ~3u);
  patch(call, 0xF000u | (by >> 12 & 0x7FFu), 2);
  patch(call + 2, (exchange ? 0xE800u : 0xF800u) | (by >> 1 & 0x7FFu), 2);
}
/// Code that a later call reaches; notes where it leaves.
std::uint32_t Generator::thumb_back_target(bool arm_code) {
  if (arm_code && (here() & 2u)) skip([this] { thumb_filler(); });
  const std::uint32_t at = here();
  if (arm_code) {
    link_to_thumb();
  } else {
    thumb_filler();
  }
  target_exit_ = here();
  thumb(0xE000u);
  return at;
}

}  // namespace fovea::cpu::test
