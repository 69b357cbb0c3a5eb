#include "tb/iss/system_code.h"

#include <bit>
#include <random>
#include <stdexcept>

namespace fovea::cpu::test {
namespace {

using Word = std::uint32_t;

constexpr Word kRegions = 0x4000'0000, kAlways = 0xE000'0000;
constexpr Word kUsr = 0x10, kFiq = 0x11, kIrq = 0x12, kSvc = 0x13, kAbt = 0x17, kUnd = 0x1B,
               kSys = 0x1F;
constexpr Word kModes[] = {kUsr, kFiq, kIrq, kSvc, kAbt, kUnd, kSys};

/// Writes one straight line of code. It knows the mode at every point: nothing that moves it hangs
/// on data, and every exception comes back.
class Writer {
 public:
  Writer(std::uint64_t seed, Word resume) : random_(seed), resume_(resume) {}

  SystemCode run(unsigned blocks, unsigned steps) {
    for (unsigned b = 0; b < blocks; ++b) {
      for (unsigned s = 0; s < steps; ++s) step();
      // All banks, seen from an SWI and from an abort.
      put(pick(2) ? 0xEF000080u : 0xE1200070u);
    }
    leave_for(kSvc);
    constant(0, SystemCode::kBase);
    put(0xE510F004u);  // ldr pc, [r0, #-4]
    return std::move(out_);
  }

 private:
  Word pick(Word n) { return static_cast<Word>(random_() % n); }
  bool one_in(Word n) { return pick(n) == 0; }
  Word low() { return pick(8); }
  Word any() { return pick(15); }
  Word address() const { return SystemCode::kBase + static_cast<Word>(out_.image.size()); }
  void count(Step s) { ++out_.counts[static_cast<std::size_t>(s)]; }
  void raw(Word w, unsigned bytes) {
    for (unsigned k = 0; k < bytes; ++k)
      out_.image.push_back(static_cast<std::uint8_t>(w >> (8 * k)));
  }
  void put(Word w) {
    raw(w, 4);
    ++out_.instructions;
  }
  void half(Word w) {
    raw(w, 2);
    ++out_.instructions;
  }
  /// The word with a random condition, now and then.
  void maybe(Word w) { put(one_in(4) ? (w & 0x0FFFFFFFu) | pick(14) << 28 : w); }
  bool privileged() const { return mode_ != kUsr; }
  bool has_spsr() const { return mode_ != kUsr && mode_ != kSys; }
  Word other_than(std::initializer_list<Word> taken, Word from = 15) {
    for (;;) {
      const Word r = pick(from);
      bool free = true;
      for (const Word t : taken) free = free && t != r;
      if (free) return r;
    }
  }

  /// rd = v, whatever v is: a literal behind the load.
  void constant(Word rd, Word v) {
    put(0xE59F0000u | rd << 12);
    put(0xEA000000u);
    raw(v, 4);
  }
  /// rd = #imm8
  void small(Word rd) { put(0xE3A00000u | rd << 12 | pick(256)); }

  /// Goes on in a mode by SWI.
  void leave_for(Word mode) {
    put(0xEF000040u | mode);
    mode_ = mode;
  }

  /// A place in the regions, aligned, now and then near the end of a kilobyte.
  Word place(Word bytes) {
    const Word region = one_in(8) ? 7 : other_than({8}, 10);
    Word offset = one_in(3) ? pick(32) * 0x400u + 0x400u - 4 - 4 * pick(8) : pick(0x8000);
    if (region == 5) offset = offset * 4 % 0x20000u;
    if (region == 9 || region == 4) offset = offset % 0x8000u;
    if (!aligned_ || !one_in(6)) offset &= ~(bytes - 1);
    return kRegions + region * 0x100000u + (offset ? offset : 64);
  }

