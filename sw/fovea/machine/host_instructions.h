// Counts the machine instructions that the host executes for the simulation.
#pragma once
#include <cstdint>
#include <optional>

namespace fovea::app {

/// Counts for the thread that constructs it, outside of the kernel, from then on. Many hosts (virtual
/// machines, containers) have no counter, or let no program use it.
class HostInstructions {
 public:
  HostInstructions();
  ~HostInstructions();
  HostInstructions(const HostInstructions&) = delete;
  HostInstructions& operator=(const HostInstructions&) = delete;
  /// Empty if the host does not count.
  std::optional<std::uint64_t> count() const;

 private:
  int file_ = -1;
};

}  // namespace fovea::app
