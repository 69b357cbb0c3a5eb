// A program for `fovea exec`: its bytes, its entry, and the memory map that it gets.
#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sw/fovea/program/elf_image.h"

namespace fovea::app {

/// The memory map for one program (model/decisions/0007-exec-memory.md).
struct ExecMap {
  std::uint32_t ram_base = 0;
  std::uint64_t ram_size = 0;
  bool tcm = false;  ///< the chip's internal RAM is at 0x0 and 0x10000
  /// The largest part of RAM that the program leaves free: the heap grows from its start, the stack
  /// from its end.
  std::uint32_t free_base = 0, free_end = 0;
  /// Address of kTableBytes of RAM for a translation table and the preamble that enables MMU and
  /// caches; 0: none.
  std::uint32_t table = 0;
  static constexpr std::uint32_t kTableBytes = 0x8000;
  std::uint32_t heap_limit() const { return free_end - stack_bytes(); }
  std::uint32_t stack_bytes() const { return std::min((free_end - free_base) / 4, 8u << 20); }
};

class ExecProgram {
 public:
  /// @throws UserError if it is not a program for this core
  static ExecProgram elf(const std::filesystem::path& file);
  /// @param entry bit 0 selects the Thumb state. @throws UserError if the file is missing, empty or
  /// does not fit into 4 GiB
  static ExecProgram flat(const std::filesystem::path& file, std::uint32_t load,
                          std::uint32_t entry);

  const std::string& name() const { return name_; }  ///< argv[0]: the file's name without its
                                                     ///< folder
  std::uint32_t entry() const { return entry_; }
  const std::vector<ElfSegment>& segments() const { return segments_; }
  /// Null for a flat binary.
  const ElfImage* image() const { return image_ ? &*image_ : nullptr; }
  /// "name+0x12" if the program has symbols, otherwise "".
  std::string describe(std::uint32_t address) const {
    return image_ ? image_->describe(address) : "";
  }
  /// @param ram_base start of RAM; empty: the highest multiple of its size below the lowest segment
  /// @throws UserError if the segments do not fit into one map
  ExecMap map(std::uint64_t ram_size, std::optional<std::uint32_t> ram_base = {},
              bool caches = false) const;

 private:
  std::uint32_t window_base(std::uint64_t ram_size) const;
  void check_inside(const ExecMap& map) const;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> used_in(const ExecMap& map) const;

  std::string name_;
  std::uint32_t entry_ = 0;
  std::vector<ElfSegment> segments_;
  std::optional<ElfImage> image_;
};

/// Parses `exec.ram_base`; "auto" gives an empty result. @throws UserError
std::optional<std::uint32_t> parse_ram_base(const std::string& text, std::uint64_t ram_size);

/// Parses "0x8000" or "32768". @throws UserError that names the option
std::uint32_t parse_address(const std::string& option, const std::string& text);

}  // namespace fovea::app
