// The generator. Encodings: ARM ARM DDI 0100, chapters A3 and A6. Only defined, aligned code: there
// qemu and the chip agree.
#include "tb/iss/random_code.h"

#include <cstring>

#include "tb/iss/machine.h"

namespace fovea::cpu::test {
namespace {

constexpr std::uint32_t kAlways = 14u << 28;

class Generator {
 public:
  Generator(std::uint64_t seed, unsigned sequences, unsigned length)
      : random_(seed), length_(length) {
    // Code first; tables and results follow at a place that does not depend on its length.
    const std::uint32_t code_bytes = sequences * (length * 16 + 160) + 256;
    tables_ = kMemory + (code_bytes + 4095) / 4096 * 4096;
    results_ = tables_ + sequences * 64;
    for (unsigned k = 0; k < sequences; ++k) sequence(k);
    finish(sequences);
  }
  RandomProgram program;

 private:
  std::uint32_t r(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }
  bool one_in(std::uint32_t n) { return r(n) == 0; }
  std::uint32_t here() const { return kMemory + static_cast<std::uint32_t>(program.image.size()); }
  void word(std::uint32_t w) {
    for (unsigned k = 0; k < 4; ++k) program.image.push_back(static_cast<std::uint8_t>(w >> 8 * k));
  }
  void half(std::uint32_t h) {
    for (unsigned k = 0; k < 2; ++k) program.image.push_back(static_cast<std::uint8_t>(h >> 8 * k));
  }
  /// A random instruction of a class, ARM or Thumb.
  void arm(Class c, std::uint32_t w) {
    note(c, false);
    word(w);
  }
  void thumb(Class c, std::uint32_t h) {
    note(c, true);
    half(h);
  }
  void note(Class c, bool is_thumb) {
    ++program.counts[static_cast<std::size_t>(c)];
    program.spots.push_back({here(), c, is_thumb});
  }
  /// Registers a sequence may change: r0..r10 and r14. r11 and r12 hold offset and base of memory
  /// instructions, r13 always points to the data.
  std::uint32_t dest() {
    const std::uint32_t d = r(12);
    return d == 11 ? 14 : d;
  }
  std::uint32_t source() {
    const std::uint32_t s = r(13);
    return s == 12 ? 14 : s;
  }
  std::uint32_t condition() { return one_in(2) ? kAlways : r(14) << 28; }
  std::uint32_t value() {
    constexpr std::uint32_t kEdges[] = {0,          1,          2,          31,         32,
                                        33,         255,        0x7FFF,     0x8000,     0xFFFF,
                                        0x7FFFFFFF, 0x80000000, 0x80000001, 0xFFFFFFFF, 0xFFFF8000,
                                        0x80008000, 0x7FFF7FFF};
    return one_in(3) ? kEdges[r(std::size(kEdges))] : static_cast<std::uint32_t>(random_());
  }
  void load_word(std::uint32_t reg, std::uint32_t v) {  // ldr reg, [pc, #0]; b +4; .word
    word(0xE59F0000u | reg << 12);
    word(0xEA000000u);
    word(v);
  }

  void sequence(unsigned k) {
    const bool is_thumb = k % 3 == 2;
    const std::uint32_t table = tables_ + 64 * k, out = results_ + kSequenceBytes * k;
    program.begin.push_back(here());
    program.out.push_back(out);
    load_word(13, table);
    word(0xE59D0038u);  // ldr r0, [sp, #56]
    word(0xE128F000u);  // msr cpsr_f, r0
    word(0xE89D5FFFu);  // ldmia sp, {r0-r12, lr}
    load_word(13, out + kLeftBytes);
    for (unsigned n = 0; n < 15; ++n) initial_.push_back(n == 14 ? r(32) << 27 : value());
    initial_.push_back(0);
    if (is_thumb) {
      word(0xE28FE001u);  // add lr, pc, #1
      word(0xE12FFF1Eu);  // bx lr
      for (unsigned n = 0; n < length_; ++n) thumb_step();
      if (here() & 2u) half(0x46C0u);
      half(0x4778u);  // bx pc: back to ARM
      half(0x46C0u);
    } else {
      for (unsigned n = 0; n < length_; ++n) arm_step();
    }
    load_word(13, out);
    word(0xE8AD5FFFu);  // stmia sp!, {r0-r12, lr}
    word(0xE10F0000u);  // mrs r0, cpsr
    word(0xE20004FFu);  // and r0, r0, #0xFF000000
    word(0xE58D0000u);  // str r0, [sp]
    program.end.push_back(here());
  }

