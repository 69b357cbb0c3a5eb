// Prepares a board as a boot loader and a user would: program and footage.
#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "model/board/board_params.h"
#include "model/video/scene/sources.h"
#include "sw/fovea/files/ffmpeg.h"
#include "sw/fovea/files/rgb_image.h"
#include "sw/fovea/program/elf_image.h"

namespace fovea::app {

/// The file of firmware.elf or, by default, the program built with Fovea in the folder of `fovea`: that
/// for several cameras if there are any.
std::filesystem::path program_file(const board::BoardParams& params);
/// A target program that was built with Fovea; these are in the folder of the `fovea` program.
std::filesystem::path built_program(const std::string& name);
/// The memories to which a program's segments may be loaded.
std::vector<MemoryRegion> memory_regions(const board::BoardParams& params);
/// Decodes the camera's file; empty for a chart. @throws UserError that names the file
/// @throws Stopped if `stop` is set while ffmpeg decodes
std::vector<RgbImage> load_footage(const board::BoardParams& params,
                                   const video::SceneParams& camera,
                                   const std::atomic<bool>* stop = nullptr);
/// The same of all cameras' keys.
inline std::vector<RgbImage> load_footage(const board::BoardParams& params,
                                          const std::atomic<bool>* stop = nullptr) {
  return load_footage(params, params.camera, stop);
}
/// How the camera changes the footage (shape, rate, length), one sentence for each.
std::vector<std::string> footage_notes(const board::BoardParams& params,
                                       const video::SceneParams& camera,
                                       const std::vector<RgbImage>& frames, const FilmInfo& info);
inline std::vector<std::string> footage_notes(const board::BoardParams& params,
                                              const std::vector<RgbImage>& frames,
                                              const FilmInfo& info) {
  return footage_notes(params, params.camera, frames, info);
}
/// What a camera sees. `notes` receives footage_notes(), if there is one.
std::unique_ptr<video::StampedSource> camera_source(const board::BoardParams& params,
                                                    unsigned camera,
                                                    const std::atomic<bool>* stop = nullptr,
                                                    std::vector<std::string>* notes = nullptr);
/// @throws UserError if ddr.part is mobile DDR, for which Fovea's programs, such as `program`, have no times
void refuse_mobile_memory(const mem::DdrParams& ddr, std::string_view program);
/// Sets keys that follow from others, unless they were set (the decoder's standard).
void complete_params(board::BoardParams& params);

}  // namespace fovea::app
