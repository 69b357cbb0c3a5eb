// One call of `fovea limits`: the experiment, its settings, and the runner of its points.
#pragma once
#include <string>
#include <vector>

#include "sw/fovea/limits/bisection.h"
#include "sw/fovea/limits/judge.h"
#include "sw/fovea/machine/command.h"
#include "sw/fovea/machine/effective.h"
#include "sw/fovea/points/runner.h"

namespace fovea::limits {

using Settings = std::vector<std::string>;

class Session {
 public:
  using Done = points::Runner::Done;
  Session(const app::CliContext& context, std::string experiment, points::Runner& runner,
          std::vector<Condition> conditions, unsigned probes)
      : context_(context), experiment_(std::move(experiment)), runner_(runner),
        conditions_(std::move(conditions)), probes_(probes) {}

  /// The parameters with these settings. @throws UserError
  std::unique_ptr<app::EffectiveRun> effective(const Settings& settings) const {
    return app::effective_run(context_.make_machine, experiment_, settings);
  }
  /// Runs the experiment with `settings` and, after them, `more`, which is what the progress line
  /// shows unless there is a `label`. @throws UserError for settings that are not allowed
  void run(const Settings& settings, const Settings& more, Done done, Settings options = {},
           std::string label = {});
  /// Runs as run() does and judges the result. A frame that was shown again once may be the slip of a loop that
  /// keeps up from then on: the run with a longer window tells, and is the result.
  using Judged = std::function<void(const points::PointResult&, const Verdict&)>;
  void judged_run(const Settings& settings, const Settings& more, Judged done, std::string label = {});
  /// Replays the trace that a run with the options record() has left.
  void replay(const points::PointResult& recorded, const Settings& settings, Done done,
              Settings options = {});
  static const Settings& record();

  points::Runner& runner() { return runner_; }
  const std::vector<Condition>& conditions() const { return conditions_; }
  unsigned probes() const { return probes_; }

 private:
  const app::CliContext& context_;
  std::string experiment_;
  points::Runner& runner_;
  std::vector<Condition> conditions_;
  unsigned probes_;
};

/// A bisection of which each value is a point.
class ValueSearch {
 public:
  using Make = std::function<Settings(std::uint64_t)>;
  using Label = std::function<std::string(std::uint64_t)>;
  /// `make` gives the settings of a value, besides `base`; `label` what the progress line calls it.
  ValueSearch(Session& session, Settings base, std::uint64_t last, Make make, Label label)
      : session_(session), base_(std::move(base)), make_(std::move(make)), label_(std::move(label)),
        bisection_(last, session.probes()) {}
  ValueSearch(const ValueSearch&) = delete;
  ValueSearch& operator=(const ValueSearch&) = delete;

  /// Adds the first point; `done` is called when the search is over.
  void start(std::function<void()> done);
  std::size_t at_most_left() const;

  struct Tried {
    const points::PointResult result;
    Verdict verdict;
  };
  const Tried& at(std::uint64_t value) const { return tried_.at(value); }
  const std::map<std::uint64_t, Tried>& tried() const { return tried_; }
  Bisection::Outcome outcome() const { return bisection_.outcome(); }
  /// The value that answers the question: the edge; of values that are all good the one with the least left of a frame
  /// period; between bad ends one that is good. Nothing if none is good, or nothing is known.
  std::optional<std::uint64_t> answer() const;
  /// What kept the search from an answer; null: nothing.
  const Verdict* failure() const { return failure_ ? &*failure_ : nullptr; }
  const Settings& base() const { return base_; }
  Settings settings(std::uint64_t value) const { return make_(value); }

 private:
  void ask();
  Session& session_;
  Settings base_;
  Make make_;
  Label label_;
  Bisection bisection_;
  std::map<std::uint64_t, Tried> tried_;
  std::optional<Verdict> failure_;
  std::function<void()> done_;
};

}  // namespace fovea::limits
