#include "sw/fovea/regression/attribution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/checked_file.h"
#include "sw/fovea/regression/table_file.h"

namespace fovea::regression {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kProfileColumns = {"phase",  "function", "file",    "line",
                                                  "cause",  "region",   "culprit", "clocks",
                                                  "instructions"};
const std::vector<std::string> kPlaceColumns = {"function", "file", "address", "size", "code"};
/// The phase that the figures of a window cover.
constexpr std::string_view kWindowPhase = "frames";
constexpr double kAllowedGap = 0.01;

double sum_of(const std::vector<AttributionRow>& rows) {
  double sum = 0;
  for (const auto& r : rows) sum += static_cast<double>(r.clocks);
  return sum;
}

std::vector<AttributionRow> read_profile(const fs::path& file) {
  const TableFile table(file, kProfileColumns);
  std::vector<AttributionRow> rows;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    AttributionRow r;
    r.phase = table.text(i, "phase");
    r.function = table.text(i, "function");
    // The place of the sources differs between hosts.
    r.file = fs::path(table.text(i, "file")).filename().string();
    r.line = static_cast<unsigned>(table.count(i, "line"));
    r.cause = table.text(i, "cause");
    r.region = table.text(i, "region");
    r.culprit = table.text(i, "culprit");
    r.clocks = table.count(i, "clocks");
    r.instructions = table.count(i, "instructions");
    rows.push_back(std::move(r));
  }
  return rows;
}

std::map<FunctionKey, std::set<CodePlace>> read_places(const fs::path& file) {
  const TableFile table(file, kPlaceColumns);
  std::map<FunctionKey, std::set<CodePlace>> places;
  for (std::size_t i = 0; i < table.rows(); ++i)
    places[{table.text(i, "function"), fs::path(table.text(i, "file")).filename().string()}].insert(
        {table.text(i, "address"), table.text(i, "size"), table.text(i, "code")});
  return places;
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
  add("issue", "", "", static_cast<std::uint64_t>(run.value("cpu.issue")));
  // Split by the event that ended the idle time, where the run tells; the sleeps within remaps are waits.
  double rest = run.value("cpu.idle");
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

/// A profile may also hold what came before the window.
void keep_window(std::vector<AttributionRow>& rows, double cycles) {
  if (sum_of(rows) == cycles) return;
  std::vector<AttributionRow> window;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(window),
               [](const AttributionRow& r) { return r.phase == kWindowPhase; });
  if (!window.empty() && std::abs(sum_of(window) - cycles) < std::abs(sum_of(rows) - cycles))
    rows = std::move(window);
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
  out.clocks = run.value("cpu.cycles");
  if (const double window = run.value("frame.window"); window > 0 && out.clocks > 0)
    out.seconds = window / out.clocks;
  const char* file = "profile.csv";
  if (profile && has_profile(run)) {
    out.rows = read_profile(run.folder / file);
    keep_window(out.rows, out.clocks);
    out.by_function = std::any_of(out.rows.begin(), out.rows.end(),
                                  [](const AttributionRow& r) { return !r.function.empty(); });
    if (fs::exists(run.folder / "functions.csv", error))
      out.places = read_places(run.folder / "functions.csv");
  } else if (file = "stalls.csv"; fs::exists(run.folder / file, error)) {
    out.rows = read_stalls(run);
  }
  join_waits(out.rows);
  if (!out.rows.empty() && std::abs(out.sum() - out.clocks) > kAllowedGap * out.clocks)
    throw UserError(fmt::format("'{}' does not belong to stats.json: its rows have {:.0f} clocks, "
                                "cpu.cycles is {:.0f}",
                                app::one_line((run.folder / file).string()), out.sum(),
                                out.clocks));
  return out;
}

std::string attribution_csv(const Attribution& attribution) {
  std::string out = table_row(kProfileColumns);
  for (const auto& r : attribution.rows)
    out += table_row({r.phase, r.function, r.file, r.line ? std::to_string(r.line) : "", r.cause,
                      r.region, r.culprit, std::to_string(r.clocks),
                      std::to_string(r.instructions)});
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
