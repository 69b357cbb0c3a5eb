// Assembles text into words with the cross assembler of the build.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace fovea::cpu::test {

struct Program {
  std::vector<std::uint8_t> bytes;
  std::map<std::string, std::uint32_t> symbols;
  std::uint32_t base = 0;
};

/// A temporary folder below TMPDIR, removed at the end.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  /// The name of a file in it as a word of a shell command; TMPDIR may contain spaces.
  std::string quoted(const std::string& name) const {
    return "'" + (path_ / name).string() + "'";
  }

 private:
  std::filesystem::path path_;
};

/// Assembles for ARMv5TE at `base`. @throws std::runtime_error with the assembler's message
Program assemble(const std::string& text, std::uint32_t base);
/// Runs a command and returns its output. @throws std::runtime_error unless it exits with 0
std::string output_of(const std::string& command);
/// The bytes of a file. @throws std::runtime_error
std::vector<std::uint8_t> read_file(const std::string& path);

}  // namespace fovea::cpu::test
