#include "sw/fovea/limits/study.h"

#include <algorithm>

namespace fovea::limits {

using Answer = Bisection::Answer;

std::optional<ValueRange> check_question(const Question& question, const Settings& settings,
                                         const Effective& effective) {
  const auto plain = effective(settings);
  if (question.load) free_load(plain->params);
  if (!question.binds.empty()) check_names(question.relax, relaxations(plain->params, {}));
  if (question.find.empty()) return std::nullopt;
  ValueRange range(plain->params, question.find);
  for (const std::uint64_t end : {std::uint64_t{0}, range.last()}) {
    Settings all = settings;
    all.push_back(range.setting(end));
    effective(all);
  }
  return range;
}

Study::Study(Session& session, const Question& question, Settings settings, Settings over)
    : session_(session), question_(question), over_(std::move(over)), settings_(std::move(settings)) {
  settings_.insert(settings_.end(), over_.begin(), over_.end());
  range_ = check_question(question_, settings_, [this](const Settings& s) { return session_.effective(s); });
}

void Study::start() {
  if (range_) {
    const auto setting = [this](std::uint64_t n) { return range_->setting(n); };
    find_ = std::make_unique<ValueSearch>(
        session_, settings_, range_->last(), [=](std::uint64_t n) { return Settings{setting(n)}; }, setting);
    find_->start([this] {
      const auto n = find_->answer();
      if (question_.binds.empty() || !n) return;
      binds_at_ = range_->setting(*n);
      start_binds({binds_at_});
    });
  } else if (!question_.binds.empty()) {
    start_binds({});
  }
  const bool nothing_else = !range_ && question_.binds.empty();
  if (!question_.load && !nothing_else) return;
  session_.judged_run(settings_, {}, [this](const points::PointResult& result, const Verdict& verdict) {
    plain_ = result;
    plain_verdict_ = verdict;
    if (question_.load && plain_verdict_.good()) start_loads();
  });
}

void Study::start_binds(const Settings& more) {
  Settings settings = settings_;
  settings.insert(settings.end(), more.begin(), more.end());
  binds_ = std::make_unique<Binds>(session_, question_.binds,
                                   question_.higher_is_better || larger_is_better(question_.binds),
                                   question_.relax);
  binds_->start(std::move(settings), [] {});
}

void Study::start_loads() {
  const auto effective = session_.effective(settings_);
  const std::string group = free_load(effective->params);
  for (const LoadPlace& place : question_.places)
    loads_.push_back(std::make_unique<LoadSearch>(session_, settings_, place, question_.shape, group, *plain_,
                                                  effective->params));
  for (const auto& load : loads_) load->search().start([] {});
}

std::size_t Study::at_most_left() const {
  std::size_t left = find_ ? find_->at_most_left() : 0;
  for (const auto& load : loads_) left += load->search().at_most_left();
  return left;
}

int Study::status() const {
  const auto of = [](const Verdict& v) { return v.kind == Verdict::Kind::kUnknown ? v.status : 1; };
  if (find_) {
    if (find_->failure()) return of(*find_->failure());
    if (find_->outcome().answer == Answer::kNone) return 1;
  }
  if (binds_ && binds_->failure())
    return binds_->failure()->status;
  for (const auto& load : loads_)
    if (load->search().failure()) return of(*load->search().failure());
  if (plain_ && !plain_verdict_.good()) return of(plain_verdict_);
  return 0;
}

}  // namespace fovea::limits
