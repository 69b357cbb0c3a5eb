// Sections that consist of charts and the tables below them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "sw/fovea/explain/words.h"
#include "sw/fovea/report/chart_data.h"
#include "sw/fovea/report/html.h"
#include "sw/fovea/report/page.h"
#include "sw/fovea/report/sections.h"
#include "sw/fovea/results/names.h"

namespace fovea::report {
namespace {

/// Functions with less are left out of the table.
constexpr std::size_t kMaxFunctions = 40;

std::string percent_cell(double part, double all) {
  if (all <= 0) return "";
  const bool small = part > 0 && part < 0.001 * all;  // too many of them in a column for words
  return fmt::format("<data value=\"{}\">{}</data>", app::number_text(part / all),
                     small ? "&lt; 0.1 %" : explain::percent(part / all));
}

/// Clocks are whole numbers far below 2^53.
std::string clocks_text(double clocks) {
  return app::grouped(static_cast<std::uint64_t>(std::llround(std::abs(clocks))));
}

std::string clocks_cell(double clocks) {
  return fmt::format("<data value=\"{:.0f}\">{}</data>", clocks, clocks_text(clocks));
}

/// Masters of `prefix`MASTER`suffix` figures that have a value, in the order of the figures.
std::vector<std::string> masters_of(const Results& run, std::string_view prefix,
                                    std::string_view suffix) {
  std::vector<std::string> out;
  for (const auto& s : run.stats)
    if (s.name.starts_with(prefix) && s.name.ends_with(suffix) &&
        s.name.size() > prefix.size() + suffix.size())
      out.push_back(s.name.substr(prefix.size(), s.name.size() - prefix.size() - suffix.size()));
  return out;
}

std::string rate_cell(double bytes, double seconds) {
  return seconds > 0 ? fmt::format("<data value=\"{}\">{:.1f}</data>",
                                   app::number_text(bytes / seconds), bytes / seconds * 1e-6)
                     : "";
}

std::string bandwidth_table(const Results& run) {
  const auto window = run.value(names::kWindow);
  Table table("Bytes of each master in the measured window",
              {"Master", "#Read", "#Written", "#MB/s read", "#MB/s written", "#Requests"});
  for (const auto& m : masters_of(run, "bus.", ".transactions")) {
    if (run.value("bus." + m + ".transactions") == 0.0) continue;
    const auto read = run.value("bus." + m + ".read_bytes").value_or(0),
               written = run.value("bus." + m + ".write_bytes").value_or(0);
    table.row({escaped(m), figure_cell(app::find(run.stats, "bus." + m + ".read_bytes")),
               figure_cell(app::find(run.stats, "bus." + m + ".write_bytes")),
               rate_cell(read, window.value_or(0)), rate_cell(written, window.value_or(0)),
               figure_cell(app::find(run.stats, "bus." + m + ".transactions"))});
  }
  return table.empty() ? "" : table.html();
}

/// What the figures `ddr.MASTER.latency.<prefix>mean` and their like measure.
struct LatencyKind {
  std::string_view prefix, requests, beat;
};
constexpr std::array kLatencyKinds{
    LatencyKind{"", "reads", "first"}, LatencyKind{"read_last.", "reads", "last"},
    LatencyKind{"write_first.", "writes", "first"}, LatencyKind{"write_last.", "writes", "last"}};

std::string latency_table(const Results& run) {
  Table table(
      "Latency at the SDRAM, from the request on the master's port",
      {"Master", "Requests", "To their beat", "#Mean", "#Median", "#95 %", "#99 %", "#Largest"});
  for (const auto& kind : kLatencyKinds)
    for (const auto& m : masters_of(run, "ddr.", fmt::format(".latency.{}mean", kind.prefix))) {
      std::vector<std::string> cells{escaped(m), std::string(kind.requests),
                                     std::string(kind.beat)};
      for (const auto* which : {"mean", "p50", "p95", "p99", "max"})
        cells.push_back(figure_cell(
            app::find(run.stats, fmt::format("ddr.{}.latency.{}{}", m, kind.prefix, which))));
      table.row(cells);
    }
  return table.empty() ? "" : table.html();
}

/// "port bridge 24.7, crossbar vpbe 107.0 (3 times), ...": in the order of time, where that is short enough to be
/// read; else the sums by what they were spent on.
std::string steps_text(const app::SlowestRow& row) {
  struct Stretch {
    std::string what;
    Picoseconds time;
    unsigned times;
  };
  constexpr std::size_t kReadable = 12;
  std::vector<Stretch> stretches;
  for (const auto& s : row.steps) {
    const std::string what = s.place + " " + s.culprit;
    if (stretches.empty() || stretches.back().what != what) stretches.push_back({what, 0, 0});
    stretches.back().time += s.to - s.from;
    ++stretches.back().times;
  }
  const auto ns = [](Picoseconds t) { return static_cast<double>(t) * 1e-3; };
  std::vector<std::string> out;
  if (stretches.size() <= kReadable)
    for (const auto& s : stretches)
      out.push_back(
          fmt::format("{} {:.1f}{}", s.what, ns(s.time), s.times > 1 ? fmt::format(" ({} times)", s.times) : ""));
  else
    for (const auto& [culprit, time] : app::slowest_parts(row))
      out.push_back(fmt::format("{} {:.1f}", culprit, ns(time)));
  return fmt::format(
      "{}{}", fmt::join(out, ", "),
      stretches.size() <= kReadable ? std::string() : fmt::format("; {} steps in slowest.csv", row.steps.size()));
}

std::string slowest_table(const Results& run) {
  Table table(
      "The slowest request of each master and direction: reads to their first beat, writes to their acknowledgement",
      {"Master", "Requests", "#us", "#At (ms since power-up)", "Row", "Address", "Where, for whom, and how many ns"});
  for (const auto& r : *run.slowest)
    table.row({escaped(r.master), escaped(r.direction),
               fmt::format("<data value=\"{}\">{:.3f}</data>", app::number_text(static_cast<double>(r.latency) * 1e-12),
                           static_cast<double>(r.latency) * 1e-6),
               fmt::format("{}.{:06}", r.issued / kPsPerMs, r.issued % kPsPerMs / kPsPerNs), escaped(r.row_state),
               fmt::format("<code>0x{:08x}</code>", r.address), escaped(steps_text(r))});
  if (table.empty()) return absent("No master made a request to the SDRAM.");
  const auto each = app::slowest_of_each(*run.slowest);
  const std::string command = around_command_of(run, each.front());
  return table.html() + (command.empty() ? ""
                                         : fmt::format("<p class=\"note\">The requests around the slowest one, seen "
                                                       "again: <code>{}</code> writes them to requests.csv.</p>",
                                                       escaped(command)));
}

std::string stalls_table(const Results& run) {
  auto rows = *run.stalls;
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.cycles > b.cycles; });
  constexpr std::size_t kShown = 40;
  Table table(rows.size() > kShown
                  ? fmt::format("The {} largest of {} waits of the core", kShown, rows.size())
                  : "Waits of the core",
              {"Waits for", "Cause", "Data", "Culprit", "#Clocks", "#Of all clocks"});
  rows.resize(std::min(rows.size(), kShown));
  for (const auto& r : rows)
    table.row({escaped(explain::waits_for(r.cause)), escaped(r.cause), escaped(r.region),
               escaped(r.culprit), clocks_cell(static_cast<double>(r.cycles)),
               percent_cell(static_cast<double>(r.cycles), run.value(names::kCpuCycles).value_or(0))});
  return table.html();
}

