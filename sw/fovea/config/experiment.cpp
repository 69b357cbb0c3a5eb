#include "sw/fovea/config/experiment.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>

#include <limits>

#include "sw/fovea/files/checked_file.h"
#include "sw/fovea/files/own_program.h"
#include "sw/fovea/files/safe_yaml.h"

namespace fovea::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDepth = 8;
constexpr std::size_t kMaxIncludeDepth = 8;
constexpr std::size_t kMaxFiles = 64;
constexpr std::string_view kInclude = "include";

struct Entry {
  std::string key;
  std::string value;               // sequences are already converted to "[a, b]"
  std::vector<std::string> items;  // the items of a sequence
  unsigned line = 0;
};

std::string at(const fs::path& file, unsigned line) {
  return fmt::format("{}:{}", one_line(file.string()), line);
}

/// An item of a list as text; if it contains a comma, in quotation marks.
std::string list_item(const std::string& item) {
  if (item.find(',') == std::string::npos) return item;
  std::string out = "\"";
  for (const char c : item) out += c == '"' ? std::string("\\\"") : std::string(1, c);
  return out + "\"";
}

/// Converts the parser's events into dotted keys. A key may be written in several ways (`a: {b: 1}`, `a.b: 1`), so it
/// is here that repeated ones are noticed.
class Flattener : public YAML::EventHandler {
 public:
  explicit Flattener(const fs::path& file) : file_(file) {}
  std::vector<Entry> take() { return std::move(entries_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}  // is refused before

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (levels_.empty()) fail(mark, kTopLevel);
    if (levels_.back().sequence || levels_.back().expect_key)
      fail(mark, fmt::format("key '{}': empty entry", prefix()));
    fail(mark, fmt::format("key '{}' has no value", prefix()));
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, const std::string& value) override {
    check_tag(mark, tag);
    if (levels_.empty()) fail(mark, kTopLevel);
    Level& level = levels_.back();
    if (level.sequence) {
      entry_.items.push_back(value);
    } else if (level.expect_key) {
      if (value.empty()) fail(mark, "empty key");
      level.key = value;
      level.expect_key = false;
      level.line = line_of(mark);
    } else {
      add({prefix(), value, {}, level.line});
      level.expect_key = true;
    }
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    begin(mark, tag);
    if (levels_.empty()) fail(mark, kTopLevel);
    entry_ = {prefix(), "", {}, levels_.back().line};
    levels_.push_back({true, false, "", line_of(mark)});
  }
  void OnSequenceEnd() override {
    levels_.pop_back();
    for (const auto& item : entry_.items)
      entry_.value += (entry_.value.empty() ? "" : ", ") + list_item(item);
    entry_.value = "[" + entry_.value + "]";
    add(std::move(entry_));
    levels_.back().expect_key = true;
  }

  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    begin(mark, tag);
    if (levels_.size() >= kMaxDepth)
      fail(mark, fmt::format("nested deeper than the {} levels allowed", kMaxDepth));
    levels_.push_back({false, true, "", line_of(mark)});
  }
  void OnMapEnd() override {
    const bool empty = levels_.back().key.empty();
    const unsigned line = levels_.back().line;
    levels_.pop_back();
    if (levels_.empty()) return;
    if (empty) fail(line, fmt::format("key '{}' has no value (an empty map)", prefix()));
    levels_.back().expect_key = true;
  }

 private:
  struct Level {
    bool sequence = false;
    bool expect_key = true;
    std::string key;
    unsigned line = 0;
  };
  static constexpr const char* kTopLevel = "the top level must be a map of 'key: value'";

  static unsigned line_of(const YAML::Mark& mark) { return static_cast<unsigned>(mark.line + 1); }
  [[noreturn]] void fail(unsigned line, const std::string& what) {
    throw UserError(at(file_, line) + ": " + one_line(what));
  }
  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& what) {
    fail(line_of(mark), what);
  }
  void check_tag(const YAML::Mark& mark, const std::string& tag) {
    // "?" is the tag of a plain scalar, "!" that of a quoted one.
    if (!tag.empty() && tag != "?" && tag != "!")
      fail(mark, "YAML tags are not allowed ('" + tag + "')");
  }
  void begin(const YAML::Mark& mark, const std::string& tag) {
    check_tag(mark, tag);
    if (levels_.empty()) return;
    if (levels_.back().sequence)
      fail(mark, fmt::format("key '{}': a list holds plain values only", entry_.key));
    if (levels_.back().expect_key) fail(mark, "a key must be a plain word");
  }
  std::string prefix() const {
    std::string out;
    for (const auto& level : levels_)
      if (!level.sequence) out += (out.empty() ? "" : ".") + level.key;
    return out;
  }
  void add(Entry entry) {
    const auto [first, inserted] = lines_.emplace(entry.key, entry.line);
    if (!inserted)
      fail(entry.line,
           fmt::format("key '{}' is written twice (first in line {})", entry.key, first->second));
    entries_.push_back(std::move(entry));
  }

  fs::path file_;
  std::vector<Level> levels_;
  Entry entry_;
  std::vector<Entry> entries_;
  std::map<std::string, unsigned> lines_;
};