  void step() {
    static constexpr struct {
      Step kind;
      Word weight;
    } kWeights[] = {{Step::kData, 14},     {Step::kFlags, 3},       {Step::kModeByMsr, 6},
                    {Step::kModeBySwi, 6}, {Step::kStatus, 4},      {Step::kSwi, 3},
                    {Step::kUndefined, 3}, {Step::kLoad, 9},        {Step::kStore, 9},
                    {Step::kAsUser, 4},    {Step::kDouble, 3},      {Step::kSwap, 2},
                    {Step::kLoadMany, 5},  {Step::kStoreMany, 5},   {Step::kUserBank, 4},
                    {Step::kUserBase, 3},  {Step::kReturn, 5},    {Step::kReturnByLdm, 3}, {Step::kCp15, 4},
                    {Step::kDomains, 3},   {Step::kControl, 2},     {Step::kFetch, 3},
                    {Step::kInterrupt, 2}, {Step::kThumb, 4}};
    Word sum = 0;
    for (const auto& w : kWeights) sum += w.weight;
    Word at = pick(sum);
    for (const auto& w : kWeights) {
      if (at < w.weight) return one(w.kind);
      at -= w.weight;
    }
  }

  void one(Step kind) {
    switch (kind) {
      case Step::kData:
        data();
        break;
      case Step::kFlags:
        put(0xE128F000u | any());
        break;
      case Step::kModeByMsr:
        if (!privileged()) {
          // User mode changes its flags only.
          const Word r = low();
          constant(r, static_cast<Word>(random_()) & ~0x20u);
          put(0xE120F000u | (1 + pick(15)) << 16 | r);
        } else {
          mode_ = kModes[pick(7)];
          put(0xE321F000u | pick(4) << 6 | mode_);  // with its masks
        }
        break;
      case Step::kModeBySwi:
        leave_for(kModes[pick(7)]);
        break;
      case Step::kStatus:
        status();
        break;
      case Step::kSwi:
        maybe(0xEF000010u | pick(16));
        break;
      case Step::kUndefined: {
        constexpr Word kWords[] = {0xE7F000F0u, 0xE7F123F4u, 0xEE000110u, 0xEE123110u,
                                   0xED100500u, 0xEC012304u, 0xE6000010u};
        maybe(kWords[pick(7)]);
        break;
      }
      case Step::kLoad:
      case Step::kStore:
        transfer(kind == Step::kLoad);
        break;
      case Step::kAsUser:
        as_user();
        break;
      case Step::kDouble:
        two_words();
        break;
      case Step::kSwap: {
        const Word rn = any(), rm = other_than({rn}), rd = other_than({rn});
        const Word byte = pick(2);
        constant(rn, place(byte ? 1 : 4));
        maybe(0xE1000090u | byte << 22 | rn << 16 | rd << 12 | rm);
        break;
      }
      case Step::kLoadMany:
      case Step::kStoreMany:
        many(kind == Step::kLoadMany);
        break;
      case Step::kUserBank:
      case Step::kUserBase:
        if (!has_spsr()) return data_instead();
        user_bank(kind == Step::kUserBase);
        break;
      case Step::kReturn:
      case Step::kReturnByLdm:
        if (!has_spsr()) return data_instead();
        return_from_exception(kind == Step::kReturnByLdm);
        break;
      case Step::kCp15:
        cp15();
        break;
      case Step::kDomains: {
        const Word r = low();
        constant(r, (static_cast<Word>(random_()) & 0x3FFFFFFCu) | 0x40000001u);
        put(0xEE030F10u | r << 12);
        break;
      }
      case Step::kControl:
        control();
        break;
      case Step::kFetch:
        fetch();
        break;
      case Step::kInterrupt:
        interrupt();
        break;
      default:
        thumb();
        break;
    }
    count(kind);
  }

  void data() {
    const Word op = pick(16);
    const bool compare = op >= 8 && op <= 11, move = op == 13 || op == 15;
    Word w = kAlways | op << 21 | Word{compare || pick(2)} << 20;
    if (!move) w |= any() << 16;
    if (!compare) w |= any() << 12;
    if (pick(2))
      w |= 1u << 25 | pick(0x1000);
    else
      w |= pick(32) << 7 | pick(4) << 5 | any();
    maybe(w);
  }
  void data_instead() {
    data();
    count(Step::kData);
  }

