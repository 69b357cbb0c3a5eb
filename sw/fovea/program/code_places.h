// Where a program's functions lie and what their code is, whatever its addresses are.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sw/fovea/program/elf_image.h"

namespace fovea::app {

/// Digits of a hash of the code at [address, address + size). Code that was only moved, or that refers to
/// something that was moved, has the same hash: branches that leave it, and words that hold an address
/// of the program, count by the symbol that they mean. A number that could be an address counts as one.
std::string code_hash(const ElfImage& image, std::uint32_t address, std::uint32_t size, bool thumb);

/// The same of all objects of the program that have a size and contents, in the order of their names.
std::string data_hash(const ElfImage& image);

}  // namespace fovea::app