  std::uint32_t shifter_operand(bool& by_register) {
    by_register = false;
    switch (r(3)) {
      case 0:
        return 1u << 25 | r(4096);
      case 1:
        return r(32) << 7 | r(4) << 5 | source();
      default:
        by_register = true;
        return source() << 8 | r(4) << 5 | 1u << 4 | source();
    }
  }

  void arm_step() {
    const std::uint32_t c = condition();
    switch (r(18)) {
      case 0:
      case 1:
      case 2:
      case 3: {
        bool late;
        const std::uint32_t b = shifter_operand(late);
        const std::uint32_t op = r(16);
        const std::uint32_t n = op == 13 || op == 15 ? 0 : source() << 16;  // MOV, MVN: no Rn
        if (op >= 8 && op < 12)
          arm(Class::kCompare, c | op << 21 | 1u << 20 | n | b);
        else
          arm(late ? Class::kDataShiftReg : Class::kData,
              c | op << 21 | r(2) << 20 | n | dest() << 12 | b);
        break;
      }
      case 4: {  // MUL, MLA: Rd and Rm differ
        const std::uint32_t d = dest();
        std::uint32_t m = source();
        while (m == d) m = source();
        const bool add = one_in(2);
        arm(Class::kMultiply, c | (add ? 1u << 21 : 0) | r(2) << 20 | d << 16 |
                                  (add ? source() << 12 : 0) | source() << 8 | 0x90u | m);
        break;
      }
      case 5: {
        const std::uint32_t lo = dest();
        std::uint32_t hi = dest(), m = source();
        while (hi == lo) hi = dest();
        while (m == lo || m == hi) m = source();
        arm(Class::kLongMultiply,
            c | (4u + r(4)) << 21 | r(2) << 20 | hi << 16 | lo << 12 | source() << 8 | 0x90u | m);
        break;
      }
      case 6:
      case 7: {
        const std::uint32_t op = r(4), x = r(2), y = r(2), n = source(), s = source(), m = source();
        if (op == 2) {  // SMLALxy
          const std::uint32_t lo = dest();
          std::uint32_t hi = dest();
          while (hi == lo) hi = dest();
          arm(Class::kDsp, c | 0x01400080u | hi << 16 | lo << 12 | s << 8 | y << 6 | x << 5 | m);
        } else {
          const bool no_accumulator = op == 3 || (op == 1 && x);
          arm(Class::kDsp, c | 0x01000080u | op << 21 | dest() << 16 |
                               (no_accumulator ? 0 : n << 12) | s << 8 | y << 6 | x << 5 | m);
        }
        break;
      }
      case 8:
        arm(Class::kSaturate,
            c | 0x01000050u | r(4) << 21 | source() << 16 | dest() << 12 | source());
        break;
      case 9:
        arm(Class::kClz, c | 0x016F0F10u | dest() << 12 | source());
        break;
      case 10:
        if (one_in(2)) {
          arm(Class::kStatus, c | 0x0128F000u | source());  // msr cpsr_f
        } else {  // the mode below the flags is not the same everywhere
          const std::uint32_t d = dest();
          arm(Class::kStatus, c | 0x010F0000u | d << 12);
          word(0xE20004FFu | d << 16 | d << 12);
        }
        break;
      case 11:
      case 12:
      case 13:
        memory_step(c);
        break;
      case 14:
        block_step(c);
        break;
      case 15: {  // swp: Rn is not Rd or Rm
        word(0xE28DC000u | 4 * r(32));
        arm(Class::kSwap, c | 0x010C0090u | r(2) << 22 | dest() << 12 | dest());
        break;
      }
      default: {  // over one or two instructions
        const std::uint32_t kind = r(3), n = 1 + r(2);
        if (kind == 0) {
          arm(Class::kBranch, c | 0x0A000000u | (n - 1));
        } else if (kind == 1) {
          arm(Class::kBranch, c | 0x0B000000u | (n - 1));
        } else {  // add r9, pc, #...; bx or blx r9
          word(0xE28F9000u | 4 * n);
          arm(Class::kBranch, c | (one_in(2) ? 0x012FFF10u : 0x012FFF30u) | 9u);
        }
        for (unsigned k = 0; k < n; ++k)
          arm(Class::kData, kAlways | r(16 - 8) << 21 | source() << 16 | dest() << 12 | source());
        break;
      }
    }
  }

