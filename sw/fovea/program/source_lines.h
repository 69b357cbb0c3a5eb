// Functions and source lines of a program's addresses, from its DWARF debug information.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "sw/fovea/program/elf_image.h"

namespace fovea::app {

/// A function that an address belongs to, and the line in it: of the instruction, or of the call that
/// was inlined.
struct SourceFrame {
  /// As in `A::step(int)`; of C the plain name. Together with the file it tells functions apart.
  std::string function;
  std::string file;   ///< "" if unknown
  unsigned line = 0;  ///< 0 if unknown
  bool operator==(const SourceFrame&) const = default;
};

/// Looks addresses up in one or more programs, in their order. A program without debug information, or
/// a function without, is described by the symbols alone. Files are named relative to the folder that
/// all sources of a program lie in, so that the names do not depend on where it was built.
class SourceLines {
 public:
  SourceLines();
  ~SourceLines();
  SourceLines(const SourceLines&) = delete;
  SourceLines& operator=(const SourceLines&) = delete;
  /// @param image must live as long as this. @throws UserError if its file can no longer be read
  void add(const ElfImage& image);
  /// The functions at an address: the innermost inlined one first, the function itself last. One frame
  /// called "(unknown)" if no program has a function there.
  const std::vector<SourceFrame>& at(std::uint32_t address);
  /// The function itself in one text: "helper (a.c)" if the program has another one of that name.
  std::string function_text(std::uint32_t address);
  /// Beginning of the function itself, or the address if it is unknown.
  std::uint32_t function_start(std::uint32_t address) const;
  /// The function itself and its program; null if it is unknown.
  std::pair<const ElfImage*, const ElfSymbol*> function_at(std::uint32_t address) const;
  /// Whether any program has debug information.
  bool have_lines() const;

 private:
  struct Program;
  std::vector<std::unique_ptr<Program>> programs_;
  std::unordered_map<std::uint32_t, std::vector<SourceFrame>> known_;
};

}  // namespace fovea::app
