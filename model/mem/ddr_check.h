// The checkers of model/mem/check beside a controller: what was programmed against the part's data
// sheet, always; the command bus as programmed and against the data sheet, by `ddr.check`.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "model/common/check.h"
#include "model/mem/core/ddr_controller.h"

namespace fovea::mem {

class DdrCheck {
 public:
  /// @throws UserError for a grade that the part does not come in
  DdrCheck(const DdrParams& params, DdrController& controller, const DiagnosticsRef& diagnostics);
  ~DdrCheck();
  DdrCheck(const DdrCheck&) = delete;

  /// The commands from `at` on are held against these numbers; what reaches the controller itself
  /// needs no call.
  void expect(const DdrConfig& config, Frequency clock, Picoseconds at);
  /// A warning about each value that the part's data sheet does not allow.
  void warn(const DdrConfig& config, Frequency clock) const;
  /// The part holds nothing until begin(): a chip in reset leaves it without refresh.
  void restart();
  /// The part is used, from its next ACT on.
  void begin();
  /// The same lines, without counting them.
  std::vector<std::string> violations(const DdrConfig& config, Frequency clock) const;

 private:
  struct Stream;
  struct Sheet;
  DiagnosticsRef diagnostics_;
  std::unique_ptr<Sheet> sheet_;
  std::unique_ptr<Stream> stream_;  // with ddr.check = commands
};

}  // namespace fovea::mem
