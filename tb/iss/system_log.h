// The log of a program of system/ (harness.S has its format), how it comes from QEMU, and how two
// logs are compared.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace fovea::cpu::test {

struct LogEntry {
  bool dump = false;                 ///< a dump of all banks, else a record of an exception
  std::vector<std::uint32_t> words;  ///< without a dump's tag
  std::uint32_t kind() const { return dump ? 0 : words[0] & 15u; }
  std::uint32_t swi() const { return words[0] >> 8; }
};
/// Entries from one SWI 0x90 to the next.
struct LogCase {
  std::string name;
  std::vector<LogEntry> entries;
};

/// @param memory a byte of the memory that the program left, where the names are
/// @throws std::runtime_error if it is no log
std::vector<LogCase> parse_log(const std::string& bytes,
                               const std::function<std::uint8_t(std::uint32_t)>& memory);

/// Name of a word of an entry: "lr", "spsr", "irq r13".
std::string field_name(const LogEntry& e, unsigned word);

struct Difference {
  std::string where;  ///< case
  std::size_t entry;  ///< its number in the case
  std::string field;  ///< or "entries" when their number or kinds differ
  std::uint32_t core, qemu;
  LogEntry context;  ///< as the core left it
  std::string text() const;
};

/// Words that the architecture leaves open: true leaves one out.
using Open = std::function<bool(const LogEntry&, const std::string& field)>;
/// Everything in which two logs differ. Bits 26:8 of a status register are reserved in ARMv5 and
/// left out: QEMU keeps its A bit there.
std::vector<Difference> compare_logs(const std::vector<LogCase>& core,
                                     const std::vector<LogCase>& qemu, const Open& open = {});

/// Runs an executable, with more memory content at `address` if given.
std::string by_qemu_system(const std::string& elf, const std::vector<std::uint8_t>& content = {},
                           std::uint32_t address = 0);

}  // namespace fovea::cpu::test
