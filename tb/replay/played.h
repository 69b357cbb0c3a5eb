// Replays a trace from beginning to end, and checks its command bus.
#pragma once
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/trace/core/text_trace.h"
#include "sw/fovea/replay/replay_path.h"

namespace fovea::replay {

using Keys = std::vector<std::pair<std::string, std::string>>;

/// Replays a source and records the time at which each record was issued.
struct Played {
  std::vector<std::vector<Picoseconds>> issued{kMasterCount};
  std::unique_ptr<app::ReplayParams> params = std::make_unique<app::ReplayParams>();
  std::unique_ptr<app::ReplayPath> path;

  Played(const trace::TraceInfo& info, trace::RecordSource& source, bool memory_only = false,
         const Keys& keys = {}, MemObserver* observer = nullptr) {
    ParamSet set;
    params->declare(set);
    set.set("ddr.check", "commands");
    for (const auto& [key, value] : keys) set.set(key, value);
    params->check();
    path = std::make_unique<app::ReplayPath>("t", info, source, *params, memory_only);
    path->on_issue = [this](unsigned stream, Picoseconds at) { issued[stream].push_back(at); };
    const Subscription observing = observer ? path->observe(*observer) : Subscription();
    EXPECT_TRUE(path->run_before(kNever));
    path->finish();
  }
  explicit Played(trace::TextTrace& t, bool memory_only = false) : Played(t.info(), t, memory_only) {}
};

inline std::string master_lines(unsigned masters, unsigned window) {
  std::string text = "# dramtrace 1\n";
  for (unsigned m = 0; m < masters; ++m)
    text += fmt::format("# master {} window {} m{}\n", m, window, m);
  return text;
}

/// A source of given records for the streams of board_info().
struct Listed : trace::RecordSource {
  std::vector<std::vector<trace::Record>> records{3};
  std::vector<std::size_t> at = std::vector<std::size_t>(3);
  bool next(unsigned stream, trace::Record& r) override {
    if (at[stream] == records[stream].size()) return false;
    r = records[stream][at[stream]++];
    return true;
  }
};

inline trace::Record read_at(Picoseconds at, std::uint32_t address) {
  trace::Record r;
  r.bytes = 32;
  r.address = address;
  r.at = at;
  return r;
}

/// All rows of stats.json that have a value.
inline std::map<std::string, double> figures(const Played& p) {
  std::map<std::string, double> value;
  for (const app::StatRow& row : p.path->stats()) {
    const double v = std::visit([](auto x) { return static_cast<double>(x); }, row.value);
    if (std::isfinite(v)) value[row.name] = v;
  }
  return value;
}

}  // namespace fovea::replay
