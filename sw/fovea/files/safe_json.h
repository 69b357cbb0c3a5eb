// The way to read JSON that another program, or a person, may have written. All readers of JSON begin here.
#pragma once
#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace fovea::app {

/// Lists and objects may be nested this deep: a value is copied, written and destroyed by recursion.
inline constexpr unsigned kMaxJsonDepth = 32;
/// A hundred times what a long run writes.
inline constexpr std::size_t kMaxJsonBytes = 16u << 20;

/// A discarded value if the text is no JSON or nested too deep.
nlohmann::json parse_json(std::string_view text);
/// The same of a file of at most kMaxJsonBytes. @throws UserError if it cannot be read
nlohmann::json read_json(const std::filesystem::path& file);
/// The member `name` of `value` if that is an object that has it; otherwise a null.
const nlohmann::json& json_member(const nlohmann::json& value, std::string_view name);
/// The same as text; "" if it is none.
std::string json_text(const nlohmann::json& value, std::string_view name);
/// A figure; a whole one without a fraction as far as 64 bits hold it.
nlohmann::json json_number(double value, bool whole);

}  // namespace fovea::app
