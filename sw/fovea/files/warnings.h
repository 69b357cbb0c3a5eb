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

/// Counts the warnings of one command and shows each once.
class WarningScope {
 public:
  WarningScope(std::ostream& err, bool strict, bool replay = false) {
    auto& d = Diagnostics::instance();
    d.clear();
    d.set_strict(strict);
    d.set_sink([&err, replay](Diagnostics::Kind kind, const std::string& what) {
      err << "fovea: warning (" << warning_kind(kind, replay)
          << "): " << one_line(warning_text(kind, what)) << "\n";
    });
  }
  ~WarningScope() {
    Diagnostics::instance().set_sink({});
    Diagnostics::instance().set_strict(false);
  }
  WarningScope(const WarningScope&) = delete;
  WarningScope& operator=(const WarningScope&) = delete;
};

}  // namespace fovea::app
