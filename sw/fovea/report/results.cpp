#include "sw/fovea/report/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/results/csv.h"
#include "sw/fovea/results/provenance.h"

namespace fovea::report {
namespace {

namespace fs = std::filesystem;
using results::CsvPlace;
using results::hexadecimal;
using results::number;
using results::time_ps;
using results::whole;

constexpr std::size_t kMaxStacksBytes = 64u << 20;

bool is_there(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

/// Those that have a value.
std::vector<app::StatRow> with_values(std::vector<results::Figure> figures) {
  std::vector<app::StatRow> rows;
  for (results::Figure& f : figures)
    if (f.value) rows.push_back({std::move(f.name), *f.value, std::move(f.unit), std::move(f.description)});
  return rows;
}

std::vector<video::FrameTimes> read_frames(const fs::path& file) {
  // What follows is computed from these.
  static constexpr std::array<std::string_view, 11> kColumns{
      "frame",          "camera",         "captured_frame", "capture_start_ns",
      "capture_end_ns", "remap_start_ns", "remap_end_ns",   "display_start_ns",
      "display_end_ns", "dropped",        "repeated"};
  std::vector<video::FrameTimes> rows;
  results::each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
    video::FrameTimes row;
    row.index = whole(at, f[0]);
    if (!f[1].empty()) row.camera = static_cast<unsigned>(whole(at, f[1]));
    if (!f[2].empty()) row.captured = whole(at, f[2]);
    row.capture_start = time_ps(at, f[3]);
    row.capture_end = time_ps(at, f[4]);
    row.remap_start = time_ps(at, f[5]);
    row.remap_end = time_ps(at, f[6]);
    if (f[7].empty() || f[8].empty())
      throw UserError(fmt::format("{}:{}: a displayed frame without the times of its display",
                                  app::one_line(at.file.string()), at.line));
    row.display_start = *time_ps(at, f[7]);
    row.display_end = *time_ps(at, f[8]);
    row.dropped = whole(at, f[9]);
    row.repeated = whole(at, f[10]) != 0;
    rows.push_back(row);
  }, results::kMaxRowsBytes);
  return rows;
}

/// Beside the times, pairs of columns with the bytes read and written of a master.
Timeline read_timeline(const fs::path& file) {
  static constexpr std::array<std::string_view, 2> kColumns{"start_ns", "end_ns"};
  static constexpr std::string_view kRead = ".read_bytes", kWritten = ".write_bytes";
  Timeline out;
  std::vector<std::pair<std::size_t, std::size_t>> places;
  const auto add_masters = [&](std::span<const std::string> others) {
    for (std::size_t i = 0; i < others.size(); ++i) {
      if (!others[i].ends_with(kRead)) continue;
      const std::string master = others[i].substr(0, others[i].size() - kRead.size());
      const auto written = std::find(others.begin(), others.end(), master + std::string(kWritten));
      if (written == others.end())
        throw UserError(fmt::format("{}:1: there is no column '{}{}' beside '{}'", app::one_line(file.string()),
                                    app::one_line(master, 60), kWritten, app::one_line(others[i], 60)));
      out.masters.push_back(master);
      places.emplace_back(kColumns.size() + i, kColumns.size() + static_cast<std::size_t>(written - others.begin()));
    }
  };
  const auto add_row = [&](const CsvPlace& at, std::span<const std::string> f) {
    app::TimelineRow row;
    row.start = time_ps(at, f[0]).value_or(0);
    row.end = time_ps(at, f[1]).value_or(0);
    for (const auto& [read, written] : places) {
      row.read_bytes.push_back(whole(at, f[read]));
      row.write_bytes.push_back(whole(at, f[written]));
    }
    out.rows.push_back(std::move(row));
  };
  results::each_csv_row(file, kColumns, add_row, results::kMaxRowsBytes, add_masters);
  return out;
}

std::vector<app::StallRow> read_stalls(const fs::path& file) {
  static constexpr std::array<std::string_view, 4> kColumns{"cause", "region", "culprit", "cycles"};
  std::vector<app::StallRow> rows;
  results::each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
    rows.push_back({f[0], f[1], f[2], whole(at, f[3])});
  });
  return rows;
}

std::vector<LatencyBin> read_latency(const fs::path& file) {
  static constexpr std::array<std::string_view, 6> kColumns{"master", "direction", "beat",
                                                            "low_ns", "high_ns",   "count"};
  std::vector<LatencyBin> rows;
  results::each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
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
  results::each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
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
  results::each_csv_row(file, kColumns, [&](const CsvPlace& at, std::span<const std::string> f) {
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
  results::StoredRun stored = results::read_stored_run(
      folder, options.partial, "complete results, or --partial for a report of what there is");
  const std::string own = app::program_provenance().version;
  if (stored.version != own && !options.across_versions)
    throw UserError(
        fmt::format("'{}': it was written by version {} of Fovea, and this is {}; "
                    "--across-versions reads it nevertheless",
                    app::one_line(folder.string()), app::one_line(stored.version, 40), own));
  Results out;
  out.folder = folder;
  std::error_code error;
  fs::path name = fs::weakly_canonical(folder, error);
  if (!name.has_filename()) name = name.parent_path();
  out.name = name.filename().string();
  out.version = std::move(stored.version);
  out.commit = std::move(stored.commit);
  out.modified = stored.modified;
  out.experiment = std::move(stored.experiment);
  out.hashes = std::move(stored.hashes);
  out.parameters = std::move(stored.parameters);
  out.complete = stored.complete;
  out.ended_by = std::move(stored.ended_by);
  out.kernel = std::move(stored.kernel);
  out.stats = with_values(std::move(stored.figures));
  out.warnings = std::move(stored.warnings);
  out.host = with_values(std::move(stored.host));
  out.arguments = std::move(stored.command_line);
  out.command = out.arguments.empty() ? "" : out.arguments.front();
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