std::vector<Entry> parse(const fs::path& file) {
  Flattener flattener(file);
  try {
    each_yaml_event(read_file(file, kMaxSettingsBytes), flattener);
  } catch (const YamlFault& e) {
    throw UserError(at(file, static_cast<unsigned>(e.line)) + ": " + one_line(e.what()));
  }
  return flattener.take();
}

/// A message if `key` is a prefix of known keys; otherwise empty.
std::string group_hint(const ParamSet& params, std::string_view key) {
  const std::string prefix = std::string(key) + ".";
  std::string members;
  int shown = 0;
  for (const auto* p : params.all()) {
    if (!p->key().starts_with(prefix)) continue;
    if (++shown > 6) {
      members += ", ...";
      break;
    }
    members += (members.empty() ? "" : ", ") + p->key();
  }
  return members;
}

}  // namespace

std::string ValueOrigin::text() const {
  switch (kind) {
    case Kind::kFile:
      return line ? at(file, line) : one_line(file);
    case Kind::kCommandLine:
      return "command line";
    case Kind::kOtherKey:
      return "as " + file;
    case Kind::kDefault:
      break;
  }
  return "default";
}

bool is_camera_row(std::string_view key) {
  constexpr std::string_view kGroup = "camera.";
  return key.size() > kGroup.size() + 1 && key.starts_with(kGroup) && key[kGroup.size()] >= '0' &&
         key[kGroup.size()] <= '9' && key[kGroup.size() + 1] == '.';
}

bool is_path_key(const ParamBase& param) {
  if (!dynamic_cast<const TextParam*>(&param)) return false;
  const std::string& key = param.key();
  return key.ends_with(".file") || key.ends_with(".elf") || key.ends_with(".calibration") ||
         key.ends_with(".input");
}

void warn_without_effect(const ParamSet& params, const Experiment& experiment) {
  for (const ParamBase* p : params.all()) {
    const int rank = experiment.rank(p->key());
    if (rank < 0 || experiment.origin(p->key()).preset()) continue;
    for (const auto& effect : p->effects()) {
      if (effect.effective()) continue;
      std::string because;
      bool later = false;
      for (const ParamBase* decider : effect.deciders) {
        // List only deciders that were set: the defaults would only make the line longer.
        if (decider == effect.deciders.front() || experiment.rank(decider->key()) >= 0)
          because += (because.empty() ? "" : ", ") + decider->key() + " = " + decider->text();
        later |= experiment.rank(decider->key()) > rank;
      }
      if (!later)
        DiagnosticsRef::current().configuration(fmt::format("'{}' is set ({}) but has no effect with {}: it needs {}",
                                                            p->key(), experiment.origin(p->key()).text(), because,
                                                            effect.condition));
      break;
    }
  }
}

void Experiment::set(std::string_view key, std::string value, const fs::path& folder) {
  const ParamBase* param = params_.find(key);
  if (!param) {
    const std::string members = group_hint(params_, key);
    if (!members.empty())
      throw UserError(fmt::format("'{}' is a group of keys, not a key; it has {}", key, members));
  } else if (is_path_key(*param) && !value.empty() && fs::path(value).is_relative()) {
    value = (folder / value).lexically_normal().string();
  }
  params_.set(key, value);
}

namespace {

/// The files of the shipped experiments by name.
std::map<std::string, fs::path> shipped_files() {
  std::map<std::string, fs::path> out;
  const fs::path above = own_program().parent_path().parent_path().parent_path();
  for (const char* place : {"share/fovea/scripts/experiments", "scripts/experiments"}) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(above / place, error))
      if (entry.path().extension() == ".yaml") out.emplace(entry.path().stem().string(), entry.path());
    if (!out.empty()) break;
  }
  return out;
}

