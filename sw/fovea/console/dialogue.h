// `uart0.input`: a prepared, repeatable input for the serial console.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/common/units.h"

namespace fovea::app {

/// A file of steps, one per line, executed in order; lines that begin with `#` are comments:
///   wait TEXT   until UART0 has sent TEXT since the previous step
///   send TEXT   types TEXT
///   at TIME     until this simulated time since power-up, with a unit
/// TEXT extends to the end of the line and may contain the escapes \n, \r, \t, \", \\ and \xHH.
/// "\n" is the Enter key for most programs.
class Dialogue {
 public:
  /// @throws UserError that names file and line
  static Dialogue load(const std::filesystem::path& file);
  static Dialogue parse(const std::string& name, const std::string& text);

  /// To be called for each byte that UART0 sends.
  void received(std::uint8_t byte);
  /// The next byte to type, if it is due.
  std::optional<std::uint8_t> next(Picoseconds now);
  /// The time of the current step, if that is `at`.
  std::optional<Picoseconds> waits_until() const;
  /// True once everything was typed.
  bool over() const { return at_ >= steps_.size(); }
  /// The current step as "FILE:LINE: wait login", for a run that ended before the dialogue did.
  std::string position() const;

 private:
  struct Step {
    enum class Kind : std::uint8_t { kWait, kSend, kAt } kind = Kind::kSend;
    std::string text;
    Picoseconds time = 0;
    unsigned line = 0;
    std::string written;
  };
  void next_step();

  std::string name_;
  std::vector<Step> steps_;
  std::size_t at_ = 0, sent_ = 0;
  std::string received_;  // received since the current step began; at most as long as its text
};

/// A typed byte, as two lines of such a file.
std::string dialogue_lines(Picoseconds at, const std::string& typed);

}  // namespace fovea::app
