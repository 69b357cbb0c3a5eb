// Acts that must see everything else that happens at the same instant.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <systemc>
#include <utility>

#include "model/common/masters.h"
#include "model/common/timer.h"

namespace fovea {

/// The order of acts of one instant: first those of the masters, by their numbers.
enum class InstantRank : std::uint8_t {
  kObservers = kMasterCount,  ///< edges of the measured window, debuggers, and who else looks at the instant
  kReset,                     ///< the chip's reset begins or ends
};
constexpr InstantRank instant_rank(Master m) { return static_cast<InstantRank>(index(m)); }

/// Runs callbacks at a time T after all other activity of T, by rank, then in the order of the calls.
/// One such object serves a whole simulation: two would wait for each other. Register accesses and the
/// edges of the measured window use it, so that they see the same state whatever the order of processes
/// within T.
class EndOfInstant : public sc_core::sc_module {
 public:
  explicit EndOfInstant(sc_core::sc_module_name name) : sc_module(name) {
    SC_HAS_PROCESS(EndOfInstant);
    SC_METHOD(run);
    sensitive << due_.event();
    dont_initialize();
  }

  /// `at` >= now.
  void at(Picoseconds at, InstantRank rank, std::function<void()> f) {
    queue_.emplace(Key{at, rank, ++serial_}, std::move(f));
    due_.at(queue_.begin()->first.at);
  }

 private:
  struct Key {
    Picoseconds at;
    InstantRank rank;
    std::uint64_t serial;
    auto operator<=>(const Key&) const = default;
  };

  void run() {
    if (sc_core::sc_pending_activity_at_current_time()) {
      next_trigger(sc_core::SC_ZERO_TIME);
      return;
    }
    const Picoseconds now = kernel_time();
    while (!queue_.empty() && queue_.begin()->first.at <= now) {
      auto f = std::move(queue_.begin()->second);
      queue_.erase(queue_.begin());
      f();
    }
    if (!queue_.empty()) due_.at(queue_.begin()->first.at);
  }

  std::multimap<Key, std::function<void()>> queue_;
  std::uint64_t serial_ = 0;
  Timer due_;
};

}  // namespace fovea
