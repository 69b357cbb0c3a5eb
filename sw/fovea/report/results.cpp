#include "sw/fovea/report/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"
#include "sw/fovea/safe_json.h"
#include "sw/fovea/provenance.h"
#include "sw/fovea/report/csv.h"
#include "sw/fovea/run_files.h"

namespace fovea::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxStacksBytes = 64u << 20;
/// Figures and parameters that a run may have; the page looks for names one by one. A run on the board has about 700.
constexpr std::size_t kMaxNames = 5000;

std::string quoted(const fs::path& path) { return "'" + app::one_line(path.string()) + "'"; }

bool is_there(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

nlohmann::json read_object(const fs::path& file) {
  nlohmann::json value = app::read_json(file);
  if (!value.is_object()) throw UserError(quoted(file) + ": not a file of JSON; it is damaged");
  if (const std::size_t names = std::max(value.size(), app::json_member(value, "params").size()); names > kMaxNames)
    throw UserError(
        fmt::format("{}: it has {} figures or parameters; allowed: up to {}", quoted(file), names, kMaxNames));
  return value;
}

/// A member as text; empty if it is missing or null.
std::string text(const nlohmann::json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || found->is_null()) return "";
  return found->is_string() ? found->get<std::string>() : found->dump();
}

bool flag(const nlohmann::json& object, const char* name, bool otherwise) {
  const auto found = object.find(name);
  return found != object.end() && found->is_boolean() ? found->get<bool>() : otherwise;
}

/// Members of the form {"value": number, "unit": text, "description": text}; null ones are left
/// out.
std::vector<app::StatRow> read_figures(const nlohmann::json& object) {
  std::vector<app::StatRow> rows;
  for (const auto& [name, member] : object.items()) {
    if (!member.is_object() || !member.contains("value") || !member["value"].is_number()) continue;
    const nlohmann::json& v = member["value"];
    rows.push_back({name,
                    v.is_number_unsigned() ? StatBase::Value(v.get<std::uint64_t>())
                                           : StatBase::Value(v.get<double>()),
                    text(member, "unit"), text(member, "description")});
  }
  return rows;
}

void read_config(Results& out, const fs::path& file) {
  const nlohmann::json config = read_object(file);
  out.version = text(config, "version");
  out.commit = text(config, "commit");
  out.modified = flag(config, "modified", false);
  out.experiment = text(config, "experiment");
  if (config.contains("sha256"))
    for (const auto& [key, hash] : config["sha256"].items())
      out.hashes.emplace_back(key, hash.is_string() ? hash.get<std::string>() : "");
  if (!config.contains("params") || !config["params"].is_object())
    throw UserError(quoted(file) + ": it has no parameters; it is damaged");
  for (const auto& [key, p] : config["params"].items()) {
    Parameter row{key,
                  text(p, "value"),
                  text(p, "origin"),
                  text(p, "default"),
                  text(p, "tag"),
                  text(p, "source"),
                  "",
                  text(p, "description")};
    if (p.contains("belief") && p["belief"].is_object())
      row.belief = text(p["belief"], "low") + " .. " + text(p["belief"], "high");
    out.parameters.push_back(std::move(row));
  }
}

void read_stats(Results& out, const fs::path& file) {
  const nlohmann::json stats = read_object(file);
  out.complete = flag(stats, "complete", true);
  out.ended_by = text(stats, "ended_by");
  out.kernel = text(stats, "kernel");
  out.stats = read_figures(stats);
  if (const auto list = stats.find("warnings"); list != stats.end() && list->is_array())
    for (const nlohmann::json& w : *list) {
      if (!w.is_object()) throw UserError(quoted(file) + ": a warning is not an object; it is damaged");
      out.warnings.push_back(
          {text(w, "kind"), text(w, "what"),
           w.value("count", nlohmann::json(0)).is_number_unsigned() ? w["count"].get<std::uint64_t>() : 0});
    }
}

void read_host(Results& out, const fs::path& file) {
  const nlohmann::json host = read_object(file);
  out.host = read_figures(host);
  if (const auto list = host.find("command"); list != host.end() && list->is_array())
    for (const nlohmann::json& word : *list)
      out.arguments.push_back(word.is_string() ? word.get<std::string>() : "");
  out.command = out.arguments.empty() ? "" : out.arguments.front();
}

