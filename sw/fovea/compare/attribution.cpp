#include "sw/fovea/compare/attribution.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <tuple>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/table_file.h"

namespace fovea::regression {
namespace {

using results::TableFile;
using results::table_row;

namespace fs = std::filesystem;

const std::vector<std::string> kProfileColumns = {"phase",  "function", "file",    "line",
                                                  "cause",  "region",   "culprit", "clocks",
                                                  "instructions"};
const std::vector<std::string> kPlaceColumns = {"function", "file", "address", "size", "code"};
const std::vector<std::string> kPathColumns = {"phase", "path", "clocks"};
const std::vector<std::string> kObjectColumns = {"object", "address", "size"};
constexpr double kAllowedGap = 0.01;

double sum_of(const std::vector<AttributionRow>& rows) {
  double sum = 0;
  for (const auto& r : rows) sum += static_cast<double>(r.clocks);
  return sum;
}

/// The name in the source: without `.part.0`, `.constprop.1` or ` [clone .isra.0]`.
std::string source_name(std::string name) {
  if (const auto clone = name.find(" [clone "); clone != name.npos) name.resize(clone);
  for (const char* const mark : {".part.", ".constprop.", ".isra.", ".cold", ".lto_priv."})
    if (const auto at = name.find(mark); at != name.npos && at > 0) name.resize(at);
  return name;
}

/// The place of the sources differs between hosts, so that folders only count where they tell functions apart.
class FunctionKeys {
 public:
  void note(const std::string& function, const std::string& file) {
    const fs::path path(file);
    paths_[{source_name(function), path.filename().string()}].insert(path.string());
  }
  FunctionKey key(const std::string& function, const std::string& file) const {
    FunctionKey out{source_name(function), fs::path(file).filename().string()};
    const auto found = paths_.find(out);
    if (found != paths_.end() && found->second.size() > 1) out.second = file;
    return out;
  }
  /// Of "a|a.c;b|b.c".
  std::vector<FunctionKey> path(const std::string& text) const {
    std::vector<FunctionKey> out;
    for (std::size_t from = 0; from < text.size();) {
      const std::size_t end = std::min(text.find(';', from), text.size());
      const std::string item = text.substr(from, end - from);
      const std::size_t bar = std::min(item.rfind('|'), item.size());
      out.push_back(key(item.substr(0, bar), bar < item.size() ? item.substr(bar + 1) : ""));
      from = end + 1;
    }
    return out;
  }

