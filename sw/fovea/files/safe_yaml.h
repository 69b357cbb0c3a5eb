// The rules that every YAML file of a user obeys, and the way to read one. All readers of YAML begin here.
#pragma once
#include <stdexcept>
#include <string>

namespace YAML {
class EventHandler;
class Node;
}  // namespace YAML

namespace fovea::app {

/// What is wrong with a text of YAML. The caller knows the file, and makes a UserError of it.
struct YamlFault : std::runtime_error {
  YamlFault(int at, const std::string& what) : std::runtime_error(what), line(at) {}
  int line;  ///< from 1
};

/// Reads one document without anchors and aliases, which could make a short file endless; lists and maps may be nested
/// kMaxYamlDepth deep, and no map has a key twice. An empty text is a null.
/// @throws YamlFault with one line
YAML::Node load_yaml(const std::string& text);
/// The same rules, for a reader of events. They are checked before the handler sees the first event.
void each_yaml_event(const std::string& text, YAML::EventHandler& handler);

inline constexpr unsigned kMaxYamlDepth = 16;

}  // namespace fovea::app
