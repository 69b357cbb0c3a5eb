// The generator. Only defined, aligned code: there qemu and the chip agree. Known differences, none of
// which is generated: unaligned accesses, STR and STM of the pc (+12 on the chip), the pc with a shift
// by register.
#include "tb/iss/random_code.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "model/cpu/core/isa.h"
#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

constexpr std::uint32_t kAlways = 14u << 28;
constexpr std::uint32_t kSp = 13, kPc = 15;

constexpr Excuse kExcuses[] = {
    {"mrs spsr", "user mode has no SPSR"},
    {"msr spsr reg", "user mode has no SPSR"},
    {"msr spsr imm", "user mode has no SPSR"},
    {"ldm user", "privileged"},
    {"ldm return", "privileged"},
    {"stm user", "privileged"},
    {"svc", "calls the operating system"},
    {"bkpt", "calls the operating system"},
    {"udf", "calls the operating system"},
    {"t svc", "calls the operating system"},
    {"t bkpt", "calls the operating system"},
    {"t udf", "calls the operating system"},
    {"mcr", "CP15 is privileged"},
    {"mrc", "CP15 is privileged"},
    {"mcrr", "undefined: no such coprocessor"},
    {"mrrc", "undefined: no such coprocessor"},
    {"cdp", "undefined: no such coprocessor"},
    {"ldc pre", "undefined: no such coprocessor"},
    {"ldc post", "undefined: no such coprocessor"},
    {"ldc option", "undefined: no such coprocessor"},
    {"stc pre", "undefined: no such coprocessor"},
    {"stc post", "undefined: no such coprocessor"},
    {"stc option", "undefined: no such coprocessor"},
    {"cdp2", "undefined: no such coprocessor"},
    {"ldc2 pre", "undefined: no such coprocessor"},
    {"ldc2 post", "undefined: no such coprocessor"},
    {"ldc2 option", "undefined: no such coprocessor"},
    {"stc2 pre", "undefined: no such coprocessor"},
    {"stc2 post", "undefined: no such coprocessor"},
    {"stc2 option", "undefined: no such coprocessor"},
    {"mcr2", "undefined: no such coprocessor"},
    {"mrc2", "undefined: no such coprocessor"}};

const IsaRow& row_at(int row) { return isa_rows()[static_cast<std::size_t>(row)]; }

class Generator {
 public:
  Generator(std::uint64_t seed, unsigned sequences, unsigned length)
      : random_(seed), length_(length) {
    program.counts.resize(isa_rows().size());
    // Entry; tables; results; code on pages of its own.
    tables_ = kMemory + 64;
    results_ = tables_ + sequences * 64;
    const std::uint32_t code = (results_ + sequences * kSequenceBytes + 4095) / 4096 * 4096;
    put(kAlways | 0x0A000000u | ((code - kMemory - 8) >> 2), 4);
    while (here() < results_) put(0, 4);
    while (here() < code) put(value(), 4);
    for (unsigned k = 0; k < sequences; ++k) sequence(k);
    finish(sequences);
  }
  RandomProgram program;

 private:
  // Numbers.
  std::uint32_t r(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }
  std::uint32_t word() { return static_cast<std::uint32_t>(random_()); }
  bool one_in(std::uint32_t n) { return r(n) == 0; }
  std::uint32_t value() {
    constexpr std::uint32_t kEdges[] = {0,          1,          2,          31,         32,
                                        33,         255,        0x7FFF,     0x8000,     0xFFFF,
                                        0x7FFFFFFF, 0x80000000, 0x80000001, 0xFFFFFFFF, 0xFFFF8000,
                                        0x80008000, 0x7FFF7FFF};
    return one_in(3) ? kEdges[r(std::size(kEdges))] : word();
  }
  /// Registers a sequence may change: all but r13, which always points to the data.
  std::uint32_t dest() {
    const std::uint32_t d = r(14);
    return d == kSp ? 14 : d;
  }
  std::uint32_t source() { return one_in(16) ? kPc : r(15); }
  std::uint32_t other(std::uint32_t a, std::uint32_t b = 99) {
    std::uint32_t d = dest();
    while (d == a || d == b) d = dest();
    return d;
  }
  std::uint32_t other_low(std::uint32_t a, std::uint32_t b = 99) {
    std::uint32_t d = r(8);
    while (d == a || d == b) d = r(8);
    return d;
  }

