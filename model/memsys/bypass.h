// A memory system without its crossbar: requests go straight to the controller's input.
#pragma once
#include <array>
#include <cstdint>
#include <deque>

#include "model/bus/core/timeline.h"
#include "model/common/masters.h"
#include "model/common/mem_request.h"

namespace fovea::memsys {

/// Requests that wait because the controller's input register is taken, by master; and whose turn it
/// is when it is free again: the most urgent first, among equals in turn, as in the crossbar.
class Bypass {
 public:
  explicit Bypass(Picoseconds timeline_interval) : timeline(timeline_interval) {}

  void wait(MemRequest& r) {
    const auto m = static_cast<unsigned>(index(r.master));
    waiting_[m].push_back(&r);
    masters_ |= 1u << m;
  }
  bool any_waits() const { return masters_ != 0; }
  /// Takes the next one out; only if any_waits().
  MemRequest& next();
  /// The request goes to the controller at `at`.
  void count(const MemRequest& r, Picoseconds at) {
    last_ = static_cast<unsigned>(index(r.master));
    timeline.add(last_, r.write, r.bytes, at);
  }

  bool input_taken = false;         ///< a request waits in the controller's input register
  bool input_freed = false;         ///< within the controller's present step
  Picoseconds freed_at = 0;
  bus::Timeline timeline;           ///< bytes handed to the controller

 private:
  std::array<std::deque<MemRequest*>, kMasterCount> waiting_;
  std::uint32_t masters_ = 0;       // those with a waiting request
  unsigned last_ = 0;               // master whose request went last
};

}  // namespace fovea::memsys
