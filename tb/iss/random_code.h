// Random instruction sequences: what the generator of the differential test gives and counts.
#pragma once
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace fovea::cpu::test {

/// Kinds of instruction that are counted apart.
enum class Class : unsigned {
  kData,
  kDataShiftReg,
  kCompare,
  kMultiply,
  kLongMultiply,
  kDsp,
  kSaturate,
  kClz,
  kStatus,
  kLoad,
  kStore,
  kNarrow,
  kDouble,
  kBlock,
  kSwap,
  kBranch,
  kThumbAlu,
  kThumbShift,
  kThumbHigh,
  kThumbMemory,
  kThumbBlock,
  kThumbBranch,
  kCount
};
inline constexpr std::array<const char*, static_cast<std::size_t>(Class::kCount)> kClassNames = {
    "data",          "data shift by register",
    "compare",       "multiply",
    "long multiply", "dsp",
    "saturate",      "clz",
    "status",        "load",
    "store",         "narrow",
    "double",        "block",
    "swap",          "branch",
    "thumb alu",     "thumb shift",
    "thumb high",    "thumb memory",
    "thumb block",   "thumb branch"};

/// A program of many sequences for kMemory. Each gets all registers and the flags from a table,
/// works on 128 bytes of its own and leaves r0..r12, r14 and the CPSR in the 64 before them. At the
/// end the program writes that region to file 1 and exits, by Linux' system calls.
struct RandomProgram {
  std::vector<std::uint8_t> image;
  std::vector<std::uint32_t> out;         ///< address of what sequence k leaves
  std::vector<std::uint32_t> begin, end;  ///< its code
  std::array<std::uint64_t, static_cast<std::size_t>(Class::kCount)> counts{};
  struct Spot {
    std::uint32_t address;
    Class kind;
    bool thumb;
  };
  std::vector<Spot> spots;  ///< each random instruction
};
inline constexpr unsigned kLeftBytes = 16 * 4, kDataBytes = 128,
                          kSequenceBytes = kLeftBytes + kDataBytes;

/// @param length random steps in a sequence; some steps are two instructions
RandomProgram generate(std::uint64_t seed, unsigned sequences, unsigned length);
/// The program as an executable file for Linux.
std::vector<std::uint8_t> as_elf(const std::vector<std::uint8_t>& image, std::uint32_t base);

}  // namespace fovea::cpu::test