/// The file that is meant by a name.
fs::path experiment_file(const fs::path& name) {
  std::error_code error;
  const bool taken = fs::exists(name, error) && !fs::is_directory(name, error);
  if (taken || name.has_parent_path() || name.has_extension()) return name;
  const std::map<std::string, fs::path> shipped = shipped_files();
  if (const auto found = shipped.find(name.string()); found != shipped.end()) return found->second;
  std::string names;
  for (const auto& [known, file] : shipped) names += (names.empty() ? "" : ", ") + known;
  throw UserError(fmt::format("'{}' is neither a file nor a shipped experiment; allowed: a file name{}{}",
                              one_line(name.string()), names.empty() ? "" : ", ", names));
}

}  // namespace

std::vector<std::string> shipped_experiments() {
  std::vector<std::string> out;
  for (const auto& [name, file] : shipped_files()) out.push_back(name);
  return out;
}

void Experiment::load(const fs::path& name) {
  std::vector<fs::path> chain;
  const fs::path file = experiment_file(name);
  load(file, chain);
  name_ = file.stem().string();
}

void Experiment::load(const fs::path& file, std::vector<fs::path>& chain) {
  std::error_code unresolved;
  fs::path real = fs::weakly_canonical(file, unresolved);
  if (unresolved) real = file;
  for (const auto& outer : chain)
    if (outer == real)
      throw UserError(fmt::format("'{}' includes itself", one_line(file.string())));
  if (chain.size() >= kMaxIncludeDepth)
    throw UserError(fmt::format("'{}' is included more than {} levels deep",
                                one_line(file.string()), kMaxIncludeDepth));
  // Otherwise a file that includes another ten times, eight levels deep, would be read for ever.
  if (files_.size() >= kMaxFiles)
    throw UserError(
        fmt::format("'{}': more than {} files included", one_line(file.string()), kMaxFiles));
  chain.push_back(real);
  const std::vector<Entry> entries = parse(file);
  files_.push_back(file.string());
  for (const auto& e : entries) {
    if (e.key != kInclude) continue;
    const std::vector<std::string> names =
        e.items.empty() ? std::vector<std::string>{e.value} : e.items;
    for (const auto& name : names) {
      const fs::path other = (file.parent_path() / name).lexically_normal();
      std::error_code error;
      if (!fs::is_regular_file(other, error))
        throw UserError(fmt::format("{}: include: no such file '{}'", at(file, e.line),
                                    one_line(other.string())));
      load(other, chain);
    }
  }
  const int rank = next_rank_++;  // above the rank of the included files
  for (const auto& e : entries) {
    if (e.key == kInclude) continue;
    try {
      set(e.key, e.value, file.parent_path());
    } catch (const UserError& error) {
      throw UserError(at(file, e.line) + ": " + one_line(error.what()));
    }
    origins_[e.key] = {ValueOrigin::Kind::kFile, file.string(), e.line};
    ranks_[e.key] = rank;
  }
  chain.pop_back();
}

void Experiment::preset(std::string_view key, std::string_view value, const std::string& file) {
  try {
    set(key, std::string(value), "");
  } catch (const UserError& error) {
    throw UserError(fmt::format("'{}': {}", one_line(file), one_line(error.what())));
  }
  origins_[std::string(key)] = {ValueOrigin::Kind::kFile, file, 0};
  ranks_[std::string(key)] = 0;
}

void Experiment::take_over(const std::string& key, const std::string& from) {
  params_.set(key, params_.find(from)->text());
  origins_[key] = {ValueOrigin::Kind::kOtherKey, from, 0};
  ranks_[key] = 0;
}

void Experiment::override_with(std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0)
    throw UserError(fmt::format("-s '{}': write it as key=value", one_line(assignment)));
  const std::string key(assignment.substr(0, equals));
  try {
    set(key, std::string(assignment.substr(equals + 1)), "");
  } catch (const UserError& error) {
    throw UserError(fmt::format("-s {}: {}", one_line(assignment, 80), one_line(error.what())));
  }
  origins_[key] = {ValueOrigin::Kind::kCommandLine, "", 0};
  ranks_[key] = std::numeric_limits<int>::max();
}

int Experiment::rank(std::string_view key) const {
  const auto found = ranks_.find(key);
  return found == ranks_.end() ? -1 : found->second;
}

const ValueOrigin& Experiment::origin(std::string_view key) const {
  static const ValueOrigin kUnset;
  const auto found = origins_.find(key);
  return found == origins_.end() ? kUnset : found->second;
}

}  // namespace fovea::app
