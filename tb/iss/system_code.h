// Random privileged programs for the surroundings of system/random.c.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace fovea::cpu::test {

/// Kinds of step that are counted apart.
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
  std::vector<std::uint8_t> image;  ///< for kBase
  std::array<unsigned, static_cast<std::size_t>(Step::kCount)> counts{};
  std::uint64_t instructions = 0;  ///< in the straight line, without handlers
};

/// @param resume address of the harness's variable of that name
SystemCode generate_system(std::uint64_t seed, unsigned blocks, unsigned steps,
                           std::uint32_t resume);

}  // namespace fovea::cpu::test
