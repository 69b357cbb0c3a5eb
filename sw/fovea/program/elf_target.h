// Checks for which processor an ELF file was built (Addenda to the ABI for the Arm Architecture,
// build attributes; ELF for the Arm Architecture, e_flags).
#pragma once
#include <cstdint>
#include <span>
#include <string>

namespace fovea::app {

inline constexpr const char* kAllowedTarget =
    "allowed: code for ARMv5TEJ or older (-mcpu=arm926ej-s -mfloat-abi=soft)";

/// @return why an ARM926EJ-S cannot run a program with these e_flags; "" if it can
std::string unfit_flags(std::uint32_t e_flags);

/// @param section contents of the section `.ARM.attributes`
/// @return why an ARM926EJ-S cannot run the program; "" if it can, or if the section does not say
std::string unfit_attributes(std::span<const std::uint8_t> section);

}  // namespace fovea::app
