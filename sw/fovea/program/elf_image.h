// The target program: an ELF file that is checked and split into segments and symbols.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fovea::app {

/// A loadable part of the program.
struct ElfSegment {
  unsigned index = 0;         ///< number of its program header
  std::uint32_t address = 0;  ///< load address (p_paddr)
  std::uint32_t virtual_address = 0;
  std::uint32_t memory_size = 0;  ///< in bytes; the bytes after `data` are zero
  std::vector<std::uint8_t> data;
};

struct ElfSymbol {
  std::string name;  ///< as the linker knows it
  std::uint32_t address = 0;  ///< without the Thumb bit
  std::uint32_t size = 0;     ///< 0: unknown
  bool function = false;      ///< declared as a function, or a label in code
  bool thumb = false;         ///< a function in Thumb state, as far as its declaration tells
  /// For people: demangled, as in `A::step(int)`. What differs by its mangled name alone, such as the two
  /// destructors of a class, has that name behind it in brackets.
  std::string shown = {};
  /// The source file, if symbols of other addresses have the same `shown`; otherwise empty.
  std::string file = {};

  /// "A::step(int)", "helper (a.c)": no two symbols of a program at different addresses have the same text.
  std::string text() const { return file.empty() ? shown : shown + " (" + file + ")"; }
};

/// The name in the source for a mangled one, `foo(int) [clone .part.0]` for a piece; any other name as it is.
std::string demangled(const std::string& name);

/// A named part of the program that occupies memory at run time.
struct ElfSection {
  std::string name;
  std::uint32_t address = 0, size = 0;
};

/// A checked ELF32 executable for little-endian ARM.
class ElfImage {
 public:
  /// @throws UserError of one line: missing, not an ELF file, wrong class, byte order, machine or
  /// type, code for another architecture than ARMv5TEJ, truncated, no segments, overlapping
  /// segments, an entry point outside them or of the other instruction set
  static ElfImage load(const std::filesystem::path& file);

  const std::string& file() const { return file_; }
  /// Address of the first instruction; bit 0 selects the Thumb state.
  std::uint32_t entry() const { return entry_; }
  const std::vector<ElfSegment>& segments() const { return segments_; }
  /// In the order of the file.
  const std::vector<ElfSection>& sections() const { return sections_; }
  /// All named symbols, sorted by address.
  const std::vector<ElfSymbol>& symbols() const { return symbols_; }

  /// The symbol called `name` by the linker or by ElfSymbol::text(), or nullptr.
  const ElfSymbol* find(std::string_view name) const;
  /// The function that contains an address; nullptr if the nearest one below ends before it.
  const ElfSymbol* function_at(std::uint32_t address) const;
  /// "name+0x12", "name", or "" if the address is in no function.
  std::string describe(std::uint32_t address) const;

 private:
  std::string file_;
  std::uint32_t entry_ = 0;
  std::vector<ElfSegment> segments_;
  std::vector<ElfSection> sections_;
  std::vector<ElfSymbol> symbols_;
  std::vector<std::size_t> functions_;  // indices into symbols_, sorted by address
};

/// A memory to which a program may be loaded.
struct MemoryRegion {
  std::string name;
  std::uint64_t base = 0, size = 0;  ///< bytes
};

/// @throws UserError if a segment does not lie completely in one region; names the segment and what
/// is allowed
void check_fits(const ElfImage& image, std::span<const MemoryRegion> regions);

}  // namespace fovea::app
