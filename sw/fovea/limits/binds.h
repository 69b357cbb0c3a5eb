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
    /// The figure at an end of the belief interval of what is relaxed, and the gain of relaxing it from there.
    struct End {
      std::optional<double> plain, gain;
      bool binds() const { return gain && *gain > kBinds; }
    };
    std::optional<double> low_plain, high_plain;
    End low() const { return end(low_plain); }
    End high() const { return end(high_plain); }
    bool higher = false;  ///< a larger figure is the better one
    bool binds() const { return gain && *gain > kBinds; }
    /// It does not as it is, but it does at an end of what is believed.
    bool may_bind() const { return !binds() && (low().binds() || high().binds()); }

   private:
    friend class Binds;
    End end(std::optional<double> plain) const;
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

 private:
  void relax(const points::PointResult& plain);
  void run_row(std::size_t row);
  void replay_all(const points::PointResult& plain, const points::PointResult& replayed);
  void take(std::size_t row, std::optional<double> before, const points::PointResult& result);
  void one_done();

  Session& session_;
  std::string metric_, unit_;
  bool higher_;
  std::vector<std::string> only_;
  Settings settings_;
  std::optional<double> plain_;
  std::optional<Verdict> failure_;
  std::vector<Row> rows_;
  std::size_t left_ = 0;
  std::function<void()> done_;
};

/// Why a replay of the plain run says nothing about a figure, or nothing of what another memory would make of it; or
/// empty: it does. It keeps to its run within kReplayError, and no master keeps the times at which its requests were
/// recorded, but for the video ports, whose pixels have times of their own, and the core's first requests.
std::string replay_refused(const points::PointResult& plain, const points::PointResult& replayed,
                           const std::string& metric);
/// A quarter of what counts as binding would be too much; replays of kernels of the core miss by much less.
inline constexpr double kReplayError = 0.003;

/// Whether a larger figure of this name is the better one: rates, bandwidths, shares of what is left.
bool larger_is_better(std::string_view metric);

}  // namespace fovea::limits
