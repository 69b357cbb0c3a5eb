// `run.until`: what ends a run, as it is written.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/common/units.h"
#include "sw/fovea/symbols.h"

namespace fovea::app {

/// One condition. A run ends with the first that is met.
struct EndCondition {
  enum class Kind : std::uint8_t {
    kFrames,  ///< the measured window of run.frames frames is over
    kTime,    ///< this much simulated time since power-up
    kPc,      ///< the core is about to execute the instruction at this address
    kUart,    ///< UART0 has sent this text
    kExit,    ///< the program ends by semihosting
    kHalt,    ///< nothing can make the core go on
    kReset    ///< the chip is reset
  };
  Kind kind = Kind::kFrames;
  std::string written;       ///< as the user wrote it
  Picoseconds time = 0;      ///< kTime
  std::uint32_t address = 0; ///< kPc: virtual, without the Thumb bit
  std::string text = {};     ///< kUart: without escapes
};

inline constexpr std::string_view kEndConditionsAllowed =
    "frames, time:2s, pc:main, pc:0x80008000, uart:TEXT, exit, halt, reset, or a list of them: "
    "[uart:login, time:20s]";

/// One condition or a list in brackets, its items apart by commas; an item with a comma stands in
/// double quotes. TEXT knows \n, \r, \t, \", \\ and \xHH.
/// @throws UserError that says what is allowed
std::vector<EndCondition> parse_run_until(const std::string& text, const Symbols& symbols);

/// A duration with its unit, for `--max-time` and the like. @throws UserError
Picoseconds parse_time(const std::string& what, const std::string& text);

/// Text with escapes as above made plain. @throws UserError
std::string unescape(const std::string& what, std::string_view text);
/// The reverse, on one line.
std::string escape(std::string_view text);

}  // namespace fovea::app
