// Pictures that tests make.
#pragma once
#include <filesystem>
#include <fstream>

#include "sw/fovea/files/png.h"

namespace fovea::test {

inline void write_png(const std::filesystem::path& file, const app::RgbImage& image, int level = 1) {
  const std::vector<std::uint8_t> bytes = app::encode_png(image, level);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace fovea::test
