#include "sw/fovea/results/words.h"

#include <algorithm>
#include <array>

#include "model/common/masters.h"
#include "model/common/waits.h"

namespace fovea::results {
namespace {

constexpr std::array kGroups{
    GroupWords{Group::kIssue, "issue", "instructions", 0},
    GroupWords{Group::kItself, "itself", "the core itself", 5},
    GroupWords{Group::kBridge, "bridge", "bridge between core and crossbar", 6},
    GroupWords{Group::kWay, "way", "own way through crossbar and SDRAM controller", 4},
    GroupWords{Group::kRows, "rows", "SDRAM's rows, refresh, turnaround", 3},
    GroupWords{Group::kVideo, "video", "camera and display", 2},
    GroupWords{Group::kCopying, "copying", "EDMA and remap engine", 1},
    GroupWords{Group::kOther, "other", "other masters", 8},
};

constexpr std::array kCulprits{
    CulpritWords{"bridge", "bridges", "bridges", "in the bridge between core and crossbar", Group::kBridge},
    CulpritWords{"service", "own way", "own way through crossbar and SDRAM controller",
                 "on its own way through crossbar and SDRAM controller", Group::kWay},
    CulpritWords{"not_known", "not known", "not known", "on what is not remembered", Group::kOther},
    CulpritWords{"core", "the core itself", "other accesses of the core", "behind other accesses of the core itself",
                 Group::kItself},
    CulpritWords{"own", "queue", "queued behind the same master", "behind other accesses of the core itself",
                 Group::kItself},
    CulpritWords{"row_miss", "closed banks", "closed banks", "on opening rows of closed banks", Group::kRows},
    CulpritWords{"row_conflict", "row conflicts", "row conflicts", "on closing one row and opening another",
                 Group::kRows},
    CulpritWords{"turnaround", "turning the data bus", "turning the data bus",
                 "on turning the data bus between reads and writes", Group::kRows},
    CulpritWords{"refresh", "refresh", "refresh", "on refreshes", Group::kRows},
    CulpritWords{"power_down", "waking the SDRAM", "waking the SDRAM", "on waking the SDRAM", Group::kRows},
};
static_assert([] {
  for (std::size_t c = kMasterCount; c < fovea::kCulprits; ++c)
    if (std::none_of(kCulprits.begin(), kCulprits.end(),
                     [&](const CulpritWords& w) { return w.name == culprit_name(static_cast<Culprit>(c)); }))
      return false;
  return true;
}(), "each culprit of the model has its words");

/// The group of a master's requests, for whom they hold up.
constexpr Group master_group(const MasterInfo& m) {
  if (is_core(m.id)) return Group::kItself;
  if (m.id == Master::kVpfe || m.id == Master::kVpbe) return Group::kVideo;
  if (m.statistics.starts_with("edma") || m.id == Master::kRemapEngine) return Group::kCopying;
  return Group::kOther;
}

constexpr std::array kLooks{
    Look{"arm_d", 0},    Look{"arm_i", 5},    Look{"vpfe", 2},         Look{"vpbe", 1}, Look{"edma_tc0", 3},
    Look{"edma_tc1", 4}, Look{"edma_tc2", 6}, Look{"edma_tc3", 8},     Look{"load", 9}, Look{"remap_engine", 7},
    Look{"capture", 2},  Look{"remap", 0},    Look{"display", 1},
};
static_assert(std::all_of(kMasters.rows.begin(), kMasters.rows.end(),
                          [](const MasterInfo& m) {
                            return std::any_of(kLooks.begin(), kLooks.end(),
                                               [&](const Look& l) { return l.name == m.statistics; });
                          }),
              "each master has a colour of its own");

const MasterInfo* master_row(std::string_view name) {
  for (const MasterInfo& r : kMasters.rows)
    if (r.name == name || r.statistics == name) return &r;
  return nullptr;
}

}  // namespace

std::span<const GroupWords> group_words() { return kGroups; }
std::span<const CulpritWords> culprit_words() { return kCulprits; }
std::span<const Look> looks() { return kLooks; }

const CulpritWords* find_culprit(std::string_view name) {
  const auto found = std::find_if(kCulprits.begin(), kCulprits.end(), [&](const auto& w) { return w.name == name; });
  return found == kCulprits.end() ? nullptr : &*found;
}

Group group_of(std::string_view culprit) {
  if (const CulpritWords* words = find_culprit(culprit)) return words->group;
  const MasterInfo* row = master_row(culprit);
  return row ? master_group(*row) : Group::kOther;
}

std::string_view master_words(std::string_view name) {
  const MasterInfo* row = master_row(name);
  return row ? row->who : std::string_view();
}

}  // namespace fovea::results
