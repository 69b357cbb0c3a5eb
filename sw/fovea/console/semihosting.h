// ARM semihosting 1.x as newlib's rdimon uses it: `SVC 0x123456` (ARM), `SVC 0xAB` (Thumb).
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/check.h"
#include "model/common/units.h"
#include "sw/fovea/console/guest_files.h"

namespace fovea::app {

/// The machine whose program makes the calls.
class SemihostingTarget {
 public:
  virtual ~SemihostingTarget() = default;
  virtual std::uint32_t r(unsigned number) const = 0;
  virtual void set_r0(std::uint32_t value) = 0;
  /// Memory as the program sees it. Return false if an address is not mapped.
  virtual bool read(std::uint32_t address, std::span<std::uint8_t> to) = 0;
  virtual bool write(std::uint32_t address, std::span<const std::uint8_t> from) = 0;
  virtual Picoseconds now() const = 0;
};

/// The three streams that are opened as ":tt".
class SemihostingConsole {
 public:
  virtual ~SemihostingConsole() = default;
  /// Waits for at least one byte. @return the number of bytes; 0 at the end of input or if `go_on`
  /// returns false
  virtual std::size_t read(std::span<std::uint8_t> to) = 0;
  /// Called now and then while read() waits; returns false to end the wait. May be empty.
  std::function<bool()> go_on;
  /// True if output was lost, so that the run should end.
  virtual bool lost() const { return false; }
  /// @return false if the output could not be written
  virtual bool write(bool error_stream, std::string_view text) = 0;
};

struct SemihostingSettings {
  std::filesystem::path root;  ///< folder of the program's files; empty: no files
  std::string command_line;
  std::uint32_t heap_base = 0, heap_limit = 0, stack_base = 0, stack_limit = 0;
};

/// Semihosting calls of one program. Time is simulated: SYS_CLOCK and SYS_ELAPSED count from the
/// start, and SYS_TIME is 1970-01-01 at the start. The console always claims to be a terminal, so
/// that the same program makes the same calls wherever its output goes. SYS_SYSTEM is refused.
/// Warns the Diagnostics that were current when it was constructed.
class Semihosting {
 public:
  Semihosting(const SemihostingSettings& settings, SemihostingConsole& console);
  ~Semihosting();
  Semihosting(const Semihosting&) = delete;
  Semihosting& operator=(const Semihosting&) = delete;

  /// True if this SWI number is a semihosting call in that state.
  static bool is_call(std::uint32_t number, bool thumb) {
    return number == (thumb ? 0xABu : 0x123456u);
  }
  /// Executes operation r0 with parameter r1 and stores the result in r0.
  void call(SemihostingTarget& target);
  /// Set once the program has ended.
  std::optional<int> exit_code() const { return exit_code_; }

 private:
  using Arguments = std::array<std::uint32_t, 4>;
  struct File {
    enum class Kind { kFree, kInput, kOutput, kError, kHost, kFeatures } kind = Kind::kFree;
    int fd = -1;             // kHost
    std::uint32_t at = 0;    // kFeatures
  };
  bool refused_ = false;  ///< a refused file was already reported
  std::uint32_t operate(SemihostingTarget& t, std::uint32_t operation, std::uint32_t parameter);
  static unsigned words_of(std::uint32_t operation);
  std::uint32_t write_character(SemihostingTarget& t, std::uint32_t address);
  std::uint32_t is_terminal(std::uint32_t handle);
  std::uint32_t remove(SemihostingTarget& t, const Arguments& a);
  std::uint32_t rename(SemihostingTarget& t, const Arguments& a);
  std::uint32_t elapsed(SemihostingTarget& t, std::uint32_t address);
  std::uint32_t open(SemihostingTarget& t, const Arguments& a);
  std::uint32_t close(std::uint32_t handle);
  std::uint32_t write(SemihostingTarget& t, const Arguments& a);
  std::uint32_t read(SemihostingTarget& t, const Arguments& a);
  std::uint32_t seek(const Arguments& a);
  std::uint32_t length(std::uint32_t handle);
  std::uint32_t temporary_name(SemihostingTarget& t, const Arguments& a);
  std::uint32_t command_line(SemihostingTarget& t, std::uint32_t block, const Arguments& a);
  std::uint32_t heap_info(SemihostingTarget& t, std::uint32_t parameter);
  std::uint32_t write_text(SemihostingTarget& t, std::uint32_t address);
  /// Result of a write or read on the host: the number of bytes, or -errno.
  std::int64_t put(File& f, std::span<const std::uint8_t> bytes);
  std::int64_t get(File& f, std::span<std::uint8_t> bytes);
  bool arguments(SemihostingTarget& t, std::uint32_t block, unsigned count, Arguments& a);
  bool text(SemihostingTarget& t, std::uint32_t address, std::uint32_t bytes, std::string& out);
  File* file(std::uint32_t handle);
  std::uint32_t failed(int error);

  SemihostingSettings settings_;
  SemihostingConsole& console_;
  GuestFiles files_;
  DiagnosticsRef diagnostics_ = DiagnosticsRef::current();
  std::vector<File> open_;  // handle n is element n - 1
  int errno_ = 0;
  std::optional<int> exit_code_;
};

/// The command line that newlib's start-up code splits into `arguments`: arguments with blanks are
/// quoted. @throws UserError for an argument that cannot be expressed
std::string guest_command_line(std::span<const std::string> arguments);

}  // namespace fovea::app
