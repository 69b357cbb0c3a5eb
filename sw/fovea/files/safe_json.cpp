#include "sw/fovea/files/safe_json.h"

#include <nlohmann/json.hpp>

#include "sw/fovea/files/checked_file.h"

namespace fovea::app {
namespace {

using nlohmann::json;

/// Of JSON; of any other text it does not matter.
bool too_deep(std::string_view text) {
  unsigned depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    else if (quoted) i += c == '\\';
    else if ((c == '[' || c == '{') && ++depth > kMaxJsonDepth) return true;
    else if ((c == ']' || c == '}') && depth > 0) --depth;
  }
  return false;
}

}  // namespace

json parse_json(std::string_view text) {
  return too_deep(text) ? json(json::value_t::discarded) : json::parse(text, nullptr, false);
}

json read_json(const std::filesystem::path& file) { return parse_json(read_file(file, kMaxJsonBytes)); }

const json& json_member(const json& value, std::string_view name) {
  static const json kNull;
  if (!value.is_object()) return kNull;
  const auto found = value.find(name);
  return found == value.end() ? kNull : *found;
}

std::string json_text(const json& value, std::string_view name) {
  const json& member = json_member(value, name);
  return member.is_string() ? member.get<std::string>() : std::string();
}

json json_number(double value, bool whole) {
  // The limits are those that a conversion defines: a larger double has no such integer.
  if (whole && value >= 0 && value < 0x1p64) return static_cast<std::uint64_t>(value);
  if (whole && value < 0 && value >= -0x1p63) return static_cast<std::int64_t>(value);
  return value;
}

}  // namespace fovea::app
