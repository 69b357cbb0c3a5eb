// A comparison for programs: CSV and JSON.
#include <nlohmann/json.hpp>

#include "sw/fovea/compare/compare.h"
#include "sw/fovea/files/safe_json.h"
#include "sw/fovea/results/table_file.h"

namespace fovea::regression {
namespace {

using results::table_row;

using Json = nlohmann::ordered_json;

std::string number(const Metric* m) {
  return m && m->value ? exact_text(*m->value, m->whole) : "";
}

std::string number(std::optional<double> value, bool whole = false) {
  return value ? exact_text(*value, whole) : "";
}

bool counts(const MetricChange& m) { return m.before && m.after && m.before->whole && m.after->whole; }

Json optional_json(std::optional<double> value) { return value ? Json(*value) : Json(nullptr); }

Json metric_json(const Metric* m) {
  if (!m || !m->value) return nullptr;
  return app::json_number(*m->value, m->whole);
}

Json share_json(const Share& s) {
  return {{"a", s.before}, {"b", s.after}, {"change", s.change()}};
}

Json difference_json(const Difference& d) {
  Json out = {{"unit", d.in_seconds ? "s" : "clocks"},
              {"by_function", d.by_function},
              {"total", share_json(d.total)},
              {"busy", share_json(d.busy)},
              {"idle", share_json(d.idle)},
              {"unexplained", d.unexplained},
              {"unexplained_share", d.unexplained_share()}};
  Json& functions = out["functions"] = Json::array();
  for (const auto& f : d.functions) {
    Json entry = {{"function", f.function},
                  {"file", f.file},
                  {"why", kind_text(f.kind, f.instructions_after > f.instructions_before)},
                  {"clocks", share_json(f.share)},
                  {"layout", f.layout},
                  {"instructions", {{"a", f.instructions_before}, {"b", f.instructions_after}}}};
    Json& causes = entry["causes"] = Json::array();
    for (const auto& c : f.causes)
      causes.push_back({{"cause", c.cause}, {"region", c.region}, {"culprit", c.culprit},
                        {"change", c.share.change()}});
    Json& lines = entry["lines"] = Json::array();
    for (const auto& l : f.lines)
      lines.push_back({{"a", l.before ? Json(*l.before) : Json(nullptr)},
                       {"b", l.after ? Json(*l.after) : Json(nullptr)},
                       {"change", l.share.change()}});
    functions.push_back(std::move(entry));
  }
  const Blame blame = blame_of(d, d.busy.change() >= 0);
  out["blame"] = blame_text(d, blame);
  return out;
}

}  // namespace

std::string comparison_csv(const Comparison& c) {
  std::string out = table_row({"figure", "unit", "a", "b", "difference", "relative"});
  for (const auto& m : c.changes)
    out += table_row({m.name, m.after ? m.after->unit : m.before->unit, number(m.before),
                      number(m.after), number(m.difference(), counts(m)), number(m.relative())});
  return out;
}

std::string comparison_json(const Comparison& c) {
  Json out = {{"equal", c.changes.empty()},
              {"compared", c.compared},
              {"settings", differences_of_settings(*c.before, *c.after)}};
  Json& figures = out["figures"] = Json::array();
  for (const auto& m : c.changes)
    figures.push_back({{"name", m.name},
                       {"unit", m.after ? m.after->unit : m.before->unit},
                       {"a", metric_json(m.before)},
                       {"b", metric_json(m.after)},
                       {"difference", optional_json(m.difference())},
                       {"relative", optional_json(m.relative())}});
  out["clocks"] = c.difference ? difference_json(*c.difference) : Json(nullptr);
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace fovea::regression
