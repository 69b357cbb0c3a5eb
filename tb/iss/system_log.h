// The log of a program of system/ (format: harness.S), how to get it from QEMU, and the comparison
// of two logs.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace fovea::cpu::test {

struct LogEntry {
  bool dump = false;                 ///< a dump of all banks; otherwise a record of an exception
  std::vector<std::uint32_t> words;  ///< without the tag of a dump
  std::uint32_t kind() const { return dump ? 0 : words[0] & 15u; }
  std::uint32_t swi() const { return words[0] >> 8; }
};
/// The entries from one SWI 0x90 to the next.
struct LogCase {
  std::string name;
  std::vector<LogEntry> entries;
};

/// @param memory a byte of the memory that the program left, which contains the names
/// @throws std::runtime_error if it is not a log
std::vector<LogCase> parse_log(const std::string& bytes,
                               const std::function<std::uint8_t(std::uint32_t)>& memory);

/// The name of a word of an entry: "lr", "spsr", "irq r13".
std::string field_name(const LogEntry& e, unsigned word);

struct Difference {
  std::string where;  ///< the case
  std::size_t entry;  ///< number in the case
  std::string field;  ///< "entries" if their number or kinds differ
  std::uint32_t core, qemu;
  LogEntry context;  ///< as produced by the core
  std::string text() const;
};

/// Words that the architecture does not define: returns true to ignore one.
using Open = std::function<bool(const LogEntry&, const std::string& field)>;
/// All differences between two logs. Bits 26:8 of a status register are reserved in ARMv5 and
/// ignored: QEMU keeps its A bit there.
std::vector<Difference> compare_logs(const std::vector<LogCase>& core,
                                     const std::vector<LogCase>& qemu, const Open& open = {});

/// Runs an executable, with additional memory contents at `address` if given.
std::string by_qemu_system(const std::string& elf, const std::vector<std::uint8_t>& content = {},
                           std::uint32_t address = 0);

}  // namespace fovea::cpu::test
