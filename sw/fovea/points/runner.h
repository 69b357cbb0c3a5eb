// Runs points in several processes at once.
#pragma once
#include <atomic>
#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sw/fovea/points/child.h"
#include "sw/fovea/points/point_store.h"

namespace fovea::points {

struct RunnerOptions {
  std::filesystem::path program;  ///< what runs a point; Fovea's own executable
  unsigned jobs = 1;              ///< processes at once
  /// Earlier results with a status other than 0 don't count. Those with a status that is no property of the point,
  /// such as 2 of a full disk, never do.
  bool retry_failed = false;
  const std::atomic<bool>* stop = nullptr;  ///< set by Ctrl-C
  std::ostream* progress = nullptr;         ///< a line for each point that has ended
  /// How long a child may take to end after SIGTERM before it is killed.
  std::chrono::milliseconds patience{10'000};
  /// The longest time without a sign of life of a child; then it counts as hanging.
  std::chrono::milliseconds silence = kLongestSilence;
};

/// Takes points one after the other and calls back with each result; a callback may add more points.
/// Points of equal keys run once, and one that an earlier call has finished does not run again.
/// Results, and the order in which points are started, do not depend on the host's speed unless the
/// callbacks' own order matters. All of it happens on the calling thread.
class Runner {
 public:
  using Done = std::function<void(const PointResult&)>;
  Runner(PointStore& store, RunnerOptions options);
  ~Runner();

  void add(Point point, Done done);
  /// Runs what was added and what the callbacks add. @return false: stopped by `stop`; the points
  /// that had ended by then are kept, the others run with the next call
  /// @throws UserError if a point was ended by a signal (such as the kernel's for want of memory), if
  /// one hangs, or if the program cannot be started
  bool run();

  /// At most how many points may be added besides those that are known; for the time left.
  std::function<std::size_t()> may_follow;

  std::size_t ran() const { return ran_; }        ///< points that this object has run
  std::size_t reused() const { return reused_; }  ///< results of earlier calls
  /// Every point with its result, in the order in which they were added first.
  struct Entry {
    Point point;
    const PointResult* result = nullptr;  ///< null: not run
  };
  std::vector<Entry> entries() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Known {
    Point point;
    std::string key;
    std::vector<Done> waiting;
    std::unique_ptr<PointResult> result;
    bool reported = false;
  };
  struct Running {
    Known* known;
    std::unique_ptr<Child> child;
    std::vector<std::string> command;
    Clock::time_point since;
    Silence silence;
  };

  void start(Known& known);
  void collect();
  void look_for_silence();
  void finish(Running& running, const Ended& ended);
  void deliver(Known& known);
  void stop_children();
  void report(Known& known) const;
  std::string time_left() const;

  PointStore& store_;
  RunnerOptions options_;
  std::deque<std::unique_ptr<Known>> known_;
  std::map<std::string, Known*> by_key_;
  std::deque<Known*> queue_;  ///< to be looked up or run
  std::deque<Known*> ready_;  ///< with a result that was not delivered yet
  std::vector<Running> running_;
  std::size_t ran_ = 0, reused_ = 0;
  double seconds_ = 0;  ///< host time of the points that ran
};

}  // namespace fovea::points