  void status() {
    const Word rd = any();
    if (has_spsr() && pick(2)) {
      // The flags of the SPSR, from anywhere; its mode stays one that exists.
      if (pick(2))
        put(0xE168F000u | any());
      else
        put(0xE361F000u | pick(8) << 5 | kModes[pick(7)]);
      put(0xE14F0000u | rd << 12);
    } else {
      put(0xE10F0000u | rd << 12);
    }
    // Bits 26:8 are reserved.
    put(0xE3C0067Fu | rd << 16 | rd << 12);
    put(0xE3C00AFFu | rd << 16 | rd << 12);
    put(0xE3C00C0Fu | rd << 16 | rd << 12);
  }

  void transfer(bool load) {
    const Word rn = any(), rd = other_than({rn}), rm = other_than({rn, rd});
    const Word pre = pick(2), up = pick(2), back = pre && pick(2);
    const Word size = pick(5);  // word, byte, half, signed byte, signed half
    const Word bytes = size == 0 ? 4 : size == 1 || size == 3 ? 1 : 2;
    const Word offset = pick(64) * bytes;
    // The access, not the base, goes to the place.
    const Word base = place(bytes) - (pre ? (up ? offset : 0u - offset) : 0);
    constant(rn, base);
    const bool by_register = pick(2);
    if (by_register) constant(rm, offset);
    Word w = kAlways | pre << 24 | up << 23 | back << 21 | Word{load} << 20 | rn << 16 | rd << 12;
    if (size < 2) {
      w |= 1u << 26 | size << 22;
      w |= by_register ? 1u << 25 | rm : offset;
    } else {
      const Word kind = !load || size == 2 ? 1 : size == 3 ? 2 : 3;
      // A store of a signed byte does not exist: it is a store of a half at an even place.
      if (!load && bytes == 1) return transfer(load);
      w |= 0x90u | kind << 5;
      w |= by_register ? rm : 1u << 22 | (offset & 0xF0u) << 4 | (offset & 15u);
    }
    maybe(w);
  }

  void as_user() {
    const Word rn = any(), rd = other_than({rn}), byte = pick(2), up = pick(2);
    constant(rn, place(byte ? 1 : 4));
    maybe(kAlways | 1u << 26 | up << 23 | byte << 22 | 1u << 21 | pick(2) << 20 | rn << 16 |
          rd << 12 | pick(256) * 4);
  }

  void two_words() {
    const Word rd = 2 * pick(7), rn = other_than({rd, rd + 1});
    const Word load = pick(2), pre = pick(2), up = pick(2), offset = 8 * pick(16);
    const Word base = (place(8) & ~7u) - (pre ? (up ? offset : 0u - offset) : 0);
    constant(rn, base);
    maybe(kAlways | pre << 24 | up << 23 | 1u << 22 | (pre && pick(2)) << 21 | rn << 16 | rd << 12 |
          (offset & 0xF0u) << 4 | (load ? 0xD0u : 0xF0u) | (offset & 15u));
  }

  /// Where a block transfer with this base and these many words begins and ends.
  static Word first_of(Word base, Word pre, Word up, Word n) {
    if (up) return pre ? base + 4 : base;
    return pre ? base - 4 * n : base - 4 * n + 4;
  }

