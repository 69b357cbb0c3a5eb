// Where the program itself lies: what belongs to it is found from there.
#pragma once
#include <filesystem>
#include <system_error>

namespace fovea::app {

/// The file of the running program; empty if the host does not tell it.
inline std::filesystem::path own_program() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error);
}

}  // namespace fovea::app
