// Random instruction sequences, drawn from the rows of the table of instructions.
#pragma once
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace fovea::cpu::test {

/// A program of many sequences for kMemory. Each sequence gets all registers and the flags from a
/// table, works on 128 bytes of its own, and leaves r0..r12, r14 and the CPSR in the 64 bytes
/// before these. At the end the program writes all of these to file 1 and exits, with Linux' system
/// calls.
struct RandomProgram {
  std::vector<std::uint8_t> image;
  std::vector<std::uint32_t> begin, end;  ///< code of each sequence
  struct Spot {
    std::uint32_t address;
    int row;
    bool thumb;
    bool certain;  ///< executed for all values of the flags
  };
  std::vector<Spot> spots;            ///< each instruction of the sequences
  std::vector<std::uint64_t> counts;  ///< for each row: number of its spots that are certain
};
inline constexpr unsigned kLeftBytes = 16 * 4, kDataBytes = 128,
                          kSequenceBytes = kLeftBytes + kDataBytes;

/// A row that no sequence contains, and the reason.
struct Excuse {
  const char* row;
  const char* reason;
};
std::span<const Excuse> excuses();
bool excused(int row);

/// @param length number of rows drawn for a sequence; most need additional instructions
RandomProgram generate(std::uint64_t seed, unsigned sequences, unsigned length);
/// The program as an executable file for Linux.
std::vector<std::uint8_t> as_elf(const std::vector<std::uint8_t>& image, std::uint32_t base);

}  // namespace fovea::cpu::test