/// Where a function begins: the first place that the profile names.
std::map<std::string, std::string> places_of(const Results& run) {
  std::map<std::string, std::string> out;
  if (run.profile)
    for (const auto& r : *run.profile)
      if (!r.file.empty()) out.emplace(r.function, r.line.empty() ? r.file : r.file + ":" + r.line);
  return out;
}

double clocks_for(const explain::FunctionClocks* f, const char* cause) {
  if (!f) return 0;
  const auto found = f->causes.find(cause);
  return found == f->causes.end() ? 0 : found->second;
}

std::string largest_wait(const explain::FunctionClocks& f) {
  std::string name;
  double most = 0;
  for (const auto& [cause, n] : f.causes)
    if (cause != "issue" && n > most) {
      most = n;
      name = cause;
    }
  return name;
}

std::string function_table(const Runs& runs) {
  std::vector<std::map<std::string, explain::FunctionClocks>> all;
  std::map<std::string, double> largest;
  std::vector<double> sums;
  for (const auto& run : runs) {
    all.emplace_back();
    sums.push_back(0);
    for (auto& f : functions_of(run)) {
      largest[f.name] = std::max(largest[f.name], f.clocks);
      sums.back() += f.clocks;
      all.back()[f.name] = f;
    }
  }
  std::vector<std::pair<std::string, double>> order(largest.begin(), largest.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<std::string> headings{"Function"};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::string of = runs.size() == 1 ? "" : " " + run_label(i);
    headings.insert(headings.end(), {"#Clocks" + of, "#Share" + of, "#Issue" + of});
    if (i > 0) headings.push_back(fmt::format("#{} - A", run_label(i)));
  }
  headings.insert(headings.end(), {"Waits most for", "Source"});
  Table table(order.size() > kMaxFunctions
                  ? fmt::format("The {} largest of {} functions", kMaxFunctions, order.size())
                  : "Functions, those with most clocks first",
              headings);
  order.resize(std::min(order.size(), kMaxFunctions));
  std::vector<std::map<std::string, std::string>> places;
  for (const auto& run : runs) places.push_back(places_of(run));
  for (const auto& entry : order) {
    const std::string& name = entry.first;
    std::vector<std::string> cells{"<code>" + escaped(name) + "</code>"};
    std::string where, wait;
    const auto of = [&](std::size_t i) {
      const auto found = all[i].find(name);
      return found == all[i].end() ? nullptr : &found->second;
    };
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const auto* f = of(i);
      const double clocks = f ? f->clocks : 0;
      cells.push_back(clocks_cell(clocks));
      cells.push_back(percent_cell(clocks, sums[i]));
      cells.push_back(clocks_cell(clocks_for(f, "issue")));
      if (i > 0) {
        const double change = clocks - (of(0) ? of(0)->clocks : 0);
        cells.push_back(
            fmt::format("<data value=\"{:.0f}\">{}{}</data>", change, change < 0 ? "-" : "+", clocks_text(change)));
      }
      if (where.empty() && places[i].contains(name)) where = places[i].at(name);
      if (wait.empty() && f) wait = largest_wait(*f);
    }
    cells.push_back(wait.empty() ? "" : escaped(explain::waits_or_sleeps_for(wait)));
    cells.push_back(escaped(where));
    table.row(cells);
  }
  return table.html();
}

}  // namespace

