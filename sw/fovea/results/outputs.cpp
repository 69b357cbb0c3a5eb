#include "sw/fovea/results/outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "sw/fovea/files/warnings.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/run_dir.h"

namespace fovea::app {
namespace {

using Json = nlohmann::ordered_json;

/// The text of a value without line breaks, e.g. `{"value": 1, "unit": "B"}`. Bytes that are not
/// UTF-8 become the replacement character.
std::string one_line_json(const Json& value) {
  const std::string text = value.dump(0, ' ', false, Json::error_handler_t::replace);
  // Line breaks inside strings are escaped, so that the others separate the elements.
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\n') {
      out += text[i];
      continue;
    }
    const bool after_bracket = out.back() == '{' || out.back() == '[';
    const bool before_bracket = text[i + 1] == '}' || text[i + 1] == ']';
    if (!after_bracket && !before_bracket) out += ' ';
  }
  return out;
}

/// The text of a file: an object with one member per line. A member that is listed in `nested` has
/// a line for each of its own elements.
std::string file_json(const Json& members, const std::set<std::string>& nested = {}) {
  std::string out = "{";
  const char* separator = "\n";
  for (const auto& [name, value] : members.items()) {
    out += separator + ("  " + Json(name).dump()) + ": ";
    separator = ",\n";
    if (!nested.contains(name) || value.empty()) {
      out += one_line_json(value);
      continue;
    }
    out += value.is_array() ? "[" : "{";
    const char* inner = "\n";
    for (const auto& [key, element] : value.items()) {
      out += std::string(inner) + "    ";
      if (value.is_object()) out += one_line_json(key) + ": ";
      out += one_line_json(element);
      inner = ",\n";
    }
    out += value.is_array() ? "\n  ]" : "\n  }";
  }
  return out + "\n}\n";
}

/// A number; JSON has none for infinity and "not a number", which become null.
Json number_json(const StatBase::Value& value) {
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return *count;
  const double number = std::get<double>(value);
  return number == 0 ? 0.0 : number;  // avoids "-0.0"
}

void append_rows(Json& out, std::vector<StatRow> rows) {
  std::sort(rows.begin(), rows.end(),
            [](const StatRow& a, const StatRow& b) { return a.name < b.name; });
  for (const StatRow& r : rows) {
    FOVEA_CHECK(!out.contains(r.name), "two statistics are called " + r.name);
    out[r.name] = {
        {"value", number_json(r.value)}, {"unit", r.unit}, {"description", r.description}};
  }
}

Json belief_json(const Belief& belief) {
  if (belief.empty()) return nullptr;
  return {{"low", belief.low}, {"high", belief.high}, {"reason", belief.reason}};
}

std::string cell(const std::optional<Picoseconds>& time) { return time ? ns_text(*time) : ""; }

/// A counter's value; 0 if there is none of that name.
std::uint64_t count_of(std::span<const StatRow> stats, const char* name) {
  const StatRow* row = find(stats, name);
  const auto* n = row ? std::get_if<std::uint64_t>(&row->value) : nullptr;
  return n ? *n : 0;
}

/// Whether several remaps were made for each new frame on the display: the remap loop does not wait
/// for the camera, and its own rate is the figure of the run.
bool remaps_in_a_row(std::span<const StatRow> stats) {
  const std::uint64_t displayed = count_of(stats, names::kDisplayed);
  const std::uint64_t fresh = displayed - std::min(count_of(stats, names::kRepeated), displayed);
  return fresh > 0 && 2 * count_of(stats, names::kRemapped) >= 3 * fresh;
}

}  // namespace

void collect(const StatGroup& group, std::vector<StatRow>& rows) {
  for (const auto* s : group.stats())
    rows.push_back({s->name(), s->value(), s->unit(), s->sentence()});
}

const StatRow* find(std::span<const StatRow> rows, std::string_view name) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const StatRow& row) { return row.name == name; });
  return found == rows.end() ? nullptr : &*found;
}

std::string number_text(double value) { return number_json(value).dump(); }

std::string number_text(const StatBase::Value& value) { return number_json(value).dump(); }

std::string ns_text(Picoseconds ps) {
  return fmt::format("{}.{:03}", ps / kPsPerNs, ps % kPsPerNs);
}

