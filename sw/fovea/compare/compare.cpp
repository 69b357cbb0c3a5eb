#include "sw/fovea/compare/compare.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/results/names.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::regression {
namespace {

bool selected(const std::string& name, const std::string& only) {
  if (only.find_first_of("*?[") != std::string::npos)
    return ::fnmatch(only.c_str(), name.c_str(), 0) == 0;
  return name.find(only) != std::string::npos;
}

/// Empty if the two are equal within the tolerance.
std::optional<MetricChange> change_of_metric(const std::string& name, const Metric* before,
                                             const Metric* after, const Tolerance& tolerance) {
  const MetricChange change{name, before, after, before && after && before->unit != after->unit};
  if (!before || !after || change.unit_differs) return change;
  if (before->value.has_value() != after->value.has_value()) return change;
  if (!before->value) return std::nullopt;
  const bool whole = before->whole && after->whole;
  if (deviation_of(*after->value, *before->value, tolerance, whole) == Deviation::kWithin)
    return std::nullopt;
  return change;
}

std::string with_sign(const std::string& text, bool negative) { return (negative ? "-" : "+") + text; }

/// Rows of texts as columns; the columns of `left` are aligned to the left.
std::string columns_text(const std::vector<std::vector<std::string>>& rows, std::size_t left) {
  std::vector<std::size_t> width;
  for (const auto& row : rows) {
    width.resize(std::max(width.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  }
  std::string out;
  for (const auto& row : rows) {
    std::string line = " ";
    for (std::size_t c = 0; c < row.size(); ++c)
      line += c < left ? fmt::format(" {:<{}}", row[c], width[c])
                       : fmt::format("  {:>{}}", row[c], width[c]);
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

std::string figure_or_dash(const Metric* m) { return m ? figure_text(*m) : "missing"; }

}  // namespace

std::optional<double> MetricChange::difference() const {
  if (!before || !after || unit_differs || !before->value || !after->value) return std::nullopt;
  return *after->value - *before->value;
}

std::optional<double> MetricChange::relative() const {
  const auto d = difference();
  if (!d || *before->value == 0) return std::nullopt;
  return *d / std::abs(*before->value);
}

std::string percent_text(std::optional<double> share) {
  if (!share) return "";
  const double percent = 100 * *share;
  if (percent == 0) return "unchanged";
  return fmt::format("{:+.{}f} %", percent, std::abs(percent) < 0.095 ? 3 : 1);
}

std::string change_text(const MetricChange& change) {
  const auto d = change.difference();
  if (!d) return change.unit_differs ? "other unit" : "";
  Metric m = *change.before;
  m.value = std::abs(*d);
  m.whole = change.before->whole && change.after->whole;
  // A share of 0.5 that grows by 0.1 grows by ten points, not by 10 %.
  if (m.unit == "ratio") return fmt::format("{:+.4g} points", 100 * *d);
  return with_sign(figure_text(m), *d < 0);
}

bool same_simulator(const RunFigures& a, const RunFigures& b) {
  return a.version == b.version && a.commit == b.commit && a.modified == b.modified;
}

void refuse_other_simulator(const RunFigures& a, const RunFigures& b) {
  if (same_simulator(a, b)) return;
  throw UserError(fmt::format("'{}' is of simulator {}, '{}' of {}; allowed: results of one "
                              "simulator, or --across-versions, which lists what differs",
                              app::one_line(a.folder.string()), a.simulator(),
                              app::one_line(b.folder.string()), b.simulator()));
}

Circumstances circumstances_of(const RunFigures& before, const RunFigures& after) {
  Circumstances out;
  std::set<std::string> inputs;
  for (const auto* run : {&before, &after})
    for (const auto& [key, hash] : run->hashes) inputs.insert(key);
  const auto hash = [](const RunFigures& run, const std::string& key) {
    const auto found = run.hashes.find(key);
    return found == run.hashes.end() ? std::string() : found->second;
  };
  for (const auto& key : inputs)
    if (hash(before, key) != hash(after, key))
      (key == "firmware.elf" || key == "program" ? out.program_differs : out.settings_differ) = true;
  for (const auto& [key, p] : after.parameters) {
    const auto other = before.parameters.find(key);
    if (!p.path && other != before.parameters.end() && !other->second.path &&
        other->second.value != p.value)
      out.settings_differ = true;
  }
  for (const char* const cache : {"icache", "dcache"}) {
    // Without a cache there are no line fills; of programs without these nothing is known.
    const std::string fills = std::string("cpu.") + cache + (cache[0] == 'i' ? ".accesses" : ".reads");
    if (before.value(fills) > 0 && after.metric(names::kCpuCycles) && after.value(fills) == 0)
      out.notes.push_back(fmt::format("the {}-cache is off", cache[0] == 'i' ? 'I' : 'D'));
  }
  return out;
}

SettingChanges setting_changes(const RunFigures& before, const RunFigures& after) {
  SettingChanges out;
  if (!same_simulator(before, after))
    out.both.push_back(fmt::format("simulator: {} -> {}", before.simulator(), after.simulator()));
  if (before.subject != after.subject)
    out.both.push_back(fmt::format("{} -> {}", before.subject.text(), after.subject.text()));
  std::set<std::string> keys, inputs;
  for (const auto* run : {&before, &after}) {
    for (const auto& [key, p] : run->parameters) keys.insert(key);
    for (const auto& [key, hash] : run->hashes) inputs.insert(key);
  }
  for (const auto& key : keys) {
    const auto a = before.parameters.find(key), b = after.parameters.find(key);
    // Of files, the hashes below matter.
    if ((a != before.parameters.end() && a->second.path) || (b != after.parameters.end() && b->second.path))
      continue;
    if (a == before.parameters.end())
      out.one_only.push_back(fmt::format("parameter {} is new: {}", key, app::one_line(b->second.value, 60)));
    else if (b == after.parameters.end())
      out.one_only.push_back(fmt::format("parameter {} is gone: {}", key, app::one_line(a->second.value, 60)));
    else if (a->second.value != b->second.value)
      out.both.push_back(
          fmt::format("{}: {} -> {}{}", key, app::one_line(a->second.value, 60), app::one_line(b->second.value, 60),
                      a->second.default_value != b->second.default_value ? " (the default changed)" : ""));
  }
  for (const auto& key : inputs) {
    const auto a = before.hashes.find(key), b = after.hashes.find(key);
    if (a == before.hashes.end() || b == after.hashes.end())
      out.both.push_back(fmt::format("input {}: only one run read it", key));
    else if (a->second != b->second)
      out.both.push_back(fmt::format("input {}: another file (SHA-256 {:.12} -> {:.12})", key, a->second, b->second));
  }
  return out;
}

std::vector<std::string> differences_of_settings(const RunFigures& before, const RunFigures& after) {
  const SettingChanges changes = setting_changes(before, after);
  std::vector<std::string> out = changes.both;
  out.insert(out.end(), changes.one_only.begin(), changes.one_only.end());
  return out;
}

void level_clocks(const RunFigures& before, const RunFigures& after, Attribution& a, Attribution& b) {
  const auto value = [](const RunFigures& run, const char* key) {
    const auto found = run.parameters.find(key);
    return found == run.parameters.end() ? std::string() : found->second.value;
  };
  for (const char* key : {"clocks.preset", "clocks.arm", "clocks.ddr"})
    if (value(before, key) != value(after, key)) return;
  if (!before.has_frames() && !after.has_frames() && before.subject.kind == after.subject.kind) b.seconds = a.seconds;
}

Comparison compare_runs(const RunFigures& before, const RunFigures& after,
                        const Tolerance& tolerance, const std::string& only) {
  Comparison out;
  out.before = &before;
  out.after = &after;
  std::set<std::string> names;
  for (const auto* run : {&before, &after})
    for (const auto& [name, m] : run->metrics)
      if (selected(name, only)) names.insert(name);
  out.compared = names.size();
  for (const auto& name : names)
    if (const auto change = change_of_metric(name, before.metric(name), after.metric(name), tolerance))
      out.changes.push_back(*change);
  out.settings = setting_changes(before, after);
  const bool profile = has_profile(before) && has_profile(after);
  Attribution a = attribution_of(before, profile), b = attribution_of(after, profile);
  level_clocks(before, after, a, b);
  if (!a.rows.empty() && !b.rows.empty())
    out.difference = difference_of(a, b, circumstances_of(before, after));
  if (!a.startup.empty() && !b.startup.empty())
    for (const MetricChange& m : out.changes)
      if (m.difference() && (m.name == names::kStartupLutTime || m.name == names::kStartupFirstFrame))
        out.startup.push_back(difference_of(a, b, circumstances_of(before, after), part_of_figure(m.name)));
  return out;
}

/// The sentence about the largest change; empty if it is within the tolerance.
static std::string largest_text(const Difference& d, const Tolerance& tolerance) {
  const bool slower = d.busy.change() >= 0;
  const Blame blame = blame_of(d, slower);
  if (!blame.function || std::abs(blame.function->share.change()) <= tolerance.allowed(d.busy.before)) return "";
  return fmt::format("{}: {}\n", slower ? "largest slow-down" : "largest speed-up", blame_text(d, blame));
}

std::string difference_text(const Difference& d, std::size_t rows) {
  const auto share = [&](const Share& s) {
    return amount_text(d, s.change()) +
           (s.before ? " (" + percent_text(s.change() / s.before) + ")" : "");
  };
  const std::string part = part_text(d.part);
  std::string out = fmt::format("where the {}{} went: all {}, busy {}, idle {}\n",
                                d.in_seconds ? "time of the core" : "core's clocks", part.empty() ? "" : " " + part,
                                share(d.total), share(d.busy), share(d.idle));
  if (d.in_seconds) out += "  (as time, because the clocks of the two cores have other lengths)\n";
  struct Line {
    const FunctionChange* f;
    const CauseChange* c;
  };
  std::vector<Line> lines;
  for (const auto& f : d.functions)
    for (const auto& c : f.causes) lines.push_back({&f, &c});
  std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) {
    return std::abs(a.c->share.change()) > std::abs(b.c->share.change());
  });
  std::vector<std::vector<std::string>> table = {
      {"function", "why", "cause", "region", "culprit", d.in_seconds ? "time" : "change"}};
  double rest = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto& [f, c] = lines[i];
    if (i >= rows) {
      rest += c->share.change();
      continue;
    }
    table.push_back({f->function.empty() ? "-" : place_text(*f, nullptr),
                     d.by_function ? kind_text(f->kind, f->instructions_after > f->instructions_before)
                                   : "-",
                     c->cause, c->region.empty() ? "-" : c->region,
                     c->culprit.empty() ? "-" : c->culprit, amount_text(d, c->share.change())});
  }
  if (lines.size() > rows)
    table.push_back({fmt::format("{} more rows", lines.size() - rows), "", "", "", "",
                     amount_text(d, rest)});
  if (!lines.empty()) out += columns_text(table, 5);
  double layout = 0;
  for (const auto& f : d.functions) layout += f.layout;
  if (layout != 0)
    out += fmt::format("  of this by layout (same code at other addresses): {}\n",
                       amount_text(d, layout));
  out += fmt::format("  unexplained: {} ({:.1f} %)\n", amount_text(d, d.unexplained),
                     100 * d.unexplained_share());
  if (!d.by_function)
    out += "  by function and line: let both runs write a profile ('fovea run --profile')\n";
  else if (d.program_differs && !d.places_known)
    out += "  moved code is not told apart: one of the profiles has no functions.csv\n";
  return out;
}

std::string settings_text(const SettingChanges& settings, bool all) {
  // A few are news of another version of Fovea; many are those of another command.
  constexpr std::size_t kFew = 5;
  const bool listed = all || settings.one_only.size() <= kFew;
  if (settings.both.empty() && settings.one_only.empty()) return "";
  std::string out = "what was different:\n";
  for (const auto& line : settings.both) out += "  " + line + "\n";
  if (!listed)
    out += fmt::format("  {} parameters exist in one of the two only; --all lists them\n", settings.one_only.size());
  else
    for (const auto& line : settings.one_only) out += "  " + line + "\n";
  return out;
}

/// The figures that differ, those that change the largest share of a frame first.
std::string figures_text(const Comparison& c, bool all) {
  constexpr std::size_t kShown = 30;
  const std::vector<SharedChange> sorted = by_share_of_time(c);
  std::vector<std::vector<std::string>> table = {
      {"figure", "A", "B", "change", "", c.before->has_frames() ? "of a frame" : "of the window"}};
  for (std::size_t i = 0; i < sorted.size() && (all || i < kShown); ++i) {
    const MetricChange& m = *sorted[i].change;
    table.push_back({m.name, figure_or_dash(m.before), figure_or_dash(m.after), change_text(m),
                     percent_text(m.relative()), percent_text(sorted[i].share)});
  }
  std::string out = columns_text(table, 1);
  if (!all && sorted.size() > kShown)
    out += fmt::format("  {} more figures; --all lists them\n", sorted.size() - kShown);
  return out;
}

std::string comparison_text(const Comparison& c, const Tolerance& tolerance, bool all) {
  std::string out =
      fmt::format("A  {}: {}, fovea {}\nB  {}: {}, fovea {}\n", app::one_line(c.before->folder.string()),
                  c.before->subject.text(),
                  c.before->simulator(), c.after->folder.string(), c.after->subject.text(), c.after->simulator());
  out += settings_text(c.settings, all);
  const std::string within =
      tolerance.allowed(1) == 0 ? "" : fmt::format(" (tolerance {})", tolerance.text());
  if (c.changes.empty())
    out += fmt::format("equal: all {} figures{}\n", c.compared, within);
  else
    out += fmt::format("different: {} of {} figures{}\n", c.changes.size(), c.compared, within) + figures_text(c, all);
  if (c.difference && !c.difference->none()) {
    out += difference_text(*c.difference, all ? SIZE_MAX : 12);
    out += largest_text(*c.difference, tolerance);
  }
  for (const Difference& d : c.startup)
    if (!d.none()) out += largest_text(d, tolerance);
  return out;
}

}  // namespace fovea::regression
