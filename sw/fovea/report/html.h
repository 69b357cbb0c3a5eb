// Text for a page of HTML: everything that comes from a file goes through these.
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

namespace fovea::report {

/// Text between tags or in a quoted attribute. Control characters become visible escapes.
std::string escaped(std::string_view text);

/// JSON for a <script type="application/json">: no character of it can end the element.
std::string script_json(const nlohmann::ordered_json& value);

std::string base64(std::span<const std::uint8_t> bytes);

/// The digest of a script as a content security policy names it: "sha256-...".
std::string script_digest(std::string_view script);

}  // namespace fovea::report
