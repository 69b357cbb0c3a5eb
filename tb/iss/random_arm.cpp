// ARM instructions of random programs, with the code that they need around them.
#include <algorithm>
#include <bit>

#include "tb/iss/random_generator.h"

namespace fovea::cpu::test {

void Generator::arm_step(int row) {
  switch (row_at(row).kind.insn_class) {
    case InsnClass::kLoad:
    case InsnClass::kStore:
    case InsnClass::kNarrow:
    case InsnClass::kDouble:
      return arm_memory(row);
    case InsnClass::kBlock:
      return arm_block(row);
    case InsnClass::kBranch:
      return arm_branch(row);
    case InsnClass::kSwap: {
      const std::uint32_t base = dest();
      arm(kAlways | 0x028D0000u | base << 12 | 4 * r(32));
      return arm(draw(row, [&](IsaFields& f) { f['n'] = base; }));
    }
    case InsnClass::kStatus: {
      const std::uint32_t w = draw(row);
      arm(w);  // the mode, below the flags, is not the same everywhere
      if (row_at(row).op == Op::kMrs) {
        const std::uint32_t d = isa_fields(row, w)['d'];
        arm(kAlways | 0x020004FFu | d << 16 | d << 12);
      }
      return;
    }
    case InsnClass::kData:
      if (one_in(16) && arm_data_jump(row)) return;
      return arm(draw(row));
    default:
      return arm(draw(row));
  }
}

/// MOV, ADD, SUB to the pc.
bool Generator::arm_data_jump(int row) {
  const Op op = row_at(row).op;
  const bool imm = row_at(row).kind.operand == Operand::kImm;
  if (imm ? op != Op::kAdd && op != Op::kSub : op != Op::kMov && op != Op::kAdd) return false;
  const std::uint32_t a = dest(), b = other(a);
  const std::uint32_t v = imm ? r(64) * 4 : op == Op::kAdd ? word() & ~3u : 0;
  const std::uint32_t at = arm_constant(a, 0);
  if (!imm && op == Op::kAdd) arm_constant(b, v);
  const std::uint32_t w = draw(row, [&](IsaFields& f) {
    f['S'] = 0;
    f['d'] = kPc;
    f['n'] = op == Op::kMov ? 0 : a;
    f['m'] = op == Op::kMov ? a : b;
    f['a'] = f['t'] = 0;
    f['r'] = imm ? 0 : f['r'];
    f['i'] = v;
  });
  arm(w);
  const std::uint32_t target = arm_landing(false);
  patch(at, op == Op::kSub ? target + v : target - v);
  return true;
}

std::uint32_t Generator::unit(Op op) {
  switch (op) {
    case Op::kLdr:
    case Op::kStr:
      return 4;
    case Op::kLdrh:
    case Op::kLdrsh:
    case Op::kStrh:
      return 2;
    case Op::kLdrd:
    case Op::kStrd:
      return 8;
    default:
      return 1;
  }
}

/// At sp + 64 and up to 60 bytes around it, all forms of address.
void Generator::arm_memory(int row) {
  const IsaRow& form = row_at(row);
  const bool by_register = isa_has(row, 'm'), load = *form.kind.writes;
  const std::uint32_t step = unit(form.op);
  const bool pre = form.kind.flags & kPre;
  const bool literal = load && !by_register && pre && step < 8 && one_in(8);
  const bool jump = form.op == Op::kLdr && !(form.kind.flags & kUserBank) && !literal && one_in(8);
  const std::uint32_t base = dest(), index = other(base);
  const std::uint32_t distance = r(56 / step + 1) * step;
  std::uint32_t in_register = distance;
  bool negative = false;
  const std::uint32_t w = draw(row, [&](IsaFields& f) {
    f['n'] = base;
    f['m'] = index;
    f['i'] = distance;
    if (literal) {
      f['n'] = kPc;
      f['W'] = 0;
    }
    if (jump)
      f['d'] = kPc;
    else if (load)
      f['d'] = dest();
    else
      f['d'] = r(15);
    if (isa_has(row, 'e')) f['e'] = r(load ? 6 : 7);  // not r12 and r13
    if (by_register && isa_has(row, 't')) negative = shifted(f, distance, in_register);
  });
  if (literal) {
    arm(w);
    return;
  }
  const IsaFields f = isa_fields(row, w);
  arm(kAlways | 0x028D0040u | base << 12);
  if (by_register) arm_constant(index, in_register);
  if (by_register && f['t'] == 3 && f['a'] == 0) arm(kAlways | 0x03700000u | index << 16);  // C = 0
  std::uint32_t at = 0;
  if (jump) {
    std::uint32_t where = 64;
    if (pre) where = (f['U'] != 0) != negative ? 64 + distance : 64 - distance;
    const std::uint32_t t = other(base, index);
    at = arm_constant(t, 0);
    arm(kAlways | 0x058D0000u | t << 12 | where);
  }
  arm(w);
  if (jump) patch(at, arm_landing(w >> 28 == 14 && one_in(2)));
}

/// Chooses a shift of the offset and what must be in the register so that it becomes the distance.
/// @return the offset is negative
bool Generator::shifted(IsaFields& f, std::uint32_t distance, std::uint32_t& in_register) {
  const std::uint32_t junk = word();
  const std::uint32_t a = f['a'];
  switch (f['t']) {
    case 0: {  // what goes out at the top does not matter
      if (distance & ((1u << std::min(a, 16u)) - 1u)) f['a'] = 0;
      if (distance && a > 5) f['a'] = 0;
      const std::uint32_t n = f['a'];
      in_register = n ? (distance >> n) | junk << (32 - n) : distance;
      return false;
    }
    case 1:
    case 2: {
      if (a == 0 || a > 25) {  // #32 leaves nothing, or the sign
        if (distance)
          f['a'] = 1 + r(25);
        else
          f['a'] = 0;
      }
      const std::uint32_t n = f['a'];
      const bool negative = f['t'] == 2 && n && distance && one_in(2);
      const std::uint32_t v = negative ? 0u - distance : distance;
      in_register = n ? v << n | (junk & ((1u << n) - 1u)) : junk >> 1;
      return negative;
    }
    default:
      in_register = a ? std::rotl(distance, static_cast<int>(a)) : distance << 1 | (junk & 1u);
      return false;
  }
}

void Generator::arm_block(int row) {
  const bool load = row_at(row).op == Op::kLdm, to_pc = row_at(row).also;
  const std::uint32_t base = dest();
  const std::uint32_t w = draw(row, [&](IsaFields& f) {
    f['n'] = base;
    if (one_in(2)) f['l'] &= word();
    f['l'] &= load ? 0x5FFFu : 0x7FFFu;
  });
  const IsaFields f = isa_fields(row, w);
  arm(kAlways | 0x028D0040u | base << 12);
  if (!to_pc) return arm(w);
  // The pc is the last word: at the upper end.
  const auto n = static_cast<std::uint32_t>(std::popcount(f['l'])) + 1;
  const std::uint32_t where = f['U'] ? 64 + 4 * (n - 1) + 4 * f['P'] : 64 - 4 * f['P'];
  const std::uint32_t t = other(base);
  const std::uint32_t at = arm_constant(t, 0);
  arm(kAlways | 0x058D0000u | t << 12 | where);
  arm(w);
  patch(at, arm_landing(w >> 28 == 14 && one_in(2)));
}

void Generator::arm_branch(int row) {
  const Op op = row_at(row).op;
  const std::uint32_t at = here();
  if (op == Op::kB || op == Op::kBl) {
    const auto to = [&](std::uint32_t from, std::uint32_t target, std::uint32_t w) {
      return (w & 0xFF000000u) | ((target - from - 8) >> 2 & 0xFFFFFFu);
    };
    const std::uint32_t w = draw(row);
    if (one_in(4)) {  // back: b 2f; 1: filler; b 3f; 2: b 1b; 3:
      arm(kAlways | 0x0A000001u);
      if (w >> 28 == 14)
        arm_filler();
      else
        skip([this] { arm_filler(); });
      skip([this] { arm(kAlways | 0x0A000000u); });
      arm(to(here(), at + 4, w));
    } else {
      arm(w);
      const std::uint32_t target = arm_landing(false);
      patch(at, to(at, target, w));
    }
    return;
  }
  if (op == Op::kBlxImm) {
    arm(draw(row));
    const std::uint32_t h = r(2);
    skip_arm();
    if (h) put(0x46C0u, 2);
    const std::uint32_t target = here();
    thumb_filler();
    thumb_to_arm();
    return patch(at, 0xFA000000u | h << 24 | ((target - h * 2 - at - 8) >> 2 & 0xFFFFFFu));
  }
  const std::uint32_t t = dest(), constant = arm_constant(t, 0);
  const std::uint32_t w = draw(row, [&](IsaFields& f) { f['m'] = t; });
  arm(w);
  patch(constant, arm_landing(w >> 28 == 14 && one_in(2)));
}

}  // namespace fovea::cpu::test
