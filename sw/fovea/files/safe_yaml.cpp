#include "sw/fovea/files/safe_yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <sstream>
#include <vector>

#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

/// Checks the rules on the parser's events, where an alias is not yet expanded.
class Rules : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) fail(mark, "only one YAML document is allowed");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { leaf(mark, anchor, ""); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse_alias(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string& value) override {
    leaf(mark, anchor, value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(mark, anchor, false);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(mark, anchor, true);
  }
  void OnMapEnd() override { end(); }

 private:
  struct Level {
    bool map = false, expect_key = true;
    std::map<std::string, int> keys = {};  // with their lines
  };
  [[noreturn]] static void fail(const YAML::Mark& mark, const std::string& what) {
    throw YamlFault(mark.line + 1, what);
  }
  [[noreturn]] static void refuse_alias(const YAML::Mark& mark) {
    fail(mark, "YAML anchors and aliases (&name, *name) are not allowed; write the value out");
  }
  /// A key or a value begins.
  void item(const YAML::Mark& mark, YAML::anchor_t anchor, const std::string* key) {
    if (anchor) refuse_alias(mark);
    if (levels_.empty() || !levels_.back().map) return;
    Level& level = levels_.back();
    if (level.expect_key) {
      if (!key) fail(mark, "not valid YAML here: a key must be a plain word");
      const auto [first, added] = level.keys.emplace(*key, mark.line + 1);
      if (!added)
        fail(mark, fmt::format("key '{}' is written twice (first in line {})", one_line(*key, 60), first->second));
    }
    level.expect_key = !level.expect_key;
  }
  void leaf(const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& value) { item(mark, anchor, &value); }
  void begin(const YAML::Mark& mark, YAML::anchor_t anchor, bool map) {
    item(mark, anchor, nullptr);
    if (levels_.size() >= kMaxYamlDepth)
      fail(mark, fmt::format("nested deeper than the {} levels allowed", kMaxYamlDepth));
    levels_.push_back({map});
  }
  void end() { levels_.pop_back(); }

  unsigned documents_ = 0;
  std::vector<Level> levels_;
};

void parse(const std::string& text, YAML::EventHandler& handler) {
  std::istringstream in(text);
  try {
    YAML::Parser parser(in);
    while (parser.HandleNextDocument(handler)) {
    }
  } catch (const YAML::Exception& e) {
    throw YamlFault(e.mark.is_null() ? 1 : e.mark.line + 1, "not valid YAML: " + one_line(e.msg));
  }
}

}  // namespace

void each_yaml_event(const std::string& text, YAML::EventHandler& handler) {
  Rules rules;
  parse(text, rules);
  parse(text, handler);
}

YAML::Node load_yaml(const std::string& text) {
  Rules rules;
  parse(text, rules);
  return YAML::Load(text);
}

}  // namespace fovea::app
