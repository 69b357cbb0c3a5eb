// What a test program is told by its environment, so that one program serves several cases.
#pragma once
#include <cstdlib>
#include <string>

namespace fovea::video {

/// The environment's value of `name`, or `otherwise`.
inline std::string setting(const char* name, const char* otherwise) {
  const char* value = std::getenv(name);
  return value ? value : otherwise;
}
inline unsigned setting(const char* name, unsigned otherwise) {
  return static_cast<unsigned>(std::stoul(setting(name, std::to_string(otherwise).c_str())));
}

}  // namespace fovea::video
