// Observer interface of the SDRAM controller's input.
#pragma once
#include "model/common/mem_request.h"

namespace fovea {

/// Told about each request as the memory system hands it to the SDRAM controller, in the order in which
/// the memory sees accesses to one address. An observer changes nothing.
class ArrivalObserver {
 public:
  virtual ~ArrivalObserver() = default;
  /// Its data are not moved yet. `at` may lie a clock ahead of the event that is being taken.
  virtual void arrived(const MemRequest& r, Picoseconds at) = 0;
};

}  // namespace fovea