  /// Words, bytes, halves and pairs at r12 + offset, all forms of address. r12 = r13 + 64 before.
  void memory_step(std::uint32_t c) {
    word(0xE28DC040u);
    const std::uint32_t kind = r(7), pre = r(2), up = r(2), back = pre ? r(2) : 0;
    const std::uint32_t puw = pre << 24 | up << 23 | back << 21 | 12u << 16;
    if (kind < 4) {  // word, byte
      const std::uint32_t byte = kind >= 2, load = kind & 1u;
      std::uint32_t offset;
      if (one_in(2)) {
        offset = byte ? r(64) : 4 * r(16);
      } else if (one_in(2)) {  // r11 <= 15, shifted left by 2
        word(0xE200B00Fu | source() << 16);
        offset = 1u << 25 | 2u << 7 | 11;
      } else {
        word(0xE200B03Cu | source() << 16);
        offset = 1u << 25 | 11;
      }
      arm(load ? Class::kLoad : Class::kStore,
          c | 0x04000000u | puw | byte << 22 | load << 20 | dest() << 12 | offset);
      return;
    }
    const bool pair = kind == 6;
    std::uint32_t offset;
    if (one_in(2)) {
      const std::uint32_t o = pair ? 8 * r(7) : 2 * r(31);
      offset = 1u << 22 | (o >> 4) << 8 | (o & 15u);
    } else {
      word(0xE200B038u | source() << 16);
      offset = 11;
    }
    if (pair) {  // the pair does not touch r11 to r13
      arm(Class::kDouble, c | puw | (2 * r(5)) << 12 | offset | (one_in(2) ? 0xD0u : 0xF0u));
    } else {
      const std::uint32_t op = r(4);  // strh, ldrh, ldrsb, ldrsh
      arm(Class::kNarrow, c | puw | (op ? 1u << 20 : 0) | dest() << 12 | offset |
                              (op == 0 ? 0xB0u : 0x90u | op << 5));
    }
  }

  void block_step(std::uint32_t c) {
    word(0xE28DC040u);
    std::uint32_t list = (static_cast<std::uint32_t>(random_()) & 0x7FFu) | r(2) << 14;
    if (!list) list = 1;
    arm(Class::kBlock, c | 0x080C0000u | r(4) << 23 | r(2) << 21 | r(2) << 20 | list);
  }

