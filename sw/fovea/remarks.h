// Remarks about the guest during one command.
#pragma once
#include <ostream>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"

namespace fovea::app {

/// Counts remarks about the guest for one run and shows each once.
class RemarkScope {
 public:
  RemarkScope(std::ostream& err, bool strict) {
    auto& d = Diagnostics::instance();
    d.clear();
    d.set_strict(strict);
    d.set_sink([&err](Diagnostics::Kind kind, const std::string& what) {
      err << "fovea: " << (kind == Diagnostics::Kind::kGuest ? "guest: " : "not modelled: ")
          << one_line(what) << "\n";
    });
  }
  ~RemarkScope() {
    Diagnostics::instance().set_sink({});
    Diagnostics::instance().set_strict(false);
  }
  RemarkScope(const RemarkScope&) = delete;
  RemarkScope& operator=(const RemarkScope&) = delete;
};

}  // namespace fovea::app
