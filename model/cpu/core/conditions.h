// The condition field of instructions (ARM DDI 0100, A3.2).
#pragma once
#include <array>
#include <cstdint>

namespace fovea::cpu {

inline constexpr unsigned kAlways = 14;

/// True if the flags meet a condition. The only definition of the conditions: with a constant
/// condition it compiles to the test of the flags that the condition needs.
[[gnu::always_inline]] constexpr bool condition_holds(unsigned condition, bool n, bool z, bool c,
                                                      bool v) {
  switch (condition) {
    case 0: return z;
    case 1: return !z;
    case 2: return c;
    case 3: return !c;
    case 4: return n;
    case 5: return !n;
    case 6: return v;
    case 7: return !v;
    case 8: return c && !z;
    case 9: return !c || z;
    case 10: return n == v;
    case 11: return n != v;
    case 12: return !z && n == v;
    case 13: return z || n != v;
    default: return condition == kAlways;
  }
}

/// For each condition, a bit for each value of the CPSR's bits 31:28.
inline constexpr auto kConditionTable = [] {
  std::array<std::uint16_t, 16> table{};
  for (unsigned condition = 0; condition < 16; ++condition)
    for (unsigned flags = 0; flags < 16; ++flags)
      if (condition_holds(condition, flags & 8, flags & 4, flags & 2, flags & 1))
        table[condition] = static_cast<std::uint16_t>(table[condition] | 1u << flags);
  return table;
}();

/// The same for a condition and a CPSR that are known only at run time.
inline bool condition_holds(unsigned condition, std::uint32_t cpsr) {
  return kConditionTable[condition] >> (cpsr >> 28) & 1u;
}

}  // namespace fovea::cpu
