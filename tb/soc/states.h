// States of the chip's blocks in which some registers cannot be written, or a write goes elsewhere, as data.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/regbank.h"

namespace fovea::soc {

struct Write {
  const char* reg;  ///< nullptr: `word` nanoseconds pass
  std::uint32_t word;
  const char* block = nullptr;  ///< nullptr: the state's
};
struct Bits {
  const char* reg;
  std::uint32_t bits;
};
/// What a write to one register does to another one, or to what itself reads as. Both names may end in `*`.
struct Move {
  enum class Effect {
    kAny,
    kSets,    ///< the bits that are written as 1, and nothing else
    kClears,  ///< the same, cleared
  };
  std::string written;
  std::string changed;
  Effect effect = Effect::kAny;
};
/// What a register reads while the block is in the state.
struct Sign {
  const char* reg;
  std::uint32_t mask, value;
  const char* block = nullptr;  ///< nullptr: the state's
};
/// A write that changes these bits of a register, or that would if it were not refused, is told in a warning with this
/// text.
struct Warned {
  const char* reg;
  std::uint32_t bits;  ///< 0: each write is
  const char* text;
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
  /// Checked before each write; if one is missing the block has left the state, and enters it again.
  std::vector<Sign> signs{};
  /// Read back over the bus, as the block computes them when they are read; a read has no side effect.
  std::vector<const char*> computed{};
  std::vector<Warned> warned{};
};

const std::vector<State>& states();

inline bool matches(const std::string& pattern, const std::string& name) {
  return pattern.ends_with('*') ? name.starts_with(std::string_view(pattern).substr(0, pattern.size() - 1))
                                : name == pattern;
}

/// The bits that a write of ones clears.
inline std::uint32_t cleared_by(const Reg& r, std::uint32_t word) {
  std::uint32_t bits = 0;
  for (const Field* f : r.fields())
    if (f->mode() == Mode::kW1c) bits |= f->mask();
  return bits & word;
}

}  // namespace fovea::soc
