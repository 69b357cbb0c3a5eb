// What `fovea limits` asks about one combination of --over, and the answers.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/limits/binds.h"
#include "sw/fovea/limits/load_search.h"
#include "sw/fovea/limits/session.h"
#include "sw/fovea/limits/value_range.h"

namespace fovea::limits {

/// What is asked of every combination.
struct Question {
  std::string find;   ///< KEY=LOW..HIGH[:STEP]; empty: none
  std::string binds;  ///< a figure; empty: none
  bool load = false;
  bool higher_is_better = false;
  std::vector<std::string> relax;
  std::vector<LoadPlace> places;
  LoadShape shape;
};

/// The parameters that settings give. @throws UserError for settings that are not allowed
using Effective = std::function<std::unique_ptr<app::EffectiveRun>(const Settings&)>;
/// Says what is wrong with a question for one combination of settings, as far as no run is needed for it.
/// @return the values of --find, if it is asked
/// @throws UserError: settings, ends of a range or names of relaxations that are not allowed
std::optional<ValueRange> check_question(const Question& question, const Settings& settings,
                                         const Effective& effective);

class Study {
 public:
  /// @param over the combination's own settings, which come after `settings`
  /// @throws UserError as check_question()
  Study(Session& session, const Question& question, Settings settings, Settings over);
  Study(const Study&) = delete;
  Study& operator=(const Study&) = delete;

  void start();
  std::size_t at_most_left() const;

  const Settings& over() const { return over_; }
  const std::optional<ValueRange>& range() const { return range_; }
  const ValueSearch* find() const { return find_.get(); }
  const std::vector<std::unique_ptr<LoadSearch>>& loads() const { return loads_; }
  const Binds* binds() const { return binds_.get(); }
  /// The setting that `binds` was asked about besides the combination's; empty: none.
  const std::string& binds_at() const { return binds_at_; }
  /// The run without anything added, if one was needed, and whether it meets the conditions.
  const points::PointResult* plain() const { return plain_ ? &*plain_ : nullptr; }
  const Verdict& plain_verdict() const { return plain_verdict_; }

  /// The exit status for this combination alone: 0 found, 1 not met at any value, else of a failure.
  int status() const;

 private:
  void start_binds(const Settings& more);
  void start_loads();
  Session& session_;
  const Question& question_;
  Settings over_, settings_;
  std::optional<ValueRange> range_;
  std::unique_ptr<ValueSearch> find_;
  std::vector<std::unique_ptr<LoadSearch>> loads_;
  std::unique_ptr<Binds> binds_;
  std::string binds_at_;
  std::optional<points::PointResult> plain_;
  Verdict plain_verdict_;
};

}  // namespace fovea::limits
