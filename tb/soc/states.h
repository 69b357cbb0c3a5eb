// States of the chip's blocks in which some registers cannot be written, or a write goes elsewhere, as data.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/common/regbank.h"

namespace fovea::soc {

struct Write {
  const char* reg;
  std::uint32_t word;
};
struct Bits {
  const char* reg;
  std::uint32_t bits;
};
/// A write to one register changes another one. Both may end in `*`.
struct Move {
  std::string written;
  std::string changed;
};

/// Names of registers in `odd`, `left_out` and `moves` may end in `*`, which stands for any end.
struct State {
  const char* block;
  const char* name;
  const char* source;          ///< document and section; "family": a sister chip's; "16550": of the part it follows
  std::vector<Write> enter{};  ///< from a block with its clock on, as after a reset
  std::vector<Bits> locked{};  ///< what a write does not change in this state, although it does in others
  std::vector<Move> moves{};
  std::vector<const char*> odd{};       ///< do not read back what is written: commands, data, two registers in one
  std::vector<Bits> zeros{}, ones{};    ///< how bits are written that would end the state
  std::vector<const char*> left_out{};  ///< a write would end the state
};

const std::vector<State>& states();

inline bool matches(const std::string& pattern, const std::string& name) {
  return pattern.ends_with('*') ? name.starts_with(pattern.substr(0, pattern.size() - 1)) : name == pattern;
}

/// The bits that a write of ones clears.
inline std::uint32_t cleared_by(const Reg& r, std::uint32_t word) {
  std::uint32_t bits = 0;
  for (const Field* f : r.fields())
    if (f->mode() == Mode::kW1c) bits |= f->mask();
  return bits & word;
}

}  // namespace fovea::soc
