// Generates random programs: what ARM and Thumb steps share. Only defined, aligned code, for which
// qemu and the chip agree. Known differences, which are not generated: unaligned accesses, stores
// of the pc (+12 on the chip), the pc with a shift by register.
#pragma once
#include <cstring>

#include "model/cpu/core/isa.h"
#include "tb/iss/machine.h"
#include "tb/iss/random_code.h"

namespace fovea::cpu::test {

inline const IsaRow& row_at(int row) { return isa_rows()[static_cast<std::size_t>(row)]; }

class Generator {
 public:
  Generator(std::uint64_t seed, unsigned sequences, unsigned length);
  RandomProgram program;

 private:
  static constexpr std::uint32_t kAlways = 14u << 28;
  static constexpr std::uint32_t kSp = 13, kPc = 15;

  // Random numbers.
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
  /// A register that a sequence may change: all but r13, which always points to the data.
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

  // Code generation.
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
    // A conditional Thumb branch always counts, taken or not.
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
  /// Emits reg = constant and returns the constant's address: ldr reg, [pc, #0]; b; .word
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
  void arm_filler() { arm(kAlways | r(8) << 21 | dest() << 12 | r(13) << 16 | r(13)); }
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
  /// Emits code that a jump skips or may skip: not counted.
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
  /// Emits the target of an ARM jump: behind some instructions, perhaps via Thumb code.
  /// @return its address with the Thumb bit
  std::uint32_t arm_landing(bool to_thumb) {
    skip_arm();
    const std::uint32_t at = here();
    if (!to_thumb) return at;
    thumb_filler();
    thumb_to_arm();
    return at | 1u;
  }
  /// The same for Thumb. A link register must be used before r14 is changed to return.
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

  /// Random fields, with registers that a sequence may change. Repeated until the row defines the
  /// result.
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

  // random_arm.cpp
  void arm_step(int row);
  bool arm_data_jump(int row);
  static std::uint32_t unit(Op op);
  void arm_memory(int row);
  bool shifted(IsaFields& f, std::uint32_t distance, std::uint32_t& in_register);
  void arm_block(int row);
  void arm_branch(int row);

  // random_thumb.cpp
  void thumb_step(int row);
  void thumb_high(int row);
  void thumb_memory(int row);
  void thumb_block(int row);
  void thumb_branch(int row);
  std::uint32_t thumb_back_target(bool arm_code);

  // random_code.cpp
  int next_row(bool thumb_state);
  void sequence(unsigned k);
  void finish(unsigned sequences);

  std::mt19937_64 random_;
  unsigned length_;
  std::uint32_t tables_ = 0, results_ = 0, target_exit_ = 0;
  bool skipped_ = false;
  std::vector<int> decks_[2];
};

}  // namespace fovea::cpu::test
