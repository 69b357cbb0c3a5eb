// Executes each row of the table of instructions with plain operands, and measures its clocks.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "model/cpu/core/isa.h"
#include "tb/iss/hand_counts.h"

namespace fovea::cpu::test {

inline constexpr unsigned kListedRegisters = 2;  ///< in a list, without pc and lr

/// A word with plain operands: no shift, no flags, addresses in internal RAM, branches to the next
/// instruction.
std::uint32_t plain(int row);

struct RowRun {
  std::uint64_t clocks;
  std::uint32_t mode;  ///< afterwards
};
/// @param use a register that the next instruction adds to another one; -1: none comes
RowRun run_row(int row, int use = -1);

/// The register of plain(row) that is written last, -1: none that a following addition could read.
int last_result(int row);

/// The hand count of a row, nullptr unless there is exactly one.
const HandCount* hand_count(const std::string& name);

/// What differs from the row's hand count, which must exist: its clocks, its mode, the clocks of
/// an instruction behind it that uses its result. @param uses counts rows with such a result
std::vector<std::string> wrong_clocks(int row, unsigned* uses = nullptr);

}  // namespace fovea::cpu::test
