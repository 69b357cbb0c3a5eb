#include "sw/fovea/report/chart_data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "model/common/masters.h"
#include "model/cpu/core/stalls.h"
#include "sw/fovea/results/words.h"
#include "sw/fovea/tools/profile_report.h"

namespace fovea::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxFrames = 2000, kMaxIntervals = 360;
/// Frames that the detailed views show.
constexpr std::size_t kDetailedFrames = 6;
constexpr std::uint64_t kSmallest = 5000;

Json number(const StatBase::Value& value) {
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return *count;
  return std::get<double>(value);
}

Json ms(const std::optional<std::uint64_t>& ps) {
  return ps ? Json(static_cast<double>(*ps) * 1e-9) : Json(nullptr);
}

Json frames_json(const std::vector<video::FrameTimes>& rows) {
  Json out = Json::array();
  for (const auto& r : rows) {
    if (out.size() == kMaxFrames) break;
    out.push_back({{"frame", r.index},
                   {"camera", r.camera == video::kNoCamera ? Json(nullptr) : Json(r.camera)},
                   {"captured", r.captured ? Json(*r.captured) : Json(nullptr)},
                   {"capture", {ms(r.capture_start), ms(r.capture_end)}},
                   {"remap", {ms(r.remap_start), ms(r.remap_end)}},
                   {"display", {ms(r.display_start), ms(r.display_end)}},
                   {"dropped", r.dropped},
                   {"repeated", r.repeated}});
  }
  return out;
}

Json bandwidth_json(const Bandwidth& b) {
  Json edges = Json::array(), series = Json::array();
  for (const auto e : b.edges) edges.push_back(static_cast<double>(e) * 1e-9);
  for (std::size_t m = 0; m < b.masters.size(); ++m) {
    Json rates = Json::array();
    // Kilobytes per second are finer than any line of the chart.
    for (const double r : b.rates[m]) rates.push_back(std::round(r / 1e3) / 1e3);
    series.push_back({{"master", b.masters[m]}, {"mbps", std::move(rates)}});
  }
  return {{"edges_ms", std::move(edges)}, {"series", std::move(series)}};
}

/// From the first capture that is displayed to the end of some frames' display.
std::pair<std::uint64_t, std::uint64_t> detailed_span(const std::vector<video::FrameTimes>& frames) {
  std::uint64_t from = ~std::uint64_t{0}, to = 0;
  for (std::size_t i = 0; i < std::min(frames.size(), kDetailedFrames); ++i) {
    const auto& f = frames[i];
    from = std::min({from, f.capture_start.value_or(from), f.remap_start.value_or(from), f.display_start});
    to = std::max({to, f.capture_end.value_or(to), f.remap_end.value_or(to), f.display_end});
  }
  return {from, to};
}

Json timeline_json(const Results& run) {
  const auto& rows = run.timeline->rows;
  Json out = Json::object();
  if (rows.empty()) return out;
  const std::uint64_t start = rows.front().start, end = rows.back().end;
  const auto period = run.frames ? frame_period(*run.frames) : std::nullopt;
  const Periods whole = period ? periods(start, end, *period, kMaxIntervals) : Periods();
  out["whole"] = bandwidth_json(whole.edges.size() > 1 ? mean_bandwidth(*run.timeline, whole)
                                                       : bandwidth(*run.timeline, start, end, kMaxIntervals));
  if (run.frames && !run.frames->empty())
    if (const auto [from, to] = detailed_span(*run.frames); from < to)
      out["detail"] = bandwidth_json(bandwidth(*run.timeline, from, to, kMaxIntervals));
  return out;
}

struct Node {
  std::uint64_t clocks = 0;
  std::map<std::string, Node> children;
};

Json node_json(const std::string& name, const Node& node, std::uint64_t least) {
  Json out{{"name", name}, {"clocks", node.clocks}};
  Json children = Json::array();
  std::uint64_t rest = 0;
  for (const auto& [child, sub] : node.children) {
    if (sub.clocks < least)
      rest += sub.clocks;
    else
      children.push_back(node_json(child, sub, least));
  }
  if (rest > 0) children.push_back({{"name", "(smaller ones)"}, {"clocks", rest}});
  if (!children.empty()) out["children"] = std::move(children);
  return out;
}

}  // namespace

Bandwidth bandwidth(const Timeline& timeline, std::uint64_t from, std::uint64_t to,
                    std::size_t most) {
  Bandwidth out;
  std::vector<const app::TimelineRow*> rows;
  for (const auto& r : timeline.rows)
    if (r.end > from && r.start < to && r.end > r.start) rows.push_back(&r);
  if (rows.empty()) return out;
  const std::size_t step = (rows.size() + most - 1) / most;
  for (std::size_t i = 0; i < rows.size(); i += step) out.edges.push_back(rows[i]->start);
  out.edges.push_back(rows.back()->end);
  for (std::size_t m = 0; m < timeline.masters.size(); ++m) {
    std::vector<double> rates;
    double all = 0;
    for (std::size_t i = 0; i < rows.size(); i += step) {
      double bytes = 0;
      for (std::size_t k = i; k < std::min(i + step, rows.size()); ++k)
        bytes += static_cast<double>(rows[k]->read_bytes[m] + rows[k]->write_bytes[m]);
      const std::size_t n = rates.size();
      rates.push_back(bytes / (1e-12 * static_cast<double>(out.edges[n + 1] - out.edges[n])));
      all += bytes;
    }
    if (all == 0) continue;
    out.masters.push_back(timeline.masters[m]);
    out.rates.push_back(std::move(rates));
  }
  return out;
}

