// What a boot loader and the person at the board do before the start: program, footage, switches,
// parameter page.
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

/// firmware.elf, or the program built with Fovea, which lies beside the `fovea` program.
std::filesystem::path program_file(const board::BoardParams& params);
/// A target program that was built with Fovea; they lie beside the `fovea` program.
std::filesystem::path built_program(const std::string& name);
/// Where a program's segments may lie.
std::vector<MemoryRegion> memory_regions(const board::BoardParams& params);
/// Decodes camera.file; nothing for a chart. @throws UserError naming the file
/// @throws Stopped when `stop` is set while ffmpeg decodes
std::vector<RgbImage> load_footage(const board::BoardParams& params,
                                   const std::atomic<bool>* stop = nullptr);
/// What the camera changes in the footage, a sentence each: its shape, its rate, its length.
std::vector<std::string> footage_notes(const board::BoardParams& params,
                                       const std::vector<RgbImage>& frames, const FilmInfo& info);
/// Sets what follows from other keys and was not set itself (the decoder's standard).
void complete_params(board::BoardParams& params);
/// The bytes of the parameter page (sw/lens/README.md).
std::vector<std::uint8_t> parameter_page(const board::BoardParams& params,
                                         const video::StampedSource& source);

}  // namespace fovea::app
