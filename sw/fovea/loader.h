// Prepares a board as a boot loader and a user would: program and footage.
#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "model/board/board_params.h"
#include "model/video/scene/sources.h"
#include "sw/fovea/elf_image.h"
#include "sw/fovea/ffmpeg.h"
#include "sw/fovea/rgb_image.h"

namespace fovea::app {

/// The file of firmware.elf or, by default, the program built with Fovea in the folder of `fovea`.
std::filesystem::path program_file(const board::BoardParams& params);
/// A target program that was built with Fovea; these are in the folder of the `fovea` program.
std::filesystem::path built_program(const std::string& name);
/// The memories to which a program's segments may be loaded.
std::vector<MemoryRegion> memory_regions(const board::BoardParams& params);
/// Decodes camera.file; empty for a chart. @throws UserError that names the file
/// @throws Stopped if `stop` is set while ffmpeg decodes
std::vector<RgbImage> load_footage(const board::BoardParams& params,
                                   const std::atomic<bool>* stop = nullptr);
/// How the camera changes the footage (shape, rate, length), one sentence for each.
std::vector<std::string> footage_notes(const board::BoardParams& params,
                                       const std::vector<RgbImage>& frames, const FilmInfo& info);
/// Sets keys that follow from others, unless they were set (the decoder's standard).
void complete_params(board::BoardParams& params);

}  // namespace fovea::app
