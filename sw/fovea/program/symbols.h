// Names for a program's addresses, from one or two ELF files.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "sw/fovea/program/elf_image.h"

namespace fovea::app {

/// Searches the program's own symbols first, then those of `--symbols`. The images are not owned;
/// null: none.
class Symbols {
 public:
  explicit Symbols(const ElfImage* program = nullptr, const ElfImage* more = nullptr)
      : images_{program, more} {}

  /// "name+0x12", or "" if no image has a symbol there.
  std::string describe(std::uint32_t address) const {
    for (const ElfImage* image : images_) {
      if (!image) continue;
      if (std::string name = image->describe(address); !name.empty()) return name;
    }
    return "";
  }
  /// "0x8000 (main+0x12)", or only the number.
  std::string place(std::uint32_t address) const;
  std::optional<std::uint32_t> find(std::string_view name) const {
    for (const ElfImage* image : images_)
      if (const ElfSymbol* s = image ? image->find(name) : nullptr) return s->address;
    return std::nullopt;
  }

 private:
  const ElfImage* images_[2];
};

}  // namespace fovea::app