  void many(bool load) {
    const Word rn = any(), pre = pick(2), up = pick(2);
    Word list = (1 + pick(0x7FFF)) & static_cast<Word>(random_()) & ~(1u << rn) & 0x7FFFu;
    if (list == 0) list = 1u << other_than({rn});
    // With the base in the list only LDM without write-back and STM whose first register it is, or
    // without write-back, are defined.
    const Word back = pick(2);
    if (one_in(4) && !(load && back)) {
      list |= 1u << rn;
      if (back) list &= ~((1u << rn) - 1u);
    }
    const Word n = static_cast<Word>(std::popcount(list));
    const Word base = place(4);
    constant(rn, base);
    maybe(kAlways | 4u << 25 | pre << 24 | up << 23 | back << 21 | Word{load} << 20 | rn << 16 |
          list);
    const Word from = first_of(base, pre, up, n) & ~3u;
    if (!load || from >> 10 == (from + 4 * n - 4) >> 10) return;
    // It may abort half-way, and what its registers hold then is open.
    for (Word r = 0; r < 15; ++r)
      if (list >> r & 1u) small(r);
  }

  /// A register that the present mode, which has an SPSR, does not share with user mode.
  Word banked() { return mode_ == kFiq ? 8 + pick(7) : 13 + pick(2); }

  /// LDM and STM of the user's registers.
  /// @param base_listed the base is a banked register, and the list has the user's of that number
  void user_bank(bool base_listed) {
    const Word rn = base_listed ? banked() : low(), load = pick(2), pre = pick(2), up = pick(2);
    Word list = pick(0x8000) & static_cast<Word>(random_()) & ~(1u << rn);
    if (base_listed)
      list = one_in(3) ? 1u << rn : list | 1u << rn;
    else
      list |= one_in(2) ? 0x2000u : 0x4000u;
    // Within a kilobyte: it aborts at its first word or not at all.
    Word base = place(4) & ~3u;
    base = (base & ~0x3FFu) + 64 + (base & 0x3FFu) % (0x400u - 128);
    constant(rn, base & ~3u);
    put(kAlways | 4u << 25 | pre << 24 | up << 23 | 1u << 22 | load << 20 | rn << 16 | list);
    put(0xE1A00000u);
  }

  void return_from_exception(bool by_ldm) {
    const Word to = kModes[pick(7)], state = pick(2), r = low();
    constant(r, pick(32) << 27 | pick(4) << 6 | state << 5 | to);
    put(0xE16FF000u | r);  // msr spsr_fsxc
    if (by_ldm) {
      // add r, pc, #0; ldmia r, {a, pc}^; its two words; what lies behind is the target
      const Word a = other_than({r});
      put(0xE28F0000u | r << 12);
      if (pick(2)) {
        put(0xE8D08000u | r << 16 | 1u << a);
      } else {
        put(0xE9D08000u | r << 16 | 1u << a);  // ldmib: the word before is not used
        raw(static_cast<Word>(random_()), 4);
      }
      raw(static_cast<Word>(random_()), 4);
      raw(address() + 4, 4);
    } else {
      const Word kind = pick(3), size = kind == 2 ? 4 : 0;
      const Word at = address() + 12 + (kind == 1 ? 4 : 0) + 4;
      constant(14, at + size);
      if (kind == 1) put(0xE1A00000u);
      put(kind == 2 ? 0xE25EF004u : 0xE1B0F00Eu);
    }
    mode_ = to;
    if (state) to_arm();
  }

  /// From Thumb state at a word.
  void to_arm() {
    half(0x4778);  // bx pc
    half(0x46C0);
  }

  void cp15() {
    const Word r = any();
    constexpr Word kReads[] = {0xEE150F10u, 0xEE150F30u, 0xEE160F10u, 0xEE120F10u,
                               0xEE130F10u, 0xEE100F10u, 0xEE1D0F30u};
    constexpr Word kWrites[] = {0xEE050F10u, 0xEE050F30u, 0xEE060F10u, 0xEE070F9Au,
                                0xEE070F15u, 0xEE080F17u, 0xEE0D0F30u};
    if (pick(2)) return maybe(kReads[pick(7)] | r << 12);
    const Word write = kWrites[pick(7)];
    // Bit 8 of a fault status reads as zero on the chip (ARM DDI 0198D 2.3.7); QEMU keeps it.
    if (write == 0xEE050F10u || write == 0xEE050F30u) put(0xE3C00C01u | r << 16 | r << 12);
    maybe(write | r << 12);
  }

