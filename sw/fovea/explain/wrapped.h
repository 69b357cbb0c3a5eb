// Text in columns.
#pragma once
#include <cstddef>
#include <string>

namespace fovea::app {

/// Breaks `text` into lines of at most `width` columns, all but the first indented by `indent`.
/// Line feeds in `text` are kept.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width = 80);

}  // namespace fovea::app