 private:
  std::map<FunctionKey, std::set<std::string>> paths_;
};

std::vector<AttributionRow> read_profile(const TableFile& table, const FunctionKeys& keys) {
  std::vector<AttributionRow> rows;
  const bool more = table.has("inlined_in") && table.has("polls");
  for (std::size_t i = 0; i < table.rows(); ++i) {
    AttributionRow r;
    r.phase = table.text(i, "phase");
    std::tie(r.function, r.file) = keys.key(table.text(i, "function"), table.text(i, "file"));
    r.line = static_cast<unsigned>(table.count(i, "line"));
    r.cause = table.text(i, "cause");
    r.region = table.text(i, "region");
    r.culprit = table.text(i, "culprit");
    r.clocks = table.count(i, "clocks");
    r.instructions = table.count(i, "instructions");
    if (more) {
      r.holders = keys.path(table.text(i, "inlined_in"));
      r.polls = table.count(i, "polls") != 0;
    }
    rows.push_back(std::move(r));
  }
  return rows;
}

std::map<FunctionKey, std::set<CodePlace>> read_places(const fs::path& file, const FunctionKeys& keys) {
  const TableFile table(file, kPlaceColumns);
  std::map<FunctionKey, std::set<CodePlace>> places;
  for (std::size_t i = 0; i < table.rows(); ++i)
    places[keys.key(table.text(i, "function"), table.text(i, "file"))].insert(
        {table.text(i, "address"), table.text(i, "size"), table.text(i, "code")});
  return places;
}

std::vector<CallPath> read_paths(const fs::path& file, const FunctionKeys& keys) {
  const TableFile table(file, kPathColumns);
  std::vector<CallPath> out;
  for (std::size_t i = 0; i < table.rows(); ++i)
    out.push_back({table.text(i, "phase"), keys.path(table.text(i, "path")), table.count(i, "clocks")});
  return out;
}

std::vector<ObjectPlace> read_objects(const fs::path& file) {
  const TableFile table(file, kObjectColumns);
  std::vector<ObjectPlace> out;
  for (std::size_t i = 0; i < table.rows(); ++i)
    out.push_back({table.text(i, "object"),
                   results::hexadecimal(table.place(i), table.text(i, "address")),
                   table.count(i, "size")});
  return out;
}

std::vector<AttributionRow> read_stalls(const RunFigures& run) {
  const TableFile table(run.folder / "stalls.csv", {"cause", "region", "culprit", "cycles"});
  std::vector<AttributionRow> rows;
  const auto add = [&](std::string cause, std::string region, std::string culprit,
                       std::uint64_t clocks) {
    AttributionRow r;
    r.cause = std::move(cause);
    r.region = std::move(region);
    r.culprit = std::move(culprit);
    r.clocks = clocks;
    if (clocks) rows.push_back(std::move(r));
  };
  for (std::size_t i = 0; i < table.rows(); ++i)
    add(table.text(i, "cause"), table.text(i, "region"), table.text(i, "culprit"),
        table.count(i, "cycles"));
  add("issue", "", "", static_cast<std::uint64_t>(run.value(names::kCpuIssue)));
  // Split by the event that ended the idle time, where the run tells; the sleeps within remaps are waits.
  double rest = run.value(names::kCpuIdle);
  for (const auto& [name, m] : run.metrics)
    if (name.starts_with("cpu.idle.") && m.whole) {
      const std::string event = name.substr(std::string_view("cpu.idle.").size());
      const double within = run.value("cpu.remap.idle." + event), outside = std::max(0.0, *m.value - within);
      add("idle." + event, "", "", static_cast<std::uint64_t>(outside));
      add("wait." + event, "", "", static_cast<std::uint64_t>(within));
      rest -= outside + within;
    }
  add("idle", "", "", static_cast<std::uint64_t>(std::max(0.0, rest)));
  return rows;
}

/// The waits within remaps become one cause: the interrupts in their midst say nothing about them.
void join_waits(std::vector<AttributionRow>& rows) {
  std::map<std::string, double> events;
  for (const AttributionRow& r : rows) events[r.cause] += static_cast<double>(r.clocks);
  const std::string_view event = app::waited_for(events["wait.dma"], events["wait.engine"]);
  for (AttributionRow& r : rows)
    if (r.cause.starts_with("wait.")) r.cause = event.empty() ? "wait" : "wait." + std::string(event);
}

bool in_window(const AttributionRow& r) { return r.phase == kFramesPhase || r.phase == kRemapPhase; }

/// A profile may also hold what came before the window.
void divide(Attribution& out) {
  if (sum_of(out.rows) == out.clocks) return;
  std::vector<AttributionRow> window, before;
  for (const AttributionRow& r : out.rows) (in_window(r) ? window : before).push_back(r);
  if (window.empty() || std::abs(sum_of(window) - out.clocks) >= std::abs(sum_of(out.rows) - out.clocks)) return;
  out.rows = std::move(window);
  out.startup = std::move(before);
}

/// The time within remaps, by that of one.
double remaps_of(const RunFigures& run, const Attribution& a) {
  const double one = run.value(names::kRemapTimeMean);
  double clocks = 0;
  for (const AttributionRow& r : a.rows)
    if (r.phase == kRemapPhase) clocks += static_cast<double>(r.clocks);
  return one > 0 && clocks > 0 && a.seconds > 0 ? clocks * a.seconds / one : run.value(names::kRemapped);
}

void read_profile_files(const RunFigures& run, Attribution& out) {
  std::error_code error;
  const fs::path places = run.folder / "functions.csv", paths = run.folder / "paths.csv",
                 objects = run.folder / "objects.csv";
  const TableFile profile(run.folder / "profile.csv", kProfileColumns);
  FunctionKeys keys;
  for (std::size_t i = 0; i < profile.rows(); ++i) keys.note(profile.text(i, "function"), profile.text(i, "file"));
  out.rows = read_profile(profile, keys);
  divide(out);
  out.by_function = std::any_of(out.rows.begin(), out.rows.end(),
                                [](const AttributionRow& r) { return !r.function.empty(); });
  if (fs::exists(places, error)) out.places = read_places(places, keys);
  if (fs::exists(paths, error)) out.paths = read_paths(paths, keys);
  if (fs::exists(objects, error)) out.objects = read_objects(objects);
}

std::string joined_path(const std::vector<FunctionKey>& path) {
  std::string out;
  for (const FunctionKey& f : path) out += (out.empty() ? "" : ";") + f.first + "|" + f.second;
  return out;
}

/// Joins small rows of what came before the window, see kDetail.
std::vector<AttributionRow> without_detail(const std::vector<AttributionRow>& rows) {
  std::map<std::string, double> phases;
  for (const AttributionRow& r : rows) phases[r.phase] += static_cast<double>(r.clocks);
  using Key = std::tuple<std::string, FunctionKey, std::string, std::vector<FunctionKey>, bool>;
  std::map<Key, AttributionRow> joined;
  std::vector<AttributionRow> out;
  for (const AttributionRow& r : rows) {
    if (static_cast<double>(r.clocks) >= kDetail * phases[r.phase]) {
      out.push_back(r);
      continue;
    }
    AttributionRow& to = joined[{r.phase, r.key(), r.cause, r.holders, r.polls}];
    const std::uint64_t clocks = to.clocks + r.clocks, instructions = to.instructions + r.instructions;
    to = r;
    to.line = 0;
    to.region = to.culprit = "";
    to.clocks = clocks;
    to.instructions = instructions;
  }
  for (auto& [key, r] : joined) out.push_back(std::move(r));
  return out;
}

}  // namespace

double Attribution::sum() const { return sum_of(rows); }

bool has_profile(const RunFigures& run) {
  std::error_code error;
  return fs::exists(run.folder / "profile.csv", error);
}

Attribution attribution_of(const RunFigures& run, bool profile) {
  Attribution out;
  std::error_code error;
  out.clocks = run.value(names::kCpuCycles);
  if (const double window = run.value(names::kWindow); window > 0 && out.clocks > 0)
    out.seconds = window / out.clocks;
  const char* file = "profile.csv";
  if (profile && has_profile(run)) {
    read_profile_files(run, out);
  } else if (file = "stalls.csv"; fs::exists(run.folder / file, error)) {
    out.rows = read_stalls(run);
  }
  out.remaps = remaps_of(run, out);
  join_waits(out.rows);
  if (!out.rows.empty() && std::abs(out.sum() - out.clocks) > kAllowedGap * out.clocks)
    throw UserError(fmt::format("'{}' does not belong to stats.json: its rows have {:.0f} clocks, "
                                "cpu.cycles is {:.0f}",
                                app::one_line((run.folder / file).string()), out.sum(),
                                out.clocks));
  return out;
}

std::string attribution_csv(const Attribution& attribution) {
  std::vector<std::string> columns = kProfileColumns;
  columns.insert(columns.end(), {"inlined_in", "polls"});
  std::string out = table_row(columns);
  const auto add = [&out](const std::vector<AttributionRow>& rows) {
    for (const auto& r : rows)
      out += table_row({r.phase, r.function, r.file, r.line ? std::to_string(r.line) : "", r.cause, r.region,
                        r.culprit, std::to_string(r.clocks), std::to_string(r.instructions), joined_path(r.holders),
                        r.polls ? "1" : ""});
  };
  add(without_detail(attribution.startup));
  add(attribution.rows);
  return out;
}

std::string paths_csv(const Attribution& attribution) {
  std::map<std::string, double> phases;
  for (const CallPath& p : attribution.paths) phases[p.phase] += static_cast<double>(p.clocks);
  std::map<std::pair<std::string, std::string>, std::uint64_t> sums;
  for (const CallPath& p : attribution.paths)
    if (static_cast<double>(p.clocks) >= kDetail * phases[p.phase] || p.functions.empty())
      sums[{p.phase, joined_path(p.functions)}] += p.clocks;
    else
      sums[{p.phase, joined_path({p.functions.back()})}] += p.clocks;
  std::string out = table_row(kPathColumns);
  for (const auto& [path, clocks] : sums) out += table_row({path.first, path.second, std::to_string(clocks)});
  return out;
}

std::string objects_csv(const Attribution& attribution) {
  std::string out = table_row(kObjectColumns);
  for (const ObjectPlace& o : attribution.objects)
    out += table_row({o.name, fmt::format("0x{:08x}", o.address), std::to_string(o.size)});
  return out;
}

std::string places_csv(const Attribution& attribution) {
  std::string out = table_row(kPlaceColumns);
  for (const auto& [function, places] : attribution.places)
    for (const CodePlace& p : places)
      out += table_row({function.first, function.second, p.address, p.size, p.code});
  return out;
}

}  // namespace fovea::regression
