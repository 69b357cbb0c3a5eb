// The register file: general registers, their banked copies, status registers and flags
// (ARM DDI 0100, A2.4 to A2.6).
#pragma once
#include <array>
#include <cstdint>

namespace fovea::cpu {

enum class CpuMode : std::uint32_t {
  kUsr = 0x10, kFiq = 0x11, kIrq = 0x12, kSvc = 0x13, kAbt = 0x17, kUnd = 0x1B, kSys = 0x1F
};

/// Bits of the CPSR.
inline constexpr std::uint32_t kN = 1u << 31, kZ = 1u << 30, kC = 1u << 29, kV = 1u << 28,
                               kQ = 1u << 27;
inline constexpr std::uint32_t kIrqMask = 1u << 7, kFiqMask = 1u << 6, kThumbState = 1u << 5,
                               kModeBits = 31;

/// The handlers of decoded records use the data members directly. While Core::run() is active
/// (`flags_live`), N, Z, C and V are kept in members of their own. Code that needs them in `cpsr`
/// calls pack_flags() first, and unpack_flags() after any change of `cpsr`.
class RegisterFile {
  template <class File>
  static auto& find(File& f, unsigned of_bank, unsigned number) {
    const unsigned present = bank(f.cpsr);
    if (number >= 13)
      return of_bank == present ? f.r[number] : f.banked_[of_bank][number - 13];
    const bool fiq = of_bank == 1;
    if (fiq == (present == 1)) return f.r[number];
    return (fiq ? f.fiq_high_ : f.user_high_)[number - 8];
  }

 public:
  static constexpr unsigned kBanks = 6;
  /// Number of the bank of a mode: 0 for user and system mode, then FIQ, IRQ, SVC, ABT, UND.
  static unsigned bank(std::uint32_t mode);


  std::uint32_t status() const { return flags_live ? packed() : cpsr; }
  bool thumb() const { return cpsr & kThumbState; }
  bool privileged() const {
    return (cpsr & kModeBits) != static_cast<std::uint32_t>(CpuMode::kUsr);
  }
  std::uint32_t packed() const {
    return (cpsr & 0x0FFF'FFFFu) | (n & kN) | (z ? 0 : kZ) | std::uint32_t{c} << 29 |
           std::uint32_t{v} << 28;
  }
  void pack_flags() { cpsr = packed(); }
  void unpack_flags() {
    n = cpsr;
    z = ~cpsr & kZ;
    c = cpsr >> 29 & 1u;
    v = cpsr >> 28 & 1u;
  }
  /// Changes the mode and exchanges the banked registers.
  void switch_mode(std::uint32_t mode);
  /// The SPSR of the present mode; user and system mode have one that no instruction can reach.
  std::uint32_t& spsr() { return spsr_[bank(cpsr)]; }
  std::uint32_t& spsr(unsigned of_bank) { return spsr_[of_bank]; }
  std::uint32_t spsr(unsigned of_bank) const { return spsr_[of_bank]; }
  /// r8 to r14 of a bank, whether or not its mode is the present one. r8 to r12 exist only in bank
  /// 0 and in that of FIQ mode.
  std::uint32_t& banked(unsigned of_bank, unsigned number) {
    return find(*this, of_bank, number);
  }
  std::uint32_t banked(unsigned of_bank, unsigned number) const {
    return find(*this, of_bank, number);
  }
  /// The copy that is kept of r8 to r12 outside FIQ mode, while FIQ mode is present.
  std::uint32_t& user_high(unsigned number) { return user_high_[number - 8]; }

  std::array<std::uint32_t, 16> r{};  // r[15] is set only for instructions that read it
  // Flags in the form in which results provide them: bit 31 of n is N, and Z is set if z is zero.
  // The order of the members keeps compilers from merging the stores of two flags, which takes
  // longer than two stores.
  std::uint32_t n = 0;
  std::uint8_t c = 0;
  std::uint32_t z = 1;
  std::uint8_t v = 0;
  bool flags_live = false;
  std::uint32_t pc = 0;
  std::uint32_t cpsr = 0xD3;

 private:
  std::array<std::array<std::uint32_t, 2>, kBanks> banked_{};  // for each bank: r13, r14
  std::array<std::uint32_t, 5> user_high_{};                   // r8..r12 outside FIQ mode
  std::array<std::uint32_t, 5> fiq_high_{};
  std::array<std::uint32_t, kBanks> spsr_{};
};

inline unsigned RegisterFile::bank(std::uint32_t mode) {
  switch (static_cast<CpuMode>(mode & kModeBits)) {
    case CpuMode::kFiq: return 1;
    case CpuMode::kIrq: return 2;
    case CpuMode::kSvc: return 3;
    case CpuMode::kAbt: return 4;
    case CpuMode::kUnd: return 5;
    default: return 0;
  }
}

inline void RegisterFile::switch_mode(std::uint32_t mode) {
  const unsigned from = bank(cpsr), to = bank(mode);
  if (from != to) {
    banked_[from] = {r[13], r[14]};
    if (from == 1 || to == 1) {
      auto& keep = from == 1 ? fiq_high_ : user_high_;
      const auto& bring = to == 1 ? fiq_high_ : user_high_;
      for (unsigned k = 0; k < 5; ++k) {
        keep[k] = r[8 + k];
        r[8 + k] = bring[k];
      }
    }
    r[13] = banked_[to][0];
    r[14] = banked_[to][1];
  }
  cpsr = (cpsr & ~kModeBits) | (mode & kModeBits);
}

}  // namespace fovea::cpu