std::vector<app::FrameRow> read_frames(const fs::path& file) {
  // What follows is computed from these.
  static constexpr std::array<std::string_view, 11> kColumns{
      "frame",          "camera",         "captured_frame", "capture_start_ns",
      "capture_end_ns", "remap_start_ns", "remap_end_ns",   "display_start_ns",
      "display_end_ns", "dropped",        "repeated"};
  std::vector<app::FrameRow> rows;
  each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
    if (at.line == 1) return;
    app::FrameRow row;
    row.index = whole(at, f[0]);
    row.camera = static_cast<unsigned>(whole(at, f[1]));
    if (!f[2].empty()) row.captured = whole(at, f[2]);
    row.capture_start = time_ps(at, f[3]);
    row.capture_end = time_ps(at, f[4]);
    row.remap_start = time_ps(at, f[5]);
    row.remap_end = time_ps(at, f[6]);
    row.display_start = time_ps(at, f[7]);
    row.display_end = time_ps(at, f[8]);
    row.dropped = whole(at, f[9]);
    row.repeated = whole(at, f[10]) != 0;
    rows.push_back(row);
  }, kMaxRowsBytes);
  return rows;
}

Timeline read_timeline(const fs::path& file) {
  static constexpr std::array<std::string_view, 2> kColumns{"start_ns", "end_ns"};
  Timeline out;
  each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
    if (at.line == 1) {
      const std::string_view suffix = ".read_bytes";
      for (std::size_t i = 2; i + 1 < f.size(); i += 2) {
        if (!f[i].ends_with(suffix) || !f[i + 1].ends_with(".write_bytes"))
          throw UserError(
              fmt::format("{}:1: columns {} and {} are not the bytes read and written of a master",
                          app::one_line(file.string()), i + 1, i + 2));
        out.masters.push_back(f[i].substr(0, f[i].size() - suffix.size()));
      }
      return;
    }
    app::TimelineRow row;
    row.start = time_ps(at, f[0]).value_or(0);
    row.end = time_ps(at, f[1]).value_or(0);
    for (std::size_t m = 0; m < out.masters.size(); ++m) {
      row.read_bytes.push_back(whole(at, f[2 + 2 * m]));
      row.write_bytes.push_back(whole(at, f[3 + 2 * m]));
    }
    out.rows.push_back(std::move(row));
  }, kMaxRowsBytes);
  return out;
}

std::vector<app::StallRow> read_stalls(const fs::path& file) {
  static constexpr std::array<std::string_view, 4> kColumns{"cause", "region", "culprit", "cycles"};
  std::vector<app::StallRow> rows;
  each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
    if (at.line > 1) rows.push_back({f[0], f[1], f[2], whole(at, f[3])});
  });
  return rows;
}

std::vector<LatencyBin> read_latency(const fs::path& file) {
  static constexpr std::array<std::string_view, 6> kColumns{"master", "direction", "beat",
                                                            "low_ns", "high_ns",   "count"};
  std::vector<LatencyBin> rows;
  each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
    if (at.line > 1)
      rows.push_back({f[0], f[1], f[2], number(at, f[3]), number(at, f[4]), whole(at, f[5])});
  });
  return rows;
}

/// Steps of one request follow one another.
std::vector<app::SlowestRow> read_slowest(const fs::path& file) {
  static constexpr std::array<std::string_view, 15> kColumns{
      "master", "direction", "port", "issued_ns", "latency_ns", "address",  "bytes",  "bank",
      "row",    "row_state", "step", "place",     "culprit",    "begin_ns", "time_ns"};
  std::vector<app::SlowestRow> rows;
  each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
    if (at.line == 1) return;
    if (rows.empty() || rows.back().master != f[0] || rows.back().direction != f[1]) {
      app::SlowestRow r{f[0], f[1], f[2], f[9], time_ps(at, f[3]).value_or(0), time_ps(at, f[4]).value_or(0), 0,
                        0,    0,    0,    {}};
      r.address = static_cast<std::uint32_t>(hexadecimal(at, f[5]));
      r.bytes = static_cast<unsigned>(whole(at, f[6]));
      r.bank = static_cast<unsigned>(whole(at, f[7]));
      r.row = static_cast<std::uint32_t>(whole(at, f[8]));
      rows.push_back(std::move(r));
    }
    const Picoseconds from = time_ps(at, f[13]).value_or(0);
    rows.back().steps.push_back({f[11], f[12], from, from + time_ps(at, f[14]).value_or(0)});
  });
  return rows;
}

/// What the firmware says of itself: the value behind `key`, up to a comma; empty if it says nothing.
std::string said(const std::string& log, std::string_view key) {
  const auto at = log.rfind(std::string("\n") + std::string(key));
  if (at == std::string::npos) return "";
  const auto from = at + 1 + key.size();
  return app::printable(log.substr(from, std::min(log.find_first_of(",\r\n", from), from + 60) - from));
}

