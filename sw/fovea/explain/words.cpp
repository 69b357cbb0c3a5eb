#include "sw/fovea/explain/words.h"

#include <fmt/format.h>

#include <cmath>

#include "model/cpu/core/stalls.h"
#include "sw/fovea/results/sleep.h"
#include "sw/fovea/results/words.h"

namespace fovea::explain {

std::string waits_for(std::string_view cause) {
  for (const cpu::CauseInfo& info : cpu::kCauseTable)
    if (info.name == cause) return info.waits_for;
  return std::string(cause);
}

std::string waits_or_sleeps_for(std::string_view cause) {
  if (!app::is_sleep(cause)) return waits_for(cause);
  const auto dot = cause.find('.');
  const std::string_view event = dot == cause.npos ? std::string_view() : cause.substr(dot + 1);
  std::string who;
  for (const cpu::WakeInfo& info : cpu::kWakeTable)
    if (event == info.name) who = info.who;
  if (!app::is_idle(cause)) return event == "dma" || event == "engine" ? who : "the EDMA or the remap engine";
  return who.empty() ? "an interrupt, asleep" : who + "'s interrupt, asleep";
}

std::string master(std::string_view culprit) { return std::string(results::master_words(culprit)); }

std::string spent(std::string_view culprit) {
  if (const auto* words = results::find_culprit(culprit)) return std::string(words->spent);
  if (const auto who = master(culprit); !who.empty()) return "while " + who + " is served";
  return "in " + std::string(culprit);
}

std::string spent_by_port(std::string_view culprit) {
  if (culprit == "own") return "behind other requests of its own";
  if (culprit == "bridge") return "in its bridge to the crossbar";
  const bool core = !results::find_culprit(culprit) && results::group_of(culprit) == results::Group::kItself;
  return core ? "while the core is served" : spent(culprit);
}

std::string percent(double ratio) {
  const double p = 100 * ratio;
  if (p > 0 && p < 0.1) return "less than 0.1 %";
  return std::abs(p) < 9.95 ? fmt::format("{:.1f} %", p) : fmt::format("{:.0f} %", p);
}

std::string milliseconds(double seconds) {
  const double ms = 1e3 * seconds;
  if (std::abs(ms) < 0.095) return fmt::format("{:.1f} us", 1e3 * ms);
  return std::abs(ms) < 9.95 ? fmt::format("{:.2f} ms", ms) : fmt::format("{:.1f} ms", ms);
}

}  // namespace fovea::explain
