// Interface for observers of register accesses.
#pragma once
#include <cstdint>

namespace fovea {

class Reg;
class RegBank;

struct RegisterAccess {
  const RegBank* bank = nullptr;
  const Reg* reg = nullptr;  ///< null: no register at the offset
  std::uint32_t offset = 0;
  unsigned bytes = 0;
  bool write = false;
  bool gated = false;       ///< the block's clock is off: nothing happened
  std::uint32_t value = 0;  ///< read or written, from bit 0 on
  friend bool operator==(const RegisterAccess&, const RegisterAccess&) = default;
};

/// Called after each access that came over the bus, in kernel time. An observer changes nothing.
class RegisterObserver {
 public:
  virtual ~RegisterObserver() = default;
  virtual void accessed(const RegisterAccess& access) = 0;
};

}  // namespace fovea
