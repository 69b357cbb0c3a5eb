// Random privileged programs for the environment of system/random.c.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace fovea::cpu::test {

/// Kinds of steps that are counted separately.
enum class Step : unsigned {
  kData,
  kFlags,
  kModeByMsr,
  kModeBySwi,
  kStatus,
  kSwi,
  kUndefined,
  kLoad,
  kStore,
  kAsUser,
  kDouble,
  kSwap,
  kLoadMany,
  kStoreMany,
  kUserBank,
  kUserBase,
  kReturn,
  kReturnByLdm,
  kCp15,
  kDomains,
  kControl,
  kFetch,
  kInterrupt,
  kThumb,
  kCount
};
inline constexpr std::array<const char*, static_cast<std::size_t>(Step::kCount)> kStepNames = {
    "data",      "flags",      "mode by MSR", "mode by SWI", "status",        "SWI",
    "undefined", "load",       "store",       "as user",     "double",        "swap",
    "load many", "store many", "user bank",   "user base",   "return",        "return by LDM",
    "CP15",      "domains",    "control",     "fetch",       "interrupt",     "Thumb"};

struct SystemCode {
  static constexpr std::uint32_t kBase = 0x0020'0000;
  std::vector<std::uint8_t> image;  ///< to be loaded at kBase
  std::array<unsigned, static_cast<std::size_t>(Step::kCount)> counts{};
  std::uint64_t instructions = 0;  ///< on the main path, without handlers
};

/// @param resume address of the variable of that name in the harness
SystemCode generate_system(std::uint64_t seed, unsigned blocks, unsigned steps,
                           std::uint32_t resume);

}  // namespace fovea::cpu::test