std::optional<FramePeriod> frame_period(const std::vector<video::FrameTimes>& frames) {
  if (frames.empty()) return std::nullopt;
  const video::FrameTimes &first = frames.front(), &last = frames.back();
  if (last.index <= first.index || last.display_start <= first.display_start) return std::nullopt;
  return FramePeriod{first.display_start, (last.display_start - first.display_start) / (last.index - first.index)};
}

Periods periods(std::uint64_t from, std::uint64_t to, FramePeriod of, std::size_t most) {
  Periods out;
  if (of.length == 0 || to <= from) return out;
  const std::uint64_t frames = (to - from) / of.length + 2;
  out.frames_each = (frames + most - 1) / most;
  const std::uint64_t length = of.length * out.frames_each;
  // The grid goes through a frame's beginning; what is not whole at both ends is left out.
  std::uint64_t at = of.anchor > from ? of.anchor - (of.anchor - from) / length * length
                                      : of.anchor + (from - of.anchor + length - 1) / length * length;
  for (; at <= to; at += length) out.edges.push_back(at);
  return out;
}

Bandwidth mean_bandwidth(const Timeline& timeline, const Periods& periods) {
  Bandwidth out;
  if (periods.edges.size() < 2) return out;
  out.edges = periods.edges;
  for (std::size_t m = 0; m < timeline.masters.size(); ++m) {
    std::vector<double> rates(out.edges.size() - 1);
    double all = 0;
    for (const auto& r : timeline.rows) {
      if (r.end <= r.start) continue;
      const auto bytes = static_cast<double>(r.read_bytes[m] + r.write_bytes[m]);
      // The first interval that ends behind the row's beginning.
      const auto behind = std::upper_bound(out.edges.begin(), out.edges.end(), r.start);
      for (auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(behind - out.edges.begin() - 1, 0));
           i + 1 < out.edges.size() && out.edges[i] < r.end; ++i) {
        const std::uint64_t from = std::max(r.start, out.edges[i]), to = std::min(r.end, out.edges[i + 1]);
        if (to <= from) continue;
        const double share = bytes * static_cast<double>(to - from) / static_cast<double>(r.end - r.start);
        rates[i] += share / (1e-12 * static_cast<double>(out.edges[i + 1] - out.edges[i]));
        all += share;
      }
    }
    if (all == 0) continue;
    out.masters.push_back(timeline.masters[m]);
    out.rates.push_back(std::move(rates));
  }
  return out;
}

Json stack_tree(const std::vector<std::pair<std::string, std::uint64_t>>& stacks) {
  Node root;
  for (const auto& [stack, clocks] : stacks) {
    Node* node = &root;
    node->clocks += clocks;
    const auto go = [&node, clocks = clocks](std::string_view name) {
      node = &node->children[std::string(name)];
      node->clocks += clocks;
    };
    std::size_t depth = 0;
    for (std::size_t from = 0; from <= stack.size(); ++depth) {
      const std::size_t end = std::min(stack.find(';', from), stack.size());
      if (depth == app::kShownDepth && end < stack.size()) {  // as the files of a profile have it
        go("...");
        go(std::string_view(stack).substr(stack.rfind(';') + 1));
        break;
      }
      go(std::string_view(stack).substr(from, end - from));
      from = end + 1;
    }
  }
  return node_json("all", root, root.clocks / kSmallest);
}

Json words_json() {
  Json out{{"causes", {{"issue", "instructions issue"}, {"idle", "idle (waits for an interrupt)"}}}};
  for (const cpu::CauseInfo& info : cpu::kCauseTable) out["causes"][info.name] = info.label;
  std::map<results::Group, std::string> keys;
  for (const results::GroupWords& w : results::group_words()) {
    keys[w.group] = w.key;
    out["groups"][keys[w.group]] = w.words;
    out["colours"][keys[w.group]] = w.colour;
  }
  for (const results::CulpritWords& w : results::culprit_words()) out["group_of"][std::string(w.name)] = keys[w.group];
  for (const MasterInfo& m : kMasters.rows)
    for (const std::string_view name : {m.name, m.statistics})
      out["group_of"][std::string(name)] = keys[results::group_of(name)];
  for (const results::Look& look : results::looks()) out["colours"][std::string(look.name)] = look.colour;
  return out;
}

Json chart_data(const Results& run, const std::string& label) {
  Json out{{"label", label}, {"name", run.name}};
  // Not `stats[name] = ...`, which looks for the name among all that are there; each occurs once.
  Json stats = Json::object();
  for (const auto& s : run.stats)
    stats.get_ref<Json::object_t&>().emplace_back(s.name, Json{number(s.value), s.unit});
  out["stats"] = std::move(stats);
  for (const cpu::WakeInfo& info : cpu::kWakeTable) out["events"][info.name] = info.who;
  if (run.frames) {
    out["frames"] = frames_json(*run.frames);
    out["frames_in_all"] = run.frames->size();
  }
  if (run.timeline) out["timeline"] = timeline_json(run);
  if (run.stalls) {
    Json rows = Json::array();
    for (const auto& s : *run.stalls) rows.push_back({s.cause, s.region, s.culprit, s.cycles});
    out["stalls"] = std::move(rows);
  }
  if (run.latency) {
    Json rows = Json::array();
    for (const auto& b : *run.latency)
      rows.push_back({b.master, b.direction, b.beat, b.low_ns, b.high_ns, b.count});
    out["latency"] = std::move(rows);
  }
  if (run.stacks) out["stacks"] = stack_tree(*run.stacks);
  return out;
}

}  // namespace fovea::report