  // Code.
  std::uint32_t here() const { return kMemory + static_cast<std::uint32_t>(program.image.size()); }
  void put(std::uint32_t w, unsigned bytes) {
    for (unsigned k = 0; k < bytes; ++k)
      program.image.push_back(static_cast<std::uint8_t>(w >> 8 * k));
  }
  void patch(std::uint32_t address, std::uint32_t w, unsigned bytes = 4) {
    std::memcpy(program.image.data() + (address - kMemory), &w, bytes);
  }
  void note(std::uint32_t w, bool thumb) {
    const int row = isa_row(w, thumb);
    // A Thumb branch on a condition does all it can do, taken or not.
    const bool always = thumb || w >> 28 >= 14;
    program.spots.push_back({here(), row, thumb, always && !skipped_});
    if (program.spots.back().certain) ++program.counts[static_cast<std::size_t>(row)];
  }
  void arm(std::uint32_t w) {
    note(w, false);
    put(w, 4);
  }
  void thumb(std::uint32_t h) {
    note(h, true);
    put(h, 2);
  }
  /// reg = constant; returns where the constant lies. ldr reg, [pc, #0]; b; .word
  std::uint32_t arm_constant(std::uint32_t reg, std::uint32_t v) {
    arm(kAlways | 0x059F0000u | reg << 12);
    arm(kAlways | 0x0A000000u);
    put(v, 4);
    return here() - 4;
  }
  std::uint32_t thumb_constant(std::uint32_t reg, std::uint32_t v) {
    if (here() & 2u) thumb(0x46C0u);
    thumb(0x4800u | reg << 8);
    thumb(0xE001u);
    put(v, 4);
    return here() - 4;
  }
  void arm_filler() {
    arm(kAlways | r(8) << 21 | dest() << 12 | r(13) << 16 | r(13));
  }
  void thumb_filler() { thumb(0x2000u | r(4) << 11 | r(2048)); }
  void arm_to_thumb() {  // through r14
    arm(kAlways | 0x028FE001u);
    arm(kAlways | 0x012FFF1Eu);
  }
  void thumb_to_arm() {  // bx pc
    if (here() & 2u) thumb(0x46C0u);
    thumb(0x4778u);
    put(0x46C0u, 2);
  }
  /// What a jump leaves out, or may leave out: not counted.
  template <typename F>
  void skip(F code) {
    const bool before = skipped_;
    skipped_ = true;
    code();
    skipped_ = before;
  }
  void skip_arm() {
    skip([this] {
      for (std::uint32_t n = r(3); n < 3; ++n) arm_filler();
    });
  }
  void skip_thumb() {
    skip([this] {
      for (std::uint32_t n = r(3); n < 3; ++n) thumb_filler();
    });
  }
  /// Where an ARM jump goes to: over some instructions, perhaps to Thumb code and back.
  /// @return the address with its Thumb bit
  std::uint32_t arm_landing(bool to_thumb) {
    skip_arm();
    const std::uint32_t at = here();
    if (!to_thumb) return at;
    thumb_filler();
    thumb_to_arm();
    return at | 1u;
  }
  /// The same for Thumb. A link must be seen before r14 is used to come back.
  std::uint32_t thumb_landing(bool to_arm) {
    skip_thumb();
    if (to_arm && (here() & 2u)) skip([this] { thumb_filler(); });
    const std::uint32_t at = here();
    if (!to_arm) return at | 1u;
    link_to_thumb();
    return at;
  }
  void link_to_thumb() {
    arm(kAlways | 0x01A0000Eu | r(8) << 12);
    arm_to_thumb();
  }

