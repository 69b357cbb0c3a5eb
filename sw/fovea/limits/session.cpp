#include "sw/fovea/limits/session.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace fovea::limits {
namespace {

constexpr const char* kTraceName = "bus.trace";

}  // namespace

const Settings& Session::record() {
  static const Settings options = {"--bus-trace",
                                   fmt::format("{}/{}", points::kFolder, kTraceName)};
  return options;
}

void Session::run(const Settings& settings, const Settings& more, Done done, Settings options,
                  std::string label) {
  points::Point point;
  point.input = experiment_;
  point.settings = settings;
  point.settings.insert(point.settings.end(), more.begin(), more.end());
  point.options = std::move(options);
  point.options.push_back("--no-frames");
  point.identity = app::identity_of(*effective(point.settings), app::program_hash());
  if (label.empty()) label = more.empty() ? "as it is" : fmt::format("{}", fmt::join(more, ", "));
  point.label = std::move(label);
  runner_.add(std::move(point), std::move(done));
}

void Session::judged_run(const Settings& settings, const Settings& more, Judged done, std::string label) {
  run(
      settings, more,
      [this, settings, more, done, label](const points::PointResult& result) {
        const Verdict verdict = judge(result, conditions_);
        if (!verdict.longer) return done(result, verdict);
        Settings longer = settings;
        longer.insert(longer.end(), more.begin(), more.end());
        const auto effective = this->effective(longer);
        const auto* frames = dynamic_cast<const IntParam*>(effective->params.find("run.frames"));
        if (!frames) return done(result, verdict);
        const std::string window = fmt::format("run.frames={}", longer_window((*frames)()));
        longer.push_back(window);
        const std::string what = !label.empty() ? label : fmt::format("{}", fmt::join(more, ", "));
        run(
            longer, {}, [this, done](const points::PointResult& again) { done(again, judge(again, conditions_, 1)); },
            {}, what.empty() ? window : what + ", " + window);
      },
      {}, label);
}

void Session::replay(const points::PointResult& recorded, const Settings& settings, Done done,
                     Settings options) {
  points::Point point;
  point.command = "replay";
  point.input = (recorded.folder / kTraceName).string();
  point.settings = settings;
  point.options = std::move(options);
  point.identity = fmt::format("trace of {}\n{}\n", recorded.key, fmt::join(settings, "\n"));
  Settings shown = point.options;
  shown.insert(shown.end(), settings.begin(), settings.end());
  point.label = shown.empty() ? "replay as it is" : fmt::format("replay {}", fmt::join(shown, ", "));
  runner_.add(std::move(point), std::move(done));
}

void ValueSearch::start(std::function<void()> done) {
  done_ = std::move(done);
  ask();
}

void ValueSearch::ask() {
  const auto value = bisection_.next();
  if (!value) return done_();
  session_.judged_run(
      base_, make_(*value),
      [this, v = *value](const auto& result, const Verdict& verdict) {
        tried_.emplace(v, Tried{result, verdict});
        if (verdict.kind == Verdict::Kind::kUnknown) {
          failure_ = verdict;
          return done_();
        }
        bisection_.tell(v, verdict.good());
        ask();
      },
      label_(*value));
}

std::optional<std::uint64_t> ValueSearch::answer() const {
  if (failure_) return std::nullopt;
  const Bisection::Outcome o = outcome();
  if (o.answer == Bisection::Answer::kUnknown || o.answer == Bisection::Answer::kNone) return std::nullopt;
  if (o.answer != Bisection::Answer::kAll) return o.good;
  std::uint64_t tightest = tried_.rbegin()->first;
  for (const auto& [value, tried] : tried_) {
    const auto left = slack(tried.result), least = slack(tried_.at(tightest).result);
    if (left && least && *left < *least) tightest = value;
  }
  return tightest;
}

std::size_t ValueSearch::at_most_left() const {
  if (failure_) return 0;
  const std::size_t left = bisection_.at_most_left();
  return left > 0 ? left - 1 : 0;  // one is with the runner
}

}  // namespace fovea::limits