  void thumb_step() {
    const std::uint32_t d = r(8), m = r(8), n = r(8);
    switch (r(12)) {
      case 0:
        thumb(Class::kThumbShift, r(3) << 11 | r(32) << 6 | m << 3 | d);
        break;
      case 1:
        thumb(Class::kThumbAlu, 0x1800u | r(4) << 9 | n << 6 | m << 3 | d);
        break;
      case 2:
        thumb(Class::kThumbAlu, 0x2000u | r(4) << 11 | d << 8 | r(256));
        break;
      case 3:
      case 4:
      case 5: {
        std::uint32_t op = r(16);
        if (op == 13 && d == m) op = 12;  // MUL: Rd and Rm differ
        const bool shift = (op >= 2 && op <= 4) || op == 7;
        thumb(shift ? Class::kThumbShift : Class::kThumbAlu, 0x4000u | op << 6 | m << 3 | d);
        break;
      }
      case 6: {  // one of the two is a high register
        const std::uint32_t op = r(3), high = one_in(3) ? 14 : 8 + r(3);
        const bool to_high = one_in(2);
        const std::uint32_t rd = to_high ? high : d, rm = to_high ? source() : high;
        thumb(Class::kThumbHigh, 0x4400u | op << 8 | (rd & 8u) << 4 | rm << 3 | (rd & 7u));
        break;
      }
      case 7:
      case 8:
        thumb_memory(d, m, n);
        break;
      case 9:
        if (one_in(2)) {  // add rd, pc or sp, #imm (sp: an address inside the data)
          thumb(Class::kThumbAlu, (one_in(2) ? 0xA000u : 0xA800u) | d << 8 | r(32));
        } else {
          const std::uint32_t list = 1 + r(127), base = 7;
          half(0xA800u | base << 8 | r(24));  // add r7, sp, #...
          const bool load = one_in(2);
          thumb(Class::kThumbBlock, (load ? 0xC800u : 0xC000u) | base << 8 | list);
        }
        break;
      case 10:
        if (one_in(2)) {  // push and pop around the middle of the data
          half(0xB010u);  // add sp, #64
          const std::uint32_t list = 1 + r(255);
          thumb(Class::kThumbBlock, 0xB400u | list);
          thumb(Class::kThumbBlock, 0xBC00u | list);
          half(0xB090u);
        } else {
          thumb(Class::kThumbAlu, 0x2800u | d << 8 | r(256));
        }
        break;
      default:
        if (one_in(3)) {  // bl over one instruction
          thumb(Class::kThumbBranch, 0xF000u);
          thumb(Class::kThumbBranch, 0xF801u);
        } else if (one_in(2)) {
          thumb(Class::kThumbBranch, 0xD000u | r(14) << 8);
        } else {
          thumb(Class::kThumbBranch, 0xE000u);
        }
        thumb(Class::kThumbAlu, 0x2000u | r(4) << 11 | d << 8 | r(256));
        if (program.image[program.image.size() - 3] == 0xF8u) {
          thumb(Class::kThumbAlu, 0x4040u | m << 3 | d);
        }
        break;
    }
  }

  void thumb_memory(std::uint32_t d, std::uint32_t m, std::uint32_t n) {
    half(0xA800u | m << 8);  // add rm, sp, #0
    switch (r(4)) {
      case 0: {  // register offset, a multiple of 4 below 64
        if (n == m) n = (m + 1) & 7u;
        half(0x2000u | n << 8 | 4 * r(16));
        thumb(Class::kThumbMemory, 0x5000u | r(8) << 9 | n << 6 | m << 3 | d);
        break;
      }
      case 1:
        thumb(Class::kThumbMemory, 0x6000u | r(4) << 11 | r(32) << 6 | m << 3 | d);
        break;
      case 2:
        thumb(Class::kThumbMemory, 0x8000u | r(2) << 11 | r(32) << 6 | m << 3 | d);
        break;
      default:
        thumb(Class::kThumbMemory, 0x9000u | r(2) << 11 | d << 8 | r(32));
        break;
    }
  }

  void finish(unsigned sequences) {
    load_word(1, results_);
    load_word(2, sequences * kSequenceBytes);
    word(0xE3A00001u);  // mov r0, #1
    word(0xE3A07004u);  // mov r7, #4: write
    word(0xEF000000u);
    word(0xE3A00000u);
    word(0xE3A07001u);  // exit
    word(0xEF000000u);
    while (here() < tables_) program.image.push_back(0);
    for (const std::uint32_t v : initial_) word(v);
    for (unsigned k = 0; k < sequences; ++k)
      for (unsigned n = 0; n < kSequenceBytes / 4; ++n) word(n < 15 ? 0 : value());
  }

  std::mt19937_64 random_;
  unsigned length_;
  std::uint32_t tables_ = 0, results_ = 0;
  std::vector<std::uint32_t> initial_;
};

}  // namespace

RandomProgram generate(std::uint64_t seed, unsigned sequences, unsigned length) {
  return Generator(seed, sequences, length).program;
}

std::vector<std::uint8_t> as_elf(const std::vector<std::uint8_t>& image, std::uint32_t base) {
  constexpr std::uint32_t kOffset = 4096;  // offset and address agree within a page
  std::vector<std::uint8_t> out(kOffset);
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
  out.insert(out.end(), image.begin(), image.end());
  return out;
}

}  // namespace fovea::cpu::test
