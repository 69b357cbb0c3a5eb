// A foreign program: its bytes, its entry, and the memory map it is given.
#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/elf_image.h"

namespace fovea::app {

/// Where memory lies for one program (model/decisions/0007-exec-memory.md).
struct ExecMap {
  std::uint32_t ram_base = 0;
  std::uint64_t ram_size = 0;
  bool tcm = false;  ///< the chip's internal RAM lies at 0x0 and 0x10000
  /// The largest piece of RAM that the program leaves free: heap from below, stack from the top.
  std::uint32_t free_base = 0, free_end = 0;
  /// Where a translation table and the preamble that turns MMU and caches on lie: kTableBytes of
  /// RAM. 0: none asked for.
  std::uint32_t table = 0;
  static constexpr std::uint32_t kTableBytes = 0x8000;
  std::uint32_t heap_limit() const { return free_end - stack_bytes(); }
  std::uint32_t stack_bytes() const { return std::min((free_end - free_base) / 4, 8u << 20); }
};

class ExecProgram {
 public:
  /// @throws UserError: not a program for this core
  static ExecProgram elf(const std::filesystem::path& file);
  /// @param entry bit 0 set means Thumb. @throws UserError: no file, empty, beyond 4 GiB
  static ExecProgram flat(const std::filesystem::path& file, std::uint32_t load,
                          std::uint32_t entry);

  const std::string& name() const { return name_; }  ///< argv[0]: without the folder
  std::uint32_t entry() const { return entry_; }
  const std::vector<ElfSegment>& segments() const { return segments_; }
  /// Null for a flat binary.
  const ElfImage* image() const { return image_ ? &*image_ : nullptr; }
  /// "name+0x12" if symbols are known, else "".
  std::string describe(std::uint32_t address) const {
    return image_ ? image_->describe(address) : "";
  }
  /// @param ram_base where RAM begins; empty: the multiple of its size below the lowest segment.
  /// @throws UserError if the segments do not fit into one map
  ExecMap map(std::uint64_t ram_size, std::optional<std::uint32_t> ram_base = {},
              bool caches = false) const;

 private:
  std::string name_;
  std::uint32_t entry_ = 0;
  std::vector<ElfSegment> segments_;
  std::optional<ElfImage> image_;
};

/// The text of `exec.ram_base`: "auto" is empty. @throws UserError
std::optional<std::uint32_t> parse_ram_base(const std::string& text, std::uint64_t ram_size);

/// "0x8000" or "32768". @throws UserError naming the option
std::uint32_t parse_address(const std::string& option, const std::string& text);

}  // namespace fovea::app
