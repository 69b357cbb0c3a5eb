// Text of an instruction, in the syntax that GNU objdump prints and GNU as reads (unified).
#pragma once
#include <cstdint>
#include <string>

namespace fovea::cpu {

/// @param word an ARM word, or a Thumb halfword; the two halves of a Thumb BL or BLX may come
///        together, the first in bits 15:0
/// @param pc   its address, for branch targets
/// @return an undefined instruction or a lone half of a BL as data (`.word`, `.short`)
std::string disassemble(std::uint32_t word, bool thumb, std::uint32_t pc);

}  // namespace fovea::cpu
