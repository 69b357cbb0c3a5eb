#include "sw/fovea/regression/baseline.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "model/common/check.h"
#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/safe_yaml.h"
#include "sw/fovea/results/outputs.h"

namespace fovea::regression {
namespace {

/// Reads a baseline and knows the file for messages.
class BaselineReader {
 public:
  BaselineReader(const std::filesystem::path& file, std::string text) {
    out_.file = file;
    out_.text = std::move(text);
  }

  Baseline read() {
    YAML::Node root;
    try {
      root = app::load_yaml(out_.text);
    } catch (const app::YamlFault& e) {
      fail(e.line - 1, e.what());
    }
    if (!root.IsMap()) fail(0, "not a baseline; allowed: a map with 'format: fovea baseline 1'");
    const auto format = root["format"];
    if (!format || !format.IsScalar() || format.Scalar() != kBaselineFormat)
      fail(format ? format.Mark().line : 0,
           fmt::format("not a baseline that this program reads; allowed: 'format: {}'",
                       kBaselineFormat));
    known(root,
          {"format", "experiment", "program", "trace", "arguments", "options", "simulator", "settings", "reference",
           "reference_sha256", "metrics", "history"},
          "the baseline");
    read_subject(root);
    const YAML::Node simulator = root["simulator"];
    if (!simulator || !simulator.IsMap())
      fail(root.Mark().line, "'simulator' is missing; allowed: {version: ..., commit: ...}");
    known(simulator, {"version", "commit"}, "'simulator'");
    const YAML::Node version = scalar(simulator, "version", simulator);
    const YAML::Node commit = scalar(simulator, "commit", simulator);
    out_.version = version.Scalar();
    out_.commit = commit.Scalar();
    out_.version_at = place(version);
    out_.commit_at = place(commit);
    if (const YAML::Node settings = root["settings"]; settings) {
      if (!settings.IsMap()) fail(settings.Mark().line, "'settings' is not a map of parameters");
      for (const auto& item : settings) {
        if (!item.second.IsScalar())
          fail(item.second.Mark().line, "a setting is a parameter and its value");
        out_.settings[item.first.Scalar()] = item.second.Scalar();
      }
    }
    read_reference(root);
    check_history(root);
    read_metrics(root["metrics"], root);
    return std::move(out_);
  }

 private:
  void read_subject(const YAML::Node& root) {
    bool found = false;
    for (const ResultKind kind : {ResultKind::kRun, ResultKind::kExec, ResultKind::kReplay}) {
      const std::string key(subject_key(kind));
      if (!root[key]) continue;
      if (found) fail(root[key].Mark().line, "one of 'experiment', 'program' and 'trace' is allowed");
      found = true;
      out_.subject = {kind, scalar(root, key.c_str(), root).Scalar()};
    }
    if (!found) fail(root.Mark().line, "'experiment' is missing; of a result of exec 'program', of replay 'trace'");
    out_.subject.arguments = words(root, "arguments", out_.subject.kind == ResultKind::kExec);
    out_.subject.options = words(root, "options", out_.subject.kind != ResultKind::kRun);
  }

  void read_reference(const YAML::Node& root) {
    const YAML::Node reference = root["reference"], hash = root["reference_sha256"];
    if (!reference) {
      if (hash) fail(hash.Mark().line, "'reference_sha256' without 'reference', whose hash it is");
      return;
    }
    if (!reference.IsScalar() || reference.Scalar().empty() || reference.Scalar() == "." ||
        reference.Scalar() == ".." || reference.Scalar().find('/') != std::string::npos)
      fail(reference.Mark().line,
           "'reference' is the name of a folder beside the baseline; allowed: a name without '/'");
    out_.reference = out_.file.parent_path() / reference.Scalar();
    const auto at = static_cast<std::size_t>(reference.Mark().pos);
    out_.reference_line_at = std::min(out_.text.find('\n', at), out_.text.size());
    for (const auto& item : root)
      if (item.first.Scalar() == "reference")
        out_.reference_indent = static_cast<std::size_t>(item.first.Mark().column);
    if (!hash) return;
    constexpr std::size_t kDigits = 64;
    if (!hash.IsScalar() || hash.Scalar().size() != kDigits ||
        hash.Scalar().find_first_not_of("0123456789abcdef") != std::string::npos)
      fail(hash.Mark().line, "'reference_sha256' is no SHA-256; allowed: 64 digits, which bless writes");
    out_.reference_sha256 = hash.Scalar();
    out_.reference_sha256_at = place(hash);
  }