std::string slowest_sentence(const app::SlowestRow& row) {
  const std::string who = explain::master(row.master);
  std::vector<std::string> parts;
  for (const auto& [culprit, time] : app::slowest_parts(row)) {
    // A chip has several transfer controllers, which their names tell apart.
    const std::string served = explain::master(culprit);
    const std::string how =
        served.empty() ? explain::spent_by_port(culprit) : fmt::format("while {} ({}) is served", culprit, served);
    parts.push_back(fmt::format("{:.3f} us {}", static_cast<double>(time) * 1e-6, how));
  }
  return fmt::format("Slowest {} of {}{}: {}: {}.", row.direction, row.master, who.empty() ? "" : " (" + who + ")",
                     app::slowest_when(row), fmt::join(parts, ", "));
}

std::string frames_section(const Runs& runs) {
  return panels(runs, [&](std::size_t i) {
    const auto& run = runs[i];
    if (!run.frames) return absent("This folder has no frames.csv: only 'fovea run' writes it.");
    if (run.frames->empty()) return absent("The run displayed no frame.");
    std::string out =
        chart("frames", i,
              "When each of the first frames was captured, remapped and displayed, in ms "
              "since power-up. The number is that of the displayed frame.");
    if (run.frames->size() > 1)
      out +=
          chart("frame-times", i,
                "Time of the remap (above), and from the first captured to the first displayed sample (below), of each "
                "displayed frame. Each has its own axis, which does not begin at zero.");
    return out;
  });
}