  /// S, R, A and V; the register is cleared behind, as caches differ from run to run.
  void control() {
    const Word r = low(), sr = pick(3), a = pick(2), v = one_in(3);
    put(0xEE110F10u | r << 12);
    put(0xE3C00C03u | r << 16 | r << 12);
    put(0xE3C00002u | r << 16 | r << 12);
    put(0xE3800C00u | sr | r << 16 | r << 12);
    if (a) put(0xE3800002u | r << 16 | r << 12);
    put(0xE3C00A02u | r << 16 | r << 12);
    if (v) put(0xE3800A02u | r << 16 | r << 12);
    put(0xEE010F10u | r << 12);
    put(0xE3A00000u | r << 12);
    if (privileged()) aligned_ = a;
  }

  /// To a page that may not be fetched from, or that says `mov pc, lr`.
  void fetch() {
    const Word a = low(), b = other_than({a}, 8);
    constant(a, resume_);
    const Word behind = address() + 12 + 4 + 12 + 8;
    constant(b, behind);
    put(0xE5800000u | a << 16 | b << 12);
    constant(b, kRegions + (pick(2) ? 0x700000u : 0x800000u) + pick(0x1FF0) * 4);
    put(0xE1A0E00Fu);  // mov lr, pc
    put(pick(2) ? 0xE1A0F000u | b : 0xE12FFF10u | b);
    put(0xE3A00000u | b << 12);
    put(0xE5800000u | a << 16 | b << 12);
  }

  void interrupt() {
    leave_for(kSvc);
    put(0xE321F0D3u);
    const Word a = low(), b = other_than({a}, 8), how = pick(4);
    constexpr Word kLines[] = {1, 1, 2, 2}, kOpen[] = {0x60, 0x70, 0x60, 0xB0};
    constant(a, 0x1014'0000u);
    constant(b, kLines[how]);
    put(0xE5800018u | a << 16 | b << 12);
    mode_ = kModes[pick(7)];
    put(0xEF000000u | kOpen[how] | (mode_ & 15u));
    put(0xE1A00000u);
  }

  void thumb() {
    // add r, pc, #1; bx r
    const Word r = low();
    put(0xE28F0001u | r << 12);
    put(0xE12FFF10u | r);
    for (Word n = 2 + pick(8); n; --n) {
      const Word d = low(), m = low(), b = other_than({d}, 8);
      switch (pick(9)) {
        case 0:
          half(0x2000u | pick(4) << 11 | d << 8 | pick(256));
          break;
        case 1:
          half(0x4000u | pick(16) << 6 | m << 3 | d);
          break;
        case 2:
          half(0xDF00u | 0x40u | (mode_ = kModes[pick(7)]));
          break;
        case 3:
          half(0xDE00u | pick(256));
          break;
        case 4:
          half(0xBE00u | pick(256));
          break;
        case 5:
          half(0x4600u | pick(2) << 7 | any() << 3 | d % 7);
          break;
        default: {
          // b = (0x80 << 3 | region) << 20, then an access
          half(0x2080u | b << 8);
          half(0x00C0u | b << 3 | b);
          half(0x3000u | b << 8 | other_than({8}, 10));
          half(0x0500u | b << 3 | b);
          const Word kind = pick(6);
          constexpr Word kForms[] = {0x6000, 0x6800, 0x7000, 0x7800, 0x8000, 0x8800};
          half(kForms[kind] | pick(32) << 6 | b << 3 | d);
          break;
        }
      }
    }
    if (address() & 2u) half(0x46C0);
    to_arm();
  }

  std::mt19937_64 random_;
  Word resume_, mode_ = kSvc;
  bool aligned_ = false;  ///< the A bit is set
  SystemCode out_;
};

}  // namespace

SystemCode generate_system(std::uint64_t seed, unsigned blocks, unsigned steps,
                           std::uint32_t resume) {
  return Writer(seed, resume).run(blocks, steps);
}

}  // namespace fovea::cpu::test
