#include "sw/fovea/tools/frame_parts.h"

#include <fmt/format.h>

#include <vector>

namespace fovea::app {
namespace {

using cpu::ClockProfile;

/// The core's clocks between two snapshots, with the names of their causes.
std::vector<std::pair<std::string, std::uint64_t>> clocks_between(const ClockProfile::Snapshot& from,
                                                                  const ClockProfile::Snapshot& to) {
  std::vector<std::pair<std::string, std::uint64_t>> out = {{"issue", to.issue - from.issue},
                                                            {"idle", to.idle - from.idle}};
  for (const cpu::CauseInfo& info : cpu::kCauseTable)
    out.emplace_back(info.name, to.stall[cpu::index(info.cause)] - from.stall[cpu::index(info.cause)]);
  return out;
}

}  // namespace

std::string frame_parts_csv(std::span<const video::FrameTimes> frames,
                            const std::map<Picoseconds, ClockProfile::Snapshot>& snapshots) {
  std::string out = "frame,part,time_ns\n";
  for (const video::FrameTimes& f : frames) {
    if (!f.capture_start || !f.capture_end || !f.remap_start || !f.remap_end) continue;
    const auto from = snapshots.find(*f.remap_start), to = snapshots.find(*f.remap_end);
    if (from == snapshots.end() || to == snapshots.end()) continue;
    const auto part = [&](const std::string& name, Picoseconds time) {
      if (time) out += fmt::format("{},{},{}\n", f.index, name, ns_text(time));
    };
    part("capture", *f.capture_end - *f.capture_start);
    part("wait_for_core", *f.remap_start - *f.capture_end);
    // The clocks are shares of the remap's time: the boundaries of instructions are not exactly at its
    // ends.
    const auto clocks = clocks_between(from->second, to->second);
    std::uint64_t all = 0, before = 0;
    for (const auto& [name, n] : clocks) all += n;
    const auto share = [&](std::uint64_t n) {
      return static_cast<Picoseconds>(static_cast<unsigned __int128>(*f.remap_end - *f.remap_start) *
                                      n / all);
    };
    if (all == 0) part("remap", *f.remap_end - *f.remap_start);
    for (const auto& [name, n] : clocks) {
      if (n) part("remap." + name, share(before + n) - share(before));
      before += n;
    }
    part("wait_for_display", f.display_start - *f.remap_end);
  }
  return out;
}

}  // namespace fovea::app
