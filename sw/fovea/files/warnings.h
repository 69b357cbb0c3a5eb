// Warnings of one command: what they are called, on the error stream and in stats.json.
#pragma once
#include <ostream>
#include <string>
#include <string_view>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"

namespace fovea::app {

/// Whom a warning concerns: the program on the core, the model, or the parameters. In a replay,
/// where no program runs, the registers' contents are parameters too.
inline std::string_view warning_kind(Diagnostics::Kind kind, bool replay = false) {
  switch (kind) {
    case Diagnostics::Kind::kGuest:
      return replay ? "configuration" : "firmware";
    case Diagnostics::Kind::kNotModelled:
      return "model";
    case Diagnostics::Kind::kConfiguration:
      break;
  }
  return "configuration";
}

/// The sentence, complete in itself.
inline std::string warning_text(Diagnostics::Kind kind, const std::string& what) {
  return (kind == Diagnostics::Kind::kNotModelled ? "not modelled: " : "") + what;
}

/// The warnings of one command: counts them and shows each once. As long as it lives, its Diagnostics are the
/// current ones of the thread.
class WarningScope {
 public:
  WarningScope(std::ostream& err, bool strict, bool replay = false) {
    diagnostics_.set_strict(strict);
    diagnostics_.set_sink([&err, replay](Diagnostics::Kind kind, const std::string& what) {
      err << "fovea: warning (" << warning_kind(kind, replay)
          << "): " << one_line(warning_text(kind, what)) << "\n";
    });
  }
  WarningScope(const WarningScope&) = delete;
  WarningScope& operator=(const WarningScope&) = delete;

 private:
  Diagnostics diagnostics_;
  DiagnosticsScope scope_{diagnostics_};
};

}  // namespace fovea::app
