// The progress line, and the speed of the simulation in its steady state.
#pragma once
#include <chrono>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/machine/machine.h"

namespace fovea::app {

/// Prints the progress: on a terminal one line that is updated a few times per second, otherwise a
/// line about every ten seconds. Wall-clock time is read only here and affects only host.json.
class ProgressMeter : public ProgressSink {
 public:
  using Clock = std::chrono::steady_clock;
  using Now = std::function<Clock::time_point()>;  ///< replaced by tests
  ProgressMeter(std::ostream& out, bool terminal, Now now = Clock::now);
  void update(const Progress& progress) override;
  /// Ends the line on a terminal.
  void finish();

  /// Adds `wall_time`, `peak_rss` and, measured from the first displayed frame on (steady state),
  /// `realtime_factor` and `mips`. Values that `rows` already contains are not changed.
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
