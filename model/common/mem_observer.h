// Observer interface of the crossbar.
#pragma once
#include "model/common/mem_request.h"

namespace fovea {

/// Called by the crossbar in the order in which it learns of things: times may lie ahead of the
/// kernel's. An observer changes nothing.
class MemObserver {
 public:
  virtual ~MemObserver() = default;
  /// The request is on its port at `issued`, on its way to `to_sdram` or to a register.
  virtual void submitted(const MemRequest& r, bool to_sdram) = 0;
  /// The outcome of a request to the SDRAM is decided: `first`, `last`, `error`, `priority`.
  virtual void responded(const MemRequest& r) = 0;
  /// The access to a register has ended; its data lie in the request.
  virtual void register_done(const MemRequest&) {}
};

}  // namespace fovea