  std::vector<std::string> words(const YAML::Node& root, const char* key, bool allowed) {
    const YAML::Node list = root[key];
    if (!list) return {};
    if (!allowed)
      fail(list.Mark().line, fmt::format("'{}' does not go with '{}'", key, subject_key(out_.subject.kind)));
    std::vector<std::string> out;
    if (!list.IsSequence()) fail(list.Mark().line, fmt::format("'{}' is not a list of words", key));
    for (const auto& word : list) {
      if (!word.IsScalar()) fail(word.Mark().line, fmt::format("'{}' is not a list of words", key));
      out.push_back(word.Scalar());
    }
    return out;
  }

  [[noreturn]] void fail(int line, const std::string& what) const {
    throw UserError(fmt::format("{}:{}: {}", app::one_line(out_.file.string()),
                                std::max(line, 0) + 1, what));
  }

  void known(const YAML::Node& map, const std::vector<std::string>& names, const std::string& where) {
    for (const auto& item : map) {
      const std::string& key = item.first.Scalar();
      if (std::find(names.begin(), names.end(), key) == names.end())
        fail(item.first.Mark().line, fmt::format("unknown key '{}' in {}; allowed: {}",
                                                 app::one_line(key, 60), where,
                                                 fmt::join(names, ", ")));
    }
  }

  YAML::Node scalar(const YAML::Node& map, const char* name, const YAML::Node& near) {
    const YAML::Node node = map[name];
    if (!node || !node.IsScalar() || node.Scalar().empty())
      fail(near.Mark().line, fmt::format("'{}' is missing", name));
    return node;
  }

  /// Where a scalar's text begins in the file.
  std::size_t place(const YAML::Node& node) const {
    const auto at = static_cast<std::size_t>(node.Mark().pos);
    if (at > out_.text.size() || out_.text.compare(at, node.Scalar().size(), node.Scalar()) != 0)
      fail(node.Mark().line, "a value that is to be replaced stands without quotes, in a file "
                             "without byte order mark");
    return at;
  }

  void check_history(const YAML::Node& root) {
    const YAML::Node history = root["history"];
    if (!history) return;
    out_.history.there = true;
    out_.history.line = history.Mark().line + 1;
    if (history.IsSequence() && history.Style() != YAML::EmitterStyle::Flow) {
      out_.history.indent = static_cast<std::size_t>(history.Mark().column);
    } else if (history.IsSequence()) {
      out_.history.at = static_cast<std::size_t>(history.Mark().pos);
      out_.history.size = out_.text.find(']', out_.history.at) + 1 - out_.history.at;
      out_.history.brackets = history.size() != 0;
    } else if (history.IsNull()) {
      const auto at = static_cast<std::size_t>(history.Mark().pos);
      for (const std::string_view word : {"null", "Null", "NULL", "~"})
        if (at < out_.text.size() && out_.text.compare(at, word.size(), word) == 0) {
          out_.history.at = at;
          out_.history.size = word.size();
        }
    } else {
      fail(history.Mark().line, "'history' is not a list");
    }
    for (const auto& item : root)
      if (item.first.Mark().line > history.Mark().line)
        fail(item.first.Mark().line, "'history' is the last part of a baseline; new entries are "
                                     "added at the end of the file");
  }

  void read_metrics(const YAML::Node& metrics, const YAML::Node& root) {
    if (!metrics || !metrics.IsMap() || metrics.size() == 0)
      fail(metrics ? metrics.Mark().line : root.Mark().line,
           "'metrics' is missing or empty; allowed: figures of stats.json with value and unit");
    for (const auto& item : metrics)
      out_.metrics.push_back(read_metric(item.first.Scalar(), item.second, item.first.Mark().line));
  }