  /// Random fields; registers within what a sequence may change. Tried until the row defines them.
  template <typename F>
  std::uint32_t draw(int row, F choose) {
    const IsaKind& kind = row_at(row).kind;
    for (;;) {
      const IsaBits& b = isa_bits(row);
      IsaFields f = isa_fields(row, (word() & ~b.mask) | b.value);
      for (const char letter : {'n', 'd', 'm', 's'})
        f[letter] = std::strchr(kind.writes, letter) ? dest() : source();
      if (isa_has(row, 'c')) f['c'] = one_in(3) ? r(14) : 14;
      choose(f);
      const std::uint32_t w = isa_encode(row, f);
      if (isa_row(w, row_at(row).thumb()) == row && isa_defined(row, w)) return w;
    }
  }
  std::uint32_t draw(int row) {
    return draw(row, [](IsaFields&) {});
  }
  std::uint32_t draw_thumb(int row) {
    return draw(row, [this](IsaFields& f) {
      for (const char letter : {'n', 'd', 'm', 's'}) f[letter] = r(8);
    });
  }

  // ARM steps.
  void arm_step(int row) {
    switch (row_at(row).kind.insn_class) {
      case InsnClass::kLoad:
      case InsnClass::kStore:
      case InsnClass::kNarrow:
      case InsnClass::kDouble: return arm_memory(row);
      case InsnClass::kBlock: return arm_block(row);
      case InsnClass::kBranch: return arm_branch(row);
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
      default: return arm(draw(row));
    }
  }

