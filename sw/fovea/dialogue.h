// `uart0.input`: what is typed on the serial console, and when, so that it can be repeated.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/common/units.h"

namespace fovea::app {

/// A file of steps, one a line, taken in order; `#` begins a comment line:
///   wait TEXT   until UART0 has sent TEXT (since the step before)
///   send TEXT   types it
///   at TIME     until this much simulated time since power-up, with its unit
/// TEXT runs to the end of the line and knows \n, \r, \t, \", \\ and \xHH; "\n" is the Enter key of
/// most programs' line discipline.
class Dialogue {
 public:
  /// @throws UserError naming file and line
  static Dialogue load(const std::filesystem::path& file);
  static Dialogue parse(const std::string& name, const std::string& text);

  /// UART0 has sent this byte.
  void heard(std::uint8_t byte);
  /// The next byte to type, if it is time for one.
  std::optional<std::uint8_t> next(Picoseconds now);
  /// When the present step is `at`: its time.
  std::optional<Picoseconds> waits_until() const;
  /// All is typed.
  bool over() const { return at_ >= steps_.size(); }
  /// The step that it is at, as "FILE:LINE: wait login"; for a run that ended before it was over.
  std::string position() const;

 private:
  struct Step {
    enum class Kind : std::uint8_t { kWait, kSend, kAt } kind = Kind::kSend;
    std::string text;
    Picoseconds time = 0;
    unsigned line = 0;
    std::string written;
  };
  void step_on();

  std::string name_;
  std::vector<Step> steps_;
  std::size_t at_ = 0, sent_ = 0;
  std::string heard_;  // since the present step began, not longer than its text
};

/// One typed byte as a line pair of such a file.
std::string dialogue_lines(Picoseconds at, const std::string& typed);

}  // namespace fovea::app
