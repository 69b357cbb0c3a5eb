// Updating a baseline so that nothing but values, simulator and history changes.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/regression/check.h"

namespace fovea::regression {

namespace {

/// The length of the plain scalar at `at`.
std::size_t scalar_size(const std::string& text, std::size_t at) {
  const std::size_t end = text.find_first_of(" \t\r\n,}]#", at);
  return (end == std::string::npos ? text.size() : end) - at;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    out.push_back(text.substr(at, end == std::string::npos ? end : end - at));
    at = end == std::string::npos ? text.size() : end + 1;
  }
  return out;
}

}  // namespace

std::string blessed_text(const RunFigures& run, const Baseline& baseline, const std::string& why) {
  // Replacements by position, from the end of the file on, so that earlier places stay.
  std::map<std::size_t, std::string, std::greater<>> replacements;
  const Baseline::History& history = baseline.history;
  std::string changes;
  for (const auto& e : baseline.metrics) {
    const Metric* const m = run.metric(e.name);
    const std::string where = fmt::format("{}:{}", app::one_line(baseline.file.string()), e.line);
    if (!m) {
      const Finding f = judge(e, run);
      throw UserError(fmt::format("{}: '{}': {}", where, app::one_line(e.name, 60), f.words));
    }
    if (m->unit != e.unit)
      throw UserError(fmt::format("{}: '{}': the run's unit is {}; allowed: {}", where, e.name, m->unit,
                                  e.unit));
    if (e.kind != Kind::kExact || m->value == e.value) continue;
    const std::string now = m->value ? exact_text(*m->value, m->whole) : "null";
    const std::string before = baseline.text.substr(e.value_at, scalar_size(baseline.text, e.value_at));
    replacements[e.value_at] = now;
    changes += fmt::format("{:{}}{}: {} -> {}\n", "", history.indent + 4, e.name, before, now);
  }
  const bool moved = !replacements.empty();
  if (!moved && baseline.version == run.version && baseline.commit == commit_text(run)) return baseline.text;
  if (moved && history.brackets)
    throw UserError(
        fmt::format("{}:{}: 'history' has entries in brackets; allowed: a list of lines that begin with '- ', "
                    "or []",
                    app::one_line(baseline.file.string()), history.line));
  replacements[baseline.version_at] = run.version;
  replacements[baseline.commit_at] = commit_text(run);
  std::string out = baseline.text;
  // The history is the last part of the file, so that nothing before it moves.
  if (moved && history.size) out.erase(history.at, history.size);
  for (const auto& [at, text] : replacements) out.replace(at, scalar_size(out, at), text);
  if (!moved) return out;  // equal figures of another simulator: no history
  if (!out.ends_with('\n')) out += '\n';
  if (!history.there) out += "history:\n";
  const std::string indent(history.indent, ' ');
  return out + fmt::format("{0}- commit: {1}\n{0}  why: {2}\n{0}  changes: |\n{3}", indent, commit_text(run),
                           yaml_text(why), changes);
}

namespace {

struct DiffLine {
  char sign;  // of a unified diff
  std::string text;
};

/// All lines of both texts. Blessing replaces values where they stand and adds lines at the end, so line i of one is
/// line i of the other; what a comparison of any two texts needs, memory by the square of their lines, is not worth it.
std::vector<DiffLine> aligned_lines(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  std::vector<DiffLine> lines, added;  // the second: of the differing lines in a row, those of b
  const auto end_of_row = [&] {
    lines.insert(lines.end(), added.begin(), added.end());
    added.clear();
  };
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const bool in_a = i < a.size(), in_b = i < b.size();
    if (in_a && in_b && a[i] == b[i]) {
      end_of_row();
      lines.push_back({' ', a[i]});
      continue;
    }
    if (in_a) lines.push_back({'-', a[i]});
    if (in_b) added.push_back({'+', b[i]});
  }
  end_of_row();
  return lines;
}

/// Which lines a diff shows: those that differ, with three lines around them.
std::vector<bool> shown_lines(const std::vector<DiffLine>& lines) {
  constexpr std::size_t kContext = 3;
  std::vector<bool> shown(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (lines[i].sign != ' ')
      for (std::size_t k = i < kContext ? 0 : i - kContext; k <= i + kContext && k < lines.size(); ++k)
        shown[k] = true;
  return shown;
}

}  // namespace

std::string unified_diff(const std::string& name, const std::string& before,
                         const std::string& after) {
  const std::vector<DiffLine> lines = aligned_lines(lines_of(before), lines_of(after));
  const std::vector<bool> shown = shown_lines(lines);
  std::string out;
  std::size_t in_a = 0, in_b = 0;
  for (std::size_t i = 0; i < lines.size();) {
    const auto step = [&](const DiffLine& line) {
      in_a += line.sign != '+';
      in_b += line.sign != '-';
    };
    if (!shown[i]) {
      step(lines[i++]);
      continue;
    }
    const std::size_t from_a = in_a, from_b = in_b;
    std::string hunk;
    for (; i < lines.size() && shown[i]; ++i) {
      hunk += lines[i].sign + lines[i].text + "\n";
      step(lines[i]);
    }
    // An empty side is numbered by the line before it.
    const auto range = [](std::size_t from, std::size_t count) {
      return fmt::format("{},{}", count ? from + 1 : from, count);
    };
    out += fmt::format("@@ -{} +{} @@\n{}", range(from_a, in_a - from_a),
                       range(from_b, in_b - from_b), hunk);
  }
  return out.empty() ? "" : fmt::format("--- {}\n+++ {}\n{}", name, name, out);
}

}  // namespace fovea::regression