std::string config_json(const ParamSet& params, const Experiment& experiment,
                        const Provenance& provenance) {
  Json hashes = Json::object();
  for (const auto& [name, hash] : provenance.inputs)
    hashes[name] = hash.empty() ? Json(nullptr) : Json(hash);
  std::vector<const ParamBase*> sorted(params.all().begin(), params.all().end());
  std::sort(sorted.begin(), sorted.end(),
            [](const ParamBase* a, const ParamBase* b) { return a->key() < b->key(); });
  Json values = Json::object();
  for (const auto* p : sorted) {
    // A key of one camera that is not set has the value of the key of all cameras.
    if (is_camera_row(p->key()) && experiment.rank(p->key()) < 0) continue;
    values[p->key()] = {{"value", p->text()},
                        {"unit", p->unit()},
                        {"origin", experiment.origin(p->key()).text()},
                        {"default", p->default_text()},
                        {"allowed", p->allowed()},
                        {"tag", to_string(p->origin())},
                        {"source", p->source()},
                        {"belief", belief_json(p->belief())},
                        {"description", p->sentence()}};
  }
  Json out = {{"format", kRunFormat},
              {"version", provenance.version},
              {"commit", provenance.commit},
              {"modified", provenance.modified},
              {"experiment", experiment.name()}};
  if (!provenance.command.empty())
    out.update({{"command", provenance.command},
                {"input", provenance.input},
                {"arguments", provenance.arguments},
                {"options", provenance.options}});
  out.update({{"sha256", hashes}, {"params", values}});
  return file_json(out, {"sha256", "params"});
}

std::vector<Warning> collect_warnings(const DiagnosticsRef& diagnostics, bool replay) {
  std::vector<Warning> out;
  for (const auto& [key, count] : diagnostics.counts())
    out.push_back(
        {std::string(warning_kind(key.first, replay)), warning_text(key.first, key.second), count});
  return out;
}

std::string stats_json(std::vector<StatRow> rows, bool complete,
                       const std::vector<Warning>& warnings, const RunWords& words) {
  Json out = {{"complete", complete}, {"band", "not run"}};
  if (!words.ended_by.empty()) out["ended_by"] = words.ended_by;
  if (!words.kernel.empty()) out["kernel"] = words.kernel;
  Json& list = out["warnings"] = Json::array();
  for (const Warning& w : warnings)
    list.push_back({{"kind", w.kind}, {"what", w.what}, {"count", w.count}});
  append_rows(out, std::move(rows));
  return file_json(out, {"warnings"});
}

std::string host_json(std::vector<StatRow> rows, std::span<const std::string> command,
                      std::string_view version) {
  Json out = {{"version", version}, {"command", command}};
  append_rows(out, std::move(rows));
  return file_json(out);
}

std::string frames_csv_header() {
  return "frame,camera,captured_frame,capture_start_ns,capture_end_ns,remap_start_ns,remap_end_ns,"
         "display_start_ns,display_end_ns,dropped,repeated,remap_ns,latency_ns\n";
}

std::string frames_csv_line(const video::FrameTimes& r) {
  using Time = std::optional<Picoseconds>;
  const auto between = [](Time from, Time to) { return from && to ? Time(*to - *from) : Time(); };
  // As frame.latency counts them: a frame that is shown again has none.
  const Time latency = r.repeated || !r.captured ? Time() : between(r.capture_start, r.display_start);
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", r.index,
                     r.camera == video::kNoCamera ? "" : std::to_string(r.camera),
                     r.captured ? std::to_string(*r.captured) : "", cell(r.capture_start),
                     cell(r.capture_end), cell(r.remap_start), cell(r.remap_end),
                     cell(r.display_start), cell(r.display_end), r.dropped, r.repeated ? 1 : 0,
                     cell(between(r.remap_start, r.remap_end)), cell(latency));
}

std::string frames_csv(std::span<const video::FrameTimes> rows) {
  std::string out = frames_csv_header();
  for (const auto& r : rows) out += frames_csv_line(r);
  return out;
}

std::string timeline_csv_header(std::span<const std::string> masters) {
  std::string out = "start_ns,end_ns";
  for (const auto& m : masters)
    out += "," + csv_field(m + ".read_bytes") + "," + csv_field(m + ".write_bytes");
  return out + "\n";
}

std::string timeline_csv_line(const TimelineRow& r, std::size_t masters) {
  FOVEA_CHECK(r.read_bytes.size() == masters && r.write_bytes.size() == masters,
              "timeline row and header differ in the number of masters");
  std::string out = ns_text(r.start) + "," + ns_text(r.end);
  for (std::size_t m = 0; m < masters; ++m)
    out += fmt::format(",{},{}", r.read_bytes[m], r.write_bytes[m]);
  return out + "\n";
}

