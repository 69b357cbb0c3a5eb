// The target program: an ELF file checked and taken apart for loading, and its symbols.
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
  unsigned index = 0;         ///< program header number
  std::uint32_t address = 0;  ///< where it is loaded (p_paddr)
  std::uint32_t virtual_address = 0;
  std::uint32_t memory_size = 0;  ///< bytes; those behind `data` are zero
  std::vector<std::uint8_t> data;
};

struct ElfSymbol {
  std::string name;
  std::uint32_t address = 0;  ///< without the Thumb bit
  std::uint32_t size = 0;     ///< 0: unknown
  bool function = false;      ///< declared as function, or a label in code
};

/// A named part of the program that takes memory when it runs.
struct ElfSection {
  std::string name;
  std::uint32_t address = 0, size = 0;
};

/// A checked ELF32 little-endian ARM executable.
class ElfImage {
 public:
  /// @throws UserError of one line: missing, not an ELF, other class, byte order, machine or type,
  ///   code for another architecture than ARMv5TEJ, cut short, no segments, overlapping segments
  static ElfImage load(const std::filesystem::path& file);

  const std::string& file() const { return file_; }
  /// First instruction; bit 0 set means Thumb.
  std::uint32_t entry() const { return entry_; }
  const std::vector<ElfSegment>& segments() const { return segments_; }
  /// In the file's order.
  const std::vector<ElfSection>& sections() const { return sections_; }
  /// All named symbols, sorted by address.
  const std::vector<ElfSymbol>& symbols() const { return symbols_; }

  /// The symbol called `name`; nullptr if there is none.
  const ElfSymbol* find(std::string_view name) const;
  /// The function around an address; nullptr if the nearest one below ends before it.
  const ElfSymbol* function_at(std::uint32_t address) const;
  /// "name+0x12", "name", or "" if no function is there.
  std::string describe(std::uint32_t address) const;

 private:
  std::string file_;
  std::uint32_t entry_ = 0;
  std::vector<ElfSegment> segments_;
  std::vector<ElfSection> sections_;
  std::vector<ElfSymbol> symbols_;
  std::vector<std::size_t> functions_;  // indices of symbols_, sorted by address
};

/// Memory that a program may be loaded to.
struct MemoryRegion {
  std::string name;
  std::uint64_t base = 0, size = 0;  ///< bytes
};

/// @throws UserError if a segment is not wholly inside one region; names the segment and what is
///   allowed
void check_fits(const ElfImage& image, std::span<const MemoryRegion> regions);

}  // namespace fovea::app
