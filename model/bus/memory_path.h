// How initiators that run ahead of the kernel reach the memory system behind their sockets.
#pragma once
#include <systemc>

#include "model/memsys/memory_system.h"

namespace fovea::bus {

/// While a running initiator holds the memory system it advances it itself; otherwise the owner keeps a
/// kernel event pending at the memory system's next event.
class MemoryPathIf : public virtual sc_core::sc_interface {
 public:
  virtual memsys::MemorySystem& memory() = 0;
  /// Called at the start and at the end of an activation of the initiator.
  virtual void hold() = 0;
  virtual void release() = 0;
  /// --sync=strict: every bus access waits for the kernel; no process works ahead of it.
  virtual bool strict() const = 0;
};

}  // namespace fovea::bus