std::string timeline_csv(std::span<const std::string> masters, std::span<const TimelineRow> rows) {
  std::string out = timeline_csv_header(masters);
  for (const auto& r : rows) out += timeline_csv_line(r, masters.size());
  return out;
}

std::string stalls_csv(std::span<const StallRow> rows) {
  std::string out = "cause,region,culprit,cycles\n";
  for (const auto& r : rows)
    out += fmt::format("{},{},{},{}\n", csv_field(r.cause), csv_field(r.region),
                       csv_field(r.culprit), r.cycles);
  return out;
}

std::string latency_csv(std::span<const LatencyRow> rows) {
  std::string out = "master,direction,beat,low_ns,high_ns,count\n";
  for (const auto& r : rows)
    out += fmt::format("{},{},{},{},{},{}\n", csv_field(r.master), r.direction, r.beat, ns_text(r.low),
                       ns_text(r.high), r.count);
  return out;
}

std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, ",");
  return digits;
}

std::string human_text(const StatBase::Value& value, std::string_view unit) {
  const bool whole = std::holds_alternative<std::uint64_t>(value);
  const double v =
      whole ? static_cast<double>(std::get<std::uint64_t>(value)) : std::get<double>(value);
  if (!std::isfinite(v)) return "-";
  struct Prefix {
    double scale;
    const char* text;
  };
  static constexpr std::array<Prefix, 7> kPrefixes{
      {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}}};
  const bool seconds = unit == "s", bytes = unit == "B" || unit == "bytes", watts = unit == "W";
  if (v != 0 && (seconds || bytes || watts)) {
    for (const auto& p : kPrefixes) {
      if (std::abs(v) < p.scale && &p != &kPrefixes.back()) continue;
      if ((seconds && p.scale > 1) || (bytes && p.scale < 1)) continue;
      return fmt::format("{:.4g} {}{}", v / p.scale, p.text, bytes ? "B" : unit);
    }
  }
  if (unit == "x") return fmt::format("{:.2f}x real time", v);
  if (unit == "ratio") return fmt::format("{:.1f} %", 100 * v);
  if (unit == "1/s") return fmt::format("{:.5g} a second", v);
  const std::string number =
      whole ? grouped(std::get<std::uint64_t>(value)) : fmt::format("{:.5g}", v);
  // Units such as "count" and "frames" are already in the name.
  return unit.empty() || unit == "count" || unit == "1" ? number
                                                        : fmt::format("{} {}", number, unit);
}

std::string verdict(std::span<const StatRow> stats) {
  const auto count = [&](const char* name) { return count_of(stats, name); };
  const StatRow* rate = find(stats, names::kRate);
  const std::uint64_t displayed = count(names::kDisplayed), repeated = count(names::kRepeated);
  if (displayed == 0 || !rate || !find(stats, names::kRepeated)) return "";
  const std::uint64_t fresh = displayed - std::min(repeated, displayed);
  const std::uint64_t dropped = count(names::kDropped);
  const auto some = [](std::uint64_t n) { return n ? std::to_string(n) : std::string("none"); };
  // The camera sends one frame for each displayed frame.
  const StatRow* remap_rate = find(stats, names::kRemapRate);
  std::string out;
  if (remap_rate && remaps_in_a_row(stats))
    out = fmt::format("remaps in a row: {:.4g} a second; ", std::get<double>(remap_rate->value));
  // Several cameras share the display: a repeated frame is no fault then.
  if (find(stats, "camera.1.frame.displayed"))
    out += fmt::format("several cameras in turn: {} new frames in {} displayed ones ({:.4g} a second), {} dropped",
                       fresh, displayed, std::get<double>(rate->value), some(dropped));
  else
    out += fmt::format("{}: {} of {} frames shown ({:.4g} a second), {} dropped, {} repeated",
                       repeated || dropped ? "frame rate missed" : "frame rate met", fresh, displayed,
                       std::get<double>(rate->value), some(dropped), some(repeated));
  for (const auto& [name, what] : {std::pair(names::kCaptureOverflows, "capture overflow"),
                                   std::pair(names::kDisplayUnderflows, "display underflow")})
    if (const std::uint64_t n = count(name))
      out += fmt::format(", {} {}{}", n, what, n > 1 ? "s" : "");
  return out + "\n";
}

}  // namespace fovea::app