std::string bandwidth_section(const Runs& runs) {
  return panels(runs, [&](std::size_t i) {
    const auto& run = runs[i];
    if (!run.timeline || run.timeline->rows.empty())
      return absent(
                 "This folder has no rows in timeline.csv, so its bandwidth over time is not "
                 "known.") +
             bandwidth_table(run);
    std::string out;
    if (run.frames && !run.frames->empty())
      out += chart(
          "bandwidth-detail", i,
          "Bandwidth to and from the SDRAM while the first frames were captured, remapped and "
          "displayed; masters are stacked.");
    out += chart(
        "bandwidth-whole", i,
        run.frames && frame_period(*run.frames)
            ? "Bandwidth to and from the SDRAM from the beginning to the end of the results: the mean of each "
              "frame period, or of several where there are many, so that equal frames look equal; masters are "
              "stacked."
            : "Bandwidth to and from the SDRAM from the beginning to the end of the results; masters are stacked.");
    return out + bandwidth_table(run);
  });
}

std::string latency_section(const Runs& runs) {
  return panels(runs, [&](std::size_t i) {
    const auto& run = runs[i];
    const std::string table = latency_table(run);
    if (table.empty()) return absent("The results have no latencies of the SDRAM.");
    std::string out =
        chart("percentiles", i,
              "Latency of each master's reads to their first beat and writes to their last: "
              "from the median to the 99th percentile as a bar, with the mean and the "
              "largest as marks.") +
        table +
        (run.slowest ? slowest_table(run)
                     : absent("The folder has no slowest.csv: what the slowest requests waited for is not known."));
    return out +
           (run.latency && !run.latency->empty()
                ? chart(
                      "latency", i,
                      "How many requests of each master took how long; both axes are logarithmic.")
                : absent("The folder has no latency.csv, so there are no histograms."));
  });
}

std::string stalls_section(const Runs& runs) {
  std::string out = panels(runs, [&](std::size_t i) {
    const auto& run = runs[i];
    if (run.value(names::kCpuCycles).value_or(0) == 0)
      return absent("No core ran, so there are no clocks of it to account for.");
    std::string inside =
        chart("waterfall", i,
              "Where the clocks of the core in the window went: each cause begins where the "
              "one above it ends; colours say who is to blame.");
    if (!run.stalls)
      return inside + absent("The folder has no stalls.csv, so the regions are not known.");
    return inside + "<details><summary>Show the waits as a table</summary>" + stalls_table(run) +
           "</details>";
  });
  for (std::size_t i = 1; i < runs.size(); ++i)
    if (runs[0].value(names::kRemapped).value_or(0) > 0 &&
        runs[i].value(names::kRemapped).value_or(0) > 0)
      out += chart("waterfall-difference", i,
                   fmt::format("Clocks of the core for each corrected frame: {} less A, by cause.",
                               run_label(i)));
  return out;
}

std::string banks_section(const Runs& runs) {
  return panels(runs, [&](std::size_t i) {
    if (!app::find(runs[i].stats, "ddr.bank0.row_hits"))
      return absent("The results have no figures of the SDRAM's banks.");
    return chart("banks", i,
                 "Requests that reached each bank of the SDRAM: with their row open, with its bank "
                 "closed, or with another row open. A stronger colour means more.");
  });
}

std::string functions_section(const Runs& runs) {
  const bool any =
      std::any_of(runs.begin(), runs.end(), [](const Results& r) { return r.profile.has_value(); });
  std::string out = any ? function_table(runs)
                        : absent(
                              "There is no profile: 'fovea run --profile' makes one, by function "
                              "and source line.");
  if (std::any_of(runs.begin(), runs.end(), [](const Results& r) { return r.stacks.has_value(); }))
    out += panels(runs, [&](std::size_t i) {
      if (!runs[i].stacks) return absent("This run has no profile.folded.");
      return chart(
          "flame", i,
          "Clocks by call stack: a box is as wide as the clocks of its function and of those that "
          "it calls. Choose a box to widen it.");
    });
  return out;
}

}  // namespace fovea::report
