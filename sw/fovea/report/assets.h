// Style and script of the page, from the folder page/; the build makes assets.cpp.
#pragma once
#include <string_view>

namespace fovea::report {

extern const std::string_view kStyle;
extern const std::string_view kScript;

}  // namespace fovea::report
