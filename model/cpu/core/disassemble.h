// Disassembler, in the unified syntax that GNU objdump prints and GNU as reads.
#pragma once
#include <cstdint>
#include <string>

namespace fovea::cpu {

/// @param word an ARM word or a Thumb halfword; for a Thumb BL or BLX, both halfwords may be given,
/// the
///        first one in bits 15:0
/// @param pc   address of the instruction, for branch targets
/// @return the text; an undefined instruction or a single half of a BL is printed as data (`.word`,
///         `.short`)
std::string disassemble(std::uint32_t word, bool thumb, std::uint32_t pc);

}  // namespace fovea::cpu
