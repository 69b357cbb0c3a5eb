// What a folder of results is about: an experiment, a program of `fovea exec` or a replayed trace.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace fovea::regression {

enum class ResultKind { kRun, kExec, kReplay };

/// Two results with equal subjects may be held against each other.
struct Subject {
  ResultKind kind = ResultKind::kRun;
  std::string name;                         ///< of the experiment, the program's or the trace's file
  std::vector<std::string> arguments = {};  ///< of a program
  std::vector<std::string> options = {};    ///< words of the command line that decide the result

  bool operator==(const Subject&) const = default;
  /// "experiment 'default'", "program 'app.elf 10' with --board", "trace 'pal.trace'".
  std::string text() const;
  /// A name for tables and curves: "default", "app.elf 10 --board".
  std::string label() const;
};

/// The key that names a subject in config.json and in a baseline: "experiment", "program", "trace".
std::string_view subject_key(ResultKind kind);
/// The command that leaves such results: "run", "exec", "replay".
std::string_view command_of(ResultKind kind);

}  // namespace fovea::regression