  Expectation read_metric(const std::string& name, const YAML::Node& node, int line) {
    const std::string where = "'" + app::one_line(name, 60) + "'";
    if (!node.IsMap()) fail(line, where + " is not a map with value and unit");
    known(node, {"value", "unit", "tolerance", "worse", "kind", "reason"}, where);
    Expectation e;
    e.name = name;
    e.line = line + 1;
    read_value(node["value"], line, where, e);
    e.unit = scalar(node, "unit", node).Scalar();
    if (const auto t = node["tolerance"]; t) {
      if (!t.IsScalar()) fail(t.Mark().line, where + ": the tolerance is not a text");
      e.tolerance = parse_tolerance(
          t.Scalar(), fmt::format("{}:{}: {}", app::one_line(out_.file.string()),
                                  t.Mark().line + 1, where));
    }
    e.worse = choice<Worse>(node, "worse", where, Worse::kBoth,
                            {{"higher", Worse::kHigher}, {"lower", Worse::kLower}, {"both", Worse::kBoth}});
    e.kind = choice<Kind>(node, "kind", where, Kind::kExact,
                          {{"exact", Kind::kExact}, {"analytic", Kind::kAnalytic}, {"budget", Kind::kBudget}});
    if (const auto r = node["reason"]; r) e.reason = r.Scalar();
    if (e.kind != Kind::kExact && e.reason.empty())
      fail(line, where + ": an analytic value and a budget need a reason");
    if (e.kind == Kind::kBudget && (e.worse == Worse::kBoth || !e.value))
      fail(line, where + ": a budget needs a number, and 'worse: higher' or 'worse: lower'");
    return e;
  }

  void read_value(const YAML::Node& value, int line, const std::string& where, Expectation& e) {
    if (!value) fail(line, where + ": 'value' is missing");
    if (value.IsNull()) {
      // A null that is written as nothing has no place where a number could be put.
      e.value_at = static_cast<std::size_t>(value.Mark().pos);
      if (out_.text.compare(e.value_at, 4, "null") != 0)
        fail(line, where + ": 'value' is empty; allowed: a number, or null for a figure that has "
                           "no value");
      return;
    }
    double number = 0;
    if (!value.IsScalar() || !YAML::convert<double>::decode(value, number) || !std::isfinite(number))
      fail(value.Mark().line, where + ": the value is not a number; allowed: a number, or null for "
                                      "a figure that has no value");
    e.value = number;
    e.value_at = place(value);
  }

  template <class T>
  T choice(const YAML::Node& node, const char* key, const std::string& where, T otherwise,
           const std::vector<std::pair<std::string, T>>& words) {
    const auto word = node[key];
    if (!word) return otherwise;
    std::vector<std::string> names;
    for (const auto& [name, value] : words) {
      if (word.IsScalar() && word.Scalar() == name) return value;
      names.push_back(name);
    }
    fail(word.Mark().line, fmt::format("{}: '{}' is not allowed; allowed: {}", where, key,
                                       fmt::join(names, ", ")));
  }

  Baseline out_;
};

}  // namespace

std::string_view kind_name(Kind kind) {
  return kind == Kind::kExact ? "exact" : kind == Kind::kAnalytic ? "analytic" : "budget";
}

Baseline read_baseline(const std::filesystem::path& file) {
  return parse_baseline(file, app::read_file(file, app::kMaxSettingsBytes));
}

Baseline parse_baseline(const std::filesystem::path& file, std::string text) {
  return BaselineReader(file, std::move(text)).read();
}

std::string with_reference_hash(const Baseline& baseline, const std::string& hash) {
  std::string out = baseline.text;
  if (!baseline.reference_sha256.empty())
    return out.replace(baseline.reference_sha256_at, baseline.reference_sha256.size(), hash);
  return out.insert(baseline.reference_line_at,
                    fmt::format("\n{:{}}reference_sha256: {}", "", baseline.reference_indent, hash));
}

std::string commit_text(const RunFigures& run) {
  return run.commit + (run.modified ? "-modified" : "");
}

std::string yaml_text(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

std::string yaml_scalar(const std::string& text) {
  YAML::Emitter emitter;
  emitter << text;
  return emitter.c_str();
}

}  // namespace fovea::regression
