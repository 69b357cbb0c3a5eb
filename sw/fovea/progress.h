// The progress line, and the speed of the simulation in steady state.
#pragma once
#include <chrono>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/simulation.h"

namespace fovea::app {

/// Prints progress: on a terminal one line that is rewritten a few times a second, elsewhere a line
/// about every ten seconds. Wall-clock time is read here only and reaches host.json alone.
class ProgressMeter : public ProgressSink {
 public:
  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;  ///< replaceable for tests
  ProgressMeter(std::ostream& out, bool terminal, Now now = Clock::now);
  void update(const Progress& progress) override;
  /// Ends the line on a terminal.
  void finish();

  /// `wall_time`, `peak_rss`, and, from the first displayed frame on (the steady state),
  /// `realtime_factor` and `mips`. Figures that `rows` already has are left as they are.
  void add_host_rows(std::vector<StatRow>& rows) const;

 private:
  struct Sample {
    Progress progress;
    Clock::time_point wall;
  };
  std::string line(const Sample& now) const;
  std::ostream& out_;
  bool terminal_;
  Now now_;
  Sample begin_, last_, last_printed_;
  std::optional<Sample> steady_;
  bool line_open_ = false;
};

}  // namespace fovea::app
