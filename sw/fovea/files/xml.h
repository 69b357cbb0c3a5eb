// Text for XML.
#pragma once
#include <string>
#include <string_view>

namespace fovea::app {

/// `text` for an element or an attribute in double quotes. Characters that XML 1.0 does not allow
/// become question marks.
std::string xml_text(std::string_view text);

}  // namespace fovea::app
