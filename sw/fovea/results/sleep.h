// Which sleeps of the core are idle time, and which are waits for work that the program has given away.
#pragma once
#include <string_view>

namespace fovea::app {

/// Causes of profile.csv in which the core sleeps: `idle.EVENT` (`idle` where the event is not known), and
/// `wait.EVENT` within remaps. The event is the interrupt that ended the sleep.
inline bool is_sleep(std::string_view cause) {
  return cause == "idle" || cause.starts_with("idle.") || cause == "wait" || cause.starts_with("wait.");
}

/// The core sleeps because it has nothing to do. A sleep within a remap waits for the EDMA or the remap
/// engine, whichever interrupt ends it: that of the display may come in the midst of a transfer. Elsewhere
/// the program shows by no pin what it waits for: a sleep that the EDMA or the engine ends counts as such
/// a wait, every other one as idle. What so is idle adds up to `cpu.spare`.
inline bool is_idle(std::string_view cause) {
  return is_sleep(cause) && cause != "idle.dma" && cause != "idle.engine" && !cause.starts_with("wait");
}

/// For whom the sleeps within remaps wait, if they were ended by the EDMA or the engine for so many clocks:
/// `dma`, `engine`, `dma_or_engine` if by both, as nothing tells for which of them the core slept, or, if by neither,
/// empty.
inline std::string_view waited_for(double dma, double engine) {
  if (dma > 0 && engine > 0) return "dma_or_engine";
  return dma > 0 ? "dma" : engine > 0 ? "engine" : "";
}

}  // namespace fovea::app
