#include "sw/fovea/limits/binds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "model/common/masters.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/limits/figure_names.h"

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
                       fmt::format("--binds '{}': the run has {} of this name{}", app::one_line(metric_),
                                   plain_ || plain.units.contains(metric_) ? "no figure other than 0" : "no figure",
                                   names_hint(metric_, plain)),
                       2};
  }
  if (failure_) return done_();
  unit_ = plain.units.find(metric_)->second;
  for (Relaxation& r : relaxations(session_.effective(settings_)->params, plain)) {
    if (only_.empty() || std::find(only_.begin(), only_.end(), r.name) != only_.end())
      rows_.emplace_back().relaxation = std::move(r);
  }
  const auto tried = [](const Row& row) { return row.relaxation.idle.empty(); };
  bool replays = false;
  for (const Row& row : rows_) {
    if (!tried(row)) continue;
    left_ += row.relaxation.believed() ? 3 : 1;
    replays = replays || row.relaxation.replay;
  }
  if (left_ == 0) return done_();
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (tried(rows_[i]) && !rows_[i].relaxation.replay) run_row(i);
  if (replays)
    session_.replay(plain, {}, [this, plain](const points::PointResult& replayed) { replay_all(plain, replayed); });
}

void Binds::run_row(std::size_t i) {
  const Relaxation& r = rows_[i].relaxation;
  session_.run(settings_, r.settings, [this, i](const points::PointResult& result) { take(i, plain_, result); });
  if (!r.believed()) return;
  session_.run(settings_, r.low, [this, i](const points::PointResult& result) {
    rows_[i].low_plain = result.status == 0 ? result.stat(metric_) : std::nullopt;
    one_done();
  });
  session_.run(settings_, r.high, [this, i](const points::PointResult& result) {
    rows_[i].high_plain = result.status == 0 ? result.stat(metric_) : std::nullopt;
    one_done();
  });
}

void Binds::replay_all(const points::PointResult& plain, const points::PointResult& replayed) {
  const auto before = replayed.stat(metric_);
  const std::string refused = replay_refused(plain, replayed, metric_);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[i];
    if (!row.relaxation.replay || !row.relaxation.idle.empty()) continue;
    if (!refused.empty()) {
      row.relaxation.idle = refused;
      one_done();
      continue;
    }
    session_.replay(plain, row.relaxation.settings,
                    [this, i, before](const points::PointResult& result) { take(i, before, result); },
                    row.relaxation.options);
  }
}

std::string replay_refused(const points::PointResult& plain, const points::PointResult& replayed,
                           const std::string& metric) {
  if (replayed.status != 0) return "its replay failed: " + replayed.message;
  for (const MasterInfo& m : kMasters.rows) {
    const double kept = replayed.stat(fmt::format("bus.{}.at_recorded_time", m.statistics)).value_or(0);
    if (m.bridge != Bridge::kVideo && m.bridge != Bridge::kCore && kept > 0)
      return fmt::format("only a replay can do it, and the trace keeps the recorded times of {:.0f} of {}'s requests",
                         kept, m.statistics);
  }
  const auto run = plain.stat(metric), again = replayed.stat(metric);
  if (!run || !again || *again == 0) return "only a replay can do it, and it has no such figure";
  const double apart = std::abs(*again / *run - 1);
  if (apart <= kReplayError) return "";
  return fmt::format("only a replay can do it, and that gives {:.5g} for the run's {:.5g}, {:.1f} % off", *again, *run,
                     100 * apart);
}

void Binds::take(std::size_t i, std::optional<double> before, const points::PointResult& result) {
  Row& row = rows_[i];
  row.before = before;
  row.higher = higher_;
  row.after = result.status == 0 ? result.stat(metric_) : std::nullopt;
  row.gain = row.end(before).gain;
  if (!row.gain) row.failure = result.status ? result.message : "the run has no such figure then";
  one_done();
}

Binds::Row::End Binds::Row::end(std::optional<double> plain) const {
  End out{plain, {}};
  if (plain && after && *plain != 0) out.gain = (higher ? *after - *plain : *plain - *after) / std::abs(*plain);
  return out;
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