  /// MOV, ADD, SUB to the pc.
  bool arm_data_jump(int row) {
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

  static std::uint32_t unit(Op op) {
    switch (op) {
      case Op::kLdr:
      case Op::kStr: return 4;
      case Op::kLdrh:
      case Op::kLdrsh:
      case Op::kStrh: return 2;
      case Op::kLdrd:
      case Op::kStrd: return 8;
      default: return 1;
    }
  }

  /// At sp + 64 and up to 60 bytes around it, all forms of address.
  void arm_memory(int row) {
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
      if (jump) f['d'] = kPc;
      else if (load) f['d'] = dest();
      else f['d'] = r(15);
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
  bool shifted(IsaFields& f, std::uint32_t distance, std::uint32_t& in_register) {
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
          if (distance) f['a'] = 1 + r(25);
          else f['a'] = 0;
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

  void arm_block(int row) {
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

  void arm_branch(int row) {
    const Op op = row_at(row).op;
    const std::uint32_t at = here();
    if (op == Op::kB || op == Op::kBl) {
      const auto to = [&](std::uint32_t from, std::uint32_t target, std::uint32_t w) {
        return (w & 0xFF000000u) | ((target - from - 8) >> 2 & 0xFFFFFFu);
      };
      const std::uint32_t w = draw(row);
      if (one_in(4)) {  // back: b 2f; 1: filler; b 3f; 2: b 1b; 3:
        arm(kAlways | 0x0A000001u);
        if (w >> 28 == 14) arm_filler();
        else skip([this] { arm_filler(); });
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

  // Thumb steps.
  void thumb_step(int row) {
    const IsaRow& form = row_at(row);
    switch (form.kind.insn_class) {
      case InsnClass::kThumbHigh: return thumb_high(row);
      case InsnClass::kThumbMemory: return thumb_memory(row);
      case InsnClass::kThumbBlock: return thumb_block(row);
      case InsnClass::kThumbBranch: return thumb_branch(row);
      default: break;
    }
    const std::uint32_t h = draw_thumb(row);
    thumb(h);
    if (!isa_has(row, 'd') || isa_fields(row, h)['d'] != kSp) return;
    thumb(0x4668u | r(8));  // mov rd, sp: seen in the result
    thumb(h ^ 0x80u);       // and back
  }

  void thumb_high(int row) {
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

  void thumb_memory(int row) {
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

  void thumb_block(int row) {
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

  void thumb_branch(int row) {
    const IsaRow& form = row_at(row);
    const std::uint32_t at = here();
    switch (form.op) {
      case Op::kB: {
        const bool conditional = isa_has(row, 'c');
        const std::uint32_t mask = conditional ? 0xFFu : 0x7FFu;
        const std::uint32_t h = draw_thumb(row) & ~mask;
        if (one_in(4)) {  // back: b 2f; 1: filler; b 3f; 2: b 1b; 3:
          thumb(0xE001u);
          if (conditional) skip([this] { thumb_filler(); });
          else thumb_filler();
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
      default: break;
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
  std::uint32_t thumb_back_target(bool arm_code) {
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

  // Program.
  /// Rows of a state in random order, again and again.
  int next_row(bool thumb_state) {
    auto& deck = decks_[thumb_state];
    if (deck.empty()) {
      for (int row = 0; row < static_cast<int>(isa_rows().size()); ++row)
        if (row_at(row).thumb() == thumb_state && !excused(row)) deck.push_back(row);
      for (std::size_t k = deck.size(); k > 1; --k)
        std::swap(deck[k - 1], deck[r(static_cast<std::uint32_t>(k))]);
    }
    const int row = deck.back();
    deck.pop_back();
    return row;
  }

  void sequence(unsigned k) {
    const bool is_thumb = k % 3 == 2;
    const std::uint32_t table = tables_ + 64 * k, out = results_ + kSequenceBytes * k;
    program.begin.push_back(here());
    for (unsigned n = 0; n < 15; ++n) patch(table + 4 * n, n == 14 ? r(32) << 27 : value());
    arm_constant(kSp, table);
    arm(kAlways | 0x059D0038u);  // ldr r0, [sp, #56]
    arm(kAlways | 0x0128F000u);  // msr cpsr_f, r0
    arm(kAlways | 0x089D5FFFu);  // ldmia sp, {r0-r12, lr}
    arm_constant(kSp, out + kLeftBytes);
    if (is_thumb) {
      arm_to_thumb();
      for (unsigned n = 0; n < length_; ++n) thumb_step(next_row(true));
      thumb_to_arm();
    } else {
      for (unsigned n = 0; n < length_; ++n) arm_step(next_row(false));
    }
    arm_constant(kSp, out);
    arm(kAlways | 0x08AD5FFFu);  // stmia sp!, {r0-r12, lr}
    arm(kAlways | 0x010F0000u);  // mrs r0, cpsr
    arm(kAlways | 0x020004FFu);  // and r0, r0, #0xFF000000
    arm(kAlways | 0x058D0000u);  // str r0, [sp]
    program.end.push_back(here());
  }

  void finish(unsigned sequences) {
    skip([&] {  // its effect is not compared
      arm_constant(1, results_);
      arm_constant(2, sequences * kSequenceBytes);
    });
    for (const std::uint32_t w : {0xE3A00001u, 0xE3A07004u, 0xEF000000u,    // write
                                  0xE3A00000u, 0xE3A07001u, 0xEF000000u})  // exit
      put(w, 4);
    for (unsigned k = 0; k < 256; ++k) put(value(), 4);  // within reach of literal loads
  }

  std::mt19937_64 random_;
  unsigned length_;
  std::uint32_t tables_ = 0, results_ = 0, target_exit_ = 0;
  bool skipped_ = false;
  std::vector<int> decks_[2];
};

}  // namespace

std::span<const Excuse> excuses() { return kExcuses; }

bool excused(int row) {
  return std::any_of(std::begin(kExcuses), std::end(kExcuses),
                     [row](const Excuse& e) { return std::string(e.row) == row_at(row).name; });
}

RandomProgram generate(std::uint64_t seed, unsigned sequences, unsigned length) {
  return Generator(seed, sequences, length).program;
}

std::vector<std::uint8_t> as_elf(const std::vector<std::uint8_t>& image, std::uint32_t base) {
  constexpr std::uint32_t kOffset = 4096;  // offset and address agree within a page
  std::vector<std::uint8_t> out(kOffset + image.size());
  const auto put = [&out](unsigned at, std::uint32_t v, unsigned bytes) {
    std::memcpy(out.data() + at, &v, bytes);
  };
  const std::uint8_t ident[] = {0x7F, 'E', 'L', 'F', 1, 1, 1};
  std::memcpy(out.data(), ident, sizeof ident);
  put(16, 2, 2);   // executable
  put(18, 40, 2);  // ARM
  put(20, 1, 4);
  put(24, base, 4);          // entry
  put(28, 52, 4);            // program headers
  put(36, 0x0500'0000u, 4);  // EABI 5
  put(40, 52, 2);
  put(42, 32, 2);
  put(44, 1, 2);
  const auto size = static_cast<std::uint32_t>(image.size());
  const std::uint32_t header[] = {1, kOffset, base, base, size, size, 7, 4096};
  std::memcpy(out.data() + 52, header, sizeof header);
  std::copy(image.begin(), image.end(), out.begin() + kOffset);
  return out;
}

}  // namespace fovea::cpu::test
