#include "sw/fovea/explain/words.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "model/common/masters.h"
#include "model/cpu/core/stalls.h"
#include "sw/fovea/files/sleep.h"

namespace fovea::explain {
namespace {

using Words = std::pair<std::string_view, std::string_view>;

constexpr std::array kCauses{Words{"interlock", "results of earlier instructions (interlocks)"},
                             Words{"icache", "line fills of the I-cache"},
                             Words{"dcache", "line fills of the D-cache"},
                             Words{"write_buffer", "room in the write buffer"},
                             Words{"uncached", "accesses that no cache serves"},
                             Words{"tlb", "page walks"},
                             Words{"tcm", "the internal RAM"},
                             Words{"cache_op", "cache maintenance"},
                             Words{"drain", "the write buffer to drain"},
                             Words{"bus_sync", "an edge of the bus clock"}};

constexpr std::array kCulprits{Words{"bridge", "in the bridge between core and crossbar"},
                               Words{"service", "on the unhindered way through crossbar and SDRAM controller"},
                               Words{"not_known", "on what is not remembered"},
                               Words{"core", "behind other accesses of the core itself"},
                               Words{"own", "behind other accesses of the core itself"},
                               Words{"row_miss", "on opening rows of closed banks"},
                               Words{"row_conflict", "on closing one row and opening another"},
                               Words{"refresh", "on refreshes"},
                               Words{"turnaround", "on turning the data bus between reads and writes"},
                               Words{"power_down", "on waking the SDRAM"}};

template <std::size_t N>
std::string_view look_up(const std::array<Words, N>& table, std::string_view key) {
  for (const auto& [name, words] : table)
    if (name == key) return words;
  return {};
}

/// The row of a culprit that is a master, by the name of its port or by that in the statistics.
const MasterInfo* master_row(std::string_view culprit) {
  for (const MasterInfo& r : kMasters.rows)
    if (r.name == culprit || r.statistics == culprit) return &r;
  return nullptr;
}

}  // namespace

std::string waits_for(std::string_view cause) {
  const auto words = look_up(kCauses, cause);
  return std::string(words.empty() ? cause : words);
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

std::string master(std::string_view culprit) {
  const MasterInfo* row = master_row(culprit);
  return row ? std::string(row->who) : "";
}

std::string spent(std::string_view culprit) {
  if (const auto words = look_up(kCulprits, culprit); !words.empty()) return std::string(words);
  if (const auto who = master(culprit); !who.empty()) return "while " + who + " is served";
  return "in " + std::string(culprit);
}

std::string spent_by_port(std::string_view culprit) {
  if (culprit == "own") return "behind other requests of its own";
  if (culprit == "bridge") return "in its bridge to the crossbar";
  if (const MasterInfo* row = master_row(culprit); row && is_core(row->id)) return "while the core is served";
  return spent(culprit);
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
