// A slave beside the SDRAM that needs no event of the kernel for what it does.
#pragma once
#include "model/common/units.h"

namespace fovea::memsys {

/// Its acts are taken by MemorySystem, in time order with its own: ahead of the host's time where no other process
/// acts before them. Only the master of its request and a core that looks at every act may see them.
class PassiveSlave {
 public:
  virtual ~PassiveSlave() = default;
  /// What is due at `at`, which lies ahead of the host's time. MemorySystem::passive_acts_at() tells what follows.
  virtual void act_ahead(Picoseconds at) = 0;
  /// The host's time has come to what was due, at which others may act as well: the slave acts after them.
  virtual void act_at_present() = 0;
};

}  // namespace fovea::memsys
