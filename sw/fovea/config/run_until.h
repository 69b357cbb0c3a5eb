// `run.until`: the conditions that end a run.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/units.h"
#include "sw/fovea/program/symbols.h"

namespace fovea::app {

/// A condition. A run ends when the first one is met.
struct EndCondition {
  enum class Kind : std::uint8_t {
    kFrames,  ///< the measurement window of run.frames frames has ended
    kTime,    ///< this simulated time since power-up is reached
    kPc,      ///< the core is about to execute the instruction at this address
    kUart,    ///< UART0 has sent this text
    kExit,    ///< the program ends by a semihosting call
    kHalt,    ///< nothing can make the core continue
    kReset    ///< the chip is reset
  };
  Kind kind = Kind::kFrames;
  std::string written;       ///< as the user wrote it
  Picoseconds time = 0;      ///< kTime
  std::uint32_t address = 0; ///< virtual, without the Thumb bit
  std::string text = {};     ///< after replacing escapes
};

inline constexpr std::string_view kEndConditionsAllowed =
    "frames, time:2s, pc:main, pc:0x80008000, uart:TEXT, exit, halt, reset, or a list of them: "
    "[uart:login, time:20s]";

/// Parses one condition, or a list in brackets with commas between its items; an item with a comma
/// must be in double quotes. TEXT may contain the escapes \n, \r, \t, \", \\ and \xHH. @throws
/// UserError that says what is allowed
std::vector<EndCondition> parse_run_until(const std::string& text, const Symbols& symbols);

/// Refuses what parse_run_until() would refuse whatever the program's symbols are, before a program is read.
/// @throws UserError
void check_run_until(const std::string& text);

/// Parses a duration with its unit, for example of `--max-time`. @throws UserError
Picoseconds parse_time(const std::string& what, const std::string& text);

/// Replaces the escapes listed above. @throws UserError
std::string unescape(const std::string& what, std::string_view text);
/// The reverse: a single line with escapes.
std::string escape(std::string_view text);

}  // namespace fovea::app