std::vector<ProfileRow> read_profile(const fs::path& file) {
  static constexpr std::array<std::string_view, 9> kColumns{
      "phase", "function", "file", "line", "cause", "region", "culprit", "clocks", "instructions"};
  std::vector<ProfileRow> rows;
  each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
    if (at.line > 1)
      rows.push_back({f[0], f[1], f[2], f[3], f[4], f[5], f[6], whole(at, f[7]), whole(at, f[8])});
  });
  // Functions of one name in two files are two.
  std::map<std::string, std::set<std::string>> files;
  for (const ProfileRow& r : rows) files[r.function].insert(r.file);
  for (ProfileRow& r : rows)
    if (!r.file.empty() && files[r.function].size() > 1) r.function += " (" + r.file + ")";
  return rows;
}

/// Folded stacks: "outer;inner clocks" on each line.
std::vector<std::pair<std::string, std::uint64_t>> read_stacks(const fs::path& file) {
  const std::string content = app::read_file(file, kMaxStacksBytes);
  std::vector<std::pair<std::string, std::uint64_t>> out;
  CsvPlace at{file, 0};
  for (std::size_t from = 0; from < content.size();) {
    ++at.line;
    const std::size_t end = std::min(content.find('\n', from), content.size());
    const std::string line = content.substr(from, end - from);
    from = end + 1;
    if (line.empty()) continue;
    const auto space = line.rfind(' ');
    if (space == std::string::npos)
      throw UserError(fmt::format("{}:{}: no number of clocks behind the stack",
                                  app::one_line(file.string()), at.line));
    out.emplace_back(line.substr(0, space), whole(at, line.substr(space + 1)));
  }
  return out;
}

/// Why a folder cannot be read; the message of a UserError.
void check_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) throw UserError(quoted(folder) + ": there is no such folder");
  if (!fs::is_directory(folder, error)) throw UserError(quoted(folder) + ": it is not a folder");
  const fs::path config = folder / "config.json";
  std::string format;
  if (is_there(config)) {
    const nlohmann::json value = app::read_json(config);
    if (value.is_object()) format = text(value, "format");
  }
  if (format.empty())
    throw UserError(quoted(folder) +
                    ": it is not the folder of a Fovea run (it has no config.json of Fovea)");
  if (format != app::kRunFormat)
    throw UserError(fmt::format("{}: its format is '{}'; this version reads '{}' only",
                                quoted(folder), app::one_line(format, 60), app::kRunFormat));
  if (!is_there(folder / "stats.json"))
    throw UserError(quoted(folder) + ": the run in it was never finished (it has no stats.json)");
}

}  // namespace

std::optional<double> Results::value(std::string_view figure) const {
  const app::StatRow* row = app::find(stats, figure);
  if (!row) return std::nullopt;
  return std::visit([](auto v) { return static_cast<double>(v); }, row->value);
}

const Parameter* Results::parameter(std::string_view key) const {
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const Parameter& p) { return p.key == key; });
  return found == parameters.end() ? nullptr : &*found;
}

Results load_results(const fs::path& folder, const LoadOptions& options) {
  check_folder(folder);
  Results out;
  out.folder = folder;
  std::error_code error;
  fs::path name = fs::weakly_canonical(folder, error);
  if (!name.has_filename()) name = name.parent_path();
  out.name = name.filename().string();
  read_config(out, folder / "config.json");
  const std::string own = app::program_provenance().version;
  if (out.version != own && !options.across_versions)
    throw UserError(
        fmt::format("{}: it was written by version {} of Fovea, and this is {}; "
                    "--across-versions reads it nevertheless",
                    quoted(folder), app::one_line(out.version, 40), own));
  read_stats(out, folder / "stats.json");
  if (!out.complete && !options.partial)
    throw UserError(quoted(folder) +
                    ": its results are partial (the run was stopped, or the guest failed); "
                    "--partial makes a report of them");
  if (is_there(folder / "host.json")) read_host(out, folder / "host.json");
  if (is_there(folder / "frames.csv")) out.frames = read_frames(folder / "frames.csv");
  if (is_there(folder / "timeline.csv")) out.timeline = read_timeline(folder / "timeline.csv");
  if (is_there(folder / "stalls.csv")) out.stalls = read_stalls(folder / "stalls.csv");
  if (is_there(folder / "latency.csv")) out.latency = read_latency(folder / "latency.csv");
  if (is_there(folder / "slowest.csv")) out.slowest = read_slowest(folder / "slowest.csv");
  if (is_there(folder / "uart.log")) {
    const std::string log = app::read_file(folder / "uart.log", kMaxStacksBytes);
    out.picture = said(log, "picture ");
  }
  if (is_there(folder / "profile.csv")) out.profile = read_profile(folder / "profile.csv");
  if (is_there(folder / "profile.folded")) out.stacks = read_stacks(folder / "profile.folded");
  return out;
}

}  // namespace fovea::report
