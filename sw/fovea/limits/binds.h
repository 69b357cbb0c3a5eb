// What binds a figure: each resource is relaxed alone, and the run is made again.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "sw/fovea/limits/relaxations.h"
#include "sw/fovea/limits/session.h"

namespace fovea::limits {

class Binds {
 public:
  struct Row {
    Relaxation relaxation;
    std::optional<double> before, after;
    /// How much better the figure gets, as a share of what it was; negative: worse.
    std::optional<double> gain;
    std::string failure;  ///< why there is no figure; empty: there is one, or it was not tried
    bool binds() const { return gain && *gain > kBinds; }
  };

  /// @param only names of relaxations; empty: all
  Binds(Session& session, std::string metric, bool higher_is_better, std::vector<std::string> only);
  Binds(const Binds&) = delete;
  Binds& operator=(const Binds&) = delete;

  /// Adds the plain run, then everything else; `done` is called when all of it is over.
  void start(Settings settings, std::function<void()> done);
  std::size_t at_most_left() const { return left_; }

  const std::string& metric() const { return metric_; }
  /// The figure of the plain run and its unit; nothing if it failed.
  std::optional<double> plain() const { return plain_; }
  const std::string& unit() const { return unit_; }
  /// Not met: why nothing can be said, and the status for that.
  const Verdict* failure() const { return failure_ ? &*failure_ : nullptr; }
  /// By gain, the largest first; those without a figure last.
  std::vector<Row> rows() const;
  /// Not empty: how far the replay of the plain run is from that run.
  const std::string& remark() const { return remark_; }

 private:
  void relax(const points::PointResult& plain);
  void replay_all(const points::PointResult& plain, const points::PointResult& replayed);
  void take(std::size_t row, std::optional<double> before, const points::PointResult& result);
  void one_done();

  Session& session_;
  std::string metric_, unit_, remark_;
  bool higher_;
  std::vector<std::string> only_;
  Settings settings_;
  std::optional<double> plain_;
  std::optional<Verdict> failure_;
  std::vector<Row> rows_;
  std::size_t left_ = 0;
  std::function<void()> done_;
};

/// Whether a larger figure of this name is the better one: rates, bandwidths, shares of what is left.
bool larger_is_better(std::string_view metric);

}  // namespace fovea::limits
