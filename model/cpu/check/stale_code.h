// Finds instructions that the core executes from its I-cache although a DMA master has changed them in memory.
#pragma once
#include <cstdint>
#include <functional>
#include <unordered_map>

#include "model/cpu/check/hazard.h"
#include "model/cpu/core/core.h"

namespace fovea::cpu {

/// The core announces no fetches. Only while it holds a line that memory has changed does this class look at each
/// instruction boundary, which costs host time and no simulated time. Instructions that are read past the I-cache
/// are not looked at.
class StaleCode final : public BoundaryObserver {
 public:
  /// @param report is called for each instruction that is executed from changed bytes
  StaleCode(Core& core, std::function<void(const Hazard&)> report);

  /// The request for a line of the I-cache arrives at the memory.
  void requested(std::uint32_t line_pa, Picoseconds at);
  /// A master's write arrives. @param bytes of the line, one bit each
  void written(Master master, std::uint32_t line_pa, std::uint32_t bytes, Picoseconds at);
  void at_boundary() override;

 private:
  struct Changed {
    std::uint32_t bytes = 0;
    Master master = Master::kCount;
    Picoseconds at = 0, filled = 0;
  };
  bool held(std::uint32_t line_pa) const;
  void drop_replaced();

  Core& core_;
  const std::function<void(const Hazard&)> report_;
  std::unordered_map<std::uint32_t, Picoseconds> requested_;  // all lines ever read as code, and when last
  std::uint32_t last_ = 1;                                    // the latest of them, which may not have come yet
  std::unordered_map<std::uint32_t, Changed> changed_;
  unsigned boundaries_ = 0;
  Subscription watching_;  // while something is in changed_
};

}  // namespace fovea::cpu
