#include "sw/fovea/limits/binds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sw/fovea/checked_file.h"

namespace fovea::limits {

bool larger_is_better(std::string_view metric) {
  constexpr std::array<std::string_view, 9> kWords = {"rate", "bandwidth", "headroom", "efficiency", "row_hits",
                                                      "idle", "psnr",      "ssim",     "displayed"};
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view w) { return metric.find(w) != metric.npos; });
}

Binds::Binds(Session& session, std::string metric, bool higher_is_better, std::vector<std::string> only)
    : session_(session), metric_(std::move(metric)), higher_(higher_is_better), only_(std::move(only)) {}

void Binds::start(Settings settings, std::function<void()> done) {
  settings_ = std::move(settings);
  done_ = std::move(done);
  session_.run(settings_, {}, [this](const points::PointResult& plain) { relax(plain); }, Session::record());
}

void Binds::relax(const points::PointResult& plain) {
  plain_ = plain.stat(metric_);
  if (plain.status != 0) {
    failure_ = Verdict{plain.status == 3 ? Verdict::Kind::kBad : Verdict::Kind::kUnknown,
                       fmt::format("the run ended with status {}: {}", plain.status, plain.message), plain.status};
  } else if (!plain_ || *plain_ == 0) {
    failure_ = Verdict{Verdict::Kind::kUnknown,
                       fmt::format("--binds '{}': the run has {} of this name; those that it has are in {}",
                                   app::one_line(metric_), plain_ || plain.units.contains(metric_)
                                       ? "no figure other than 0" : "no figure",
                                   app::one_line((plain.folder / "run/stats.json").string())), 2};
  }
  if (failure_) return done_();
  unit_ = plain.units.find(metric_)->second;
  for (Relaxation& r : relaxations(session_.effective(settings_)->params, plain)) {
    if (only_.empty() || std::find(only_.begin(), only_.end(), r.name) != only_.end())
      rows_.push_back({.relaxation = std::move(r), .before = {}, .after = {}, .gain = {}, .failure = {}});
  }
  const auto tried = [](const Row& row) { return row.relaxation.idle.empty(); };
  left_ = static_cast<std::size_t>(std::count_if(rows_.begin(), rows_.end(), tried));
  const bool replays = std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) {
    return row.relaxation.replay && tried(row);
  });
  if (left_ == 0) return done_();
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (tried(rows_[i]) && !rows_[i].relaxation.replay)
      session_.run(settings_, rows_[i].relaxation.settings,
                   [this, i](const points::PointResult& result) { take(i, plain_, result); });
  if (replays)
    session_.replay(plain, {}, [this, plain](const points::PointResult& replayed) { replay_all(plain, replayed); });
}

void Binds::replay_all(const points::PointResult& plain, const points::PointResult& replayed) {
  const auto before = replayed.stat(metric_);
  if (before && std::abs(*before - *plain_) > kBinds * *plain_)
    remark_ = fmt::format("A replay of the plain run gives {:.5g} instead of {:.5g}; relaxations by replay are "
                          "compared with that replay.", *before, *plain_);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[i];
    if (!row.relaxation.replay || !row.relaxation.idle.empty()) continue;
    if (!before || *before == 0) {
      row.failure = replayed.status ? replayed.message : "only a replay can do this, and it has no such figure";
      one_done();
      continue;
    }
    session_.replay(plain, row.relaxation.settings,
                    [this, i, before](const points::PointResult& result) { take(i, before, result); },
                    row.relaxation.options);
  }
}

void Binds::take(std::size_t i, std::optional<double> before, const points::PointResult& result) {
  Row& row = rows_[i];
  row.before = before;
  row.after = result.status == 0 ? result.stat(metric_) : std::nullopt;
  if (row.after)
    row.gain = (higher_ ? *row.after - *before : *before - *row.after) / std::abs(*before);
  else
    row.failure = result.status ? result.message : "the run has no such figure then";
  one_done();
}

void Binds::one_done() {
  if (--left_ == 0) done_();
}

std::vector<Binds::Row> Binds::rows() const {
  std::vector<Row> out = rows_;
  std::stable_sort(out.begin(), out.end(), [](const Row& a, const Row& b) {
    if (!a.gain || !b.gain) return a.gain.has_value() && !b.gain.has_value();
    return *a.gain > *b.gain;
  });
  return out;
}

}  // namespace fovea::limits
