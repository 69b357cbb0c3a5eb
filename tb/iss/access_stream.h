// Determines the memory accesses of an instruction from its word and the registers before it, and
// what its loads must leave in the registers. Independent of the core's decoder.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "model/cpu/core/core.h"
#include "tb/iss/cache_oracle.h"

namespace fovea::cpu::test {

/// Used with a core that stops at every instruction boundary: passes the accesses of the next
/// instruction to the oracle. Supports user-visible loads, stores, SWP, and CP15 c1, c7, c9, c15.
class AccessStream {
 public:
  AccessStream(const Core& core, std::span<const std::uint8_t> tcm, CacheOracle& oracle)
      : core_(core), tcm_(tcm), oracle_(oracle) {}
  /// To be called at each instruction boundary, at least once. No instruction may cause an
  /// exception.
  void boundary();
  /// To be called after the last instruction: checks what it has loaded.
  void check();
  /// Number of data accesses passed to the oracle.
  std::uint64_t accesses() const { return accesses_; }
  /// The first loaded value that differs from the oracle's; empty if none does.
  const std::string& complaint() const { return complaint_; }

 private:
  struct Loaded {
    std::uint32_t pc;
    unsigned reg;
    std::uint32_t value, mask;
  };
  std::uint32_t reg(unsigned n) const { return n == 15 ? pc_ + (thumb_ ? 4 : 8) : core_.reg(n); }
  static bool internal(std::uint32_t a) { return a < 0x8000u || (a >= 0x1'0000u && a < 0x1'8000u); }
  bool passes(unsigned condition) const;
  bool may_go_to_next(std::uint32_t w) const;
  void arm(std::uint32_t w);
  void thumb(std::uint32_t w);
  void coprocessor(std::uint32_t w);
  void block(bool load, std::uint32_t address, std::uint32_t list, unsigned base);
  void transfer(bool load, std::uint32_t address, unsigned bytes, bool sign, unsigned d);
  std::uint32_t shifted(std::uint32_t w) const;
  void load(std::uint32_t address, unsigned bytes, bool sign, unsigned d);
  void store(std::uint32_t address, unsigned bytes, const std::vector<std::uint32_t>& values);

  const Core& core_;
  std::span<const std::uint8_t> tcm_;
  CacheOracle& oracle_;
  std::uint32_t pc_ = 0, cpsr_ = 0;
  bool thumb_ = false;
  std::vector<Loaded> loaded_;
  std::uint64_t executed_ = ~std::uint64_t{0};  ///< instructions executed before the one passed
                                                ///< last
  std::uint64_t accesses_ = 0;
  std::string complaint_;
};

}  // namespace fovea::cpu::test
