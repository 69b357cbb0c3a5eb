// Decodes stills and videos other than PNG with the `ffmpeg` program in a child process.
#pragma once
#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "model/common/units.h"
#include "sw/fovea/files/child_process.h"
#include "sw/fovea/files/rgb_image.h"

namespace fovea::app {

struct DecodeOptions {
  unsigned width = 0, height = 0;  ///< size to scale to; 0: the size of the file
  unsigned most_width = 0, most_height = 0;  ///< larger pictures are scaled down to this size; 0:
                                             ///< no limit
  std::size_t max_frames = 1;      ///< the rest of the file is not read
  std::string program = "ffmpeg";  ///< searched in PATH
  const std::atomic<bool>* stop = nullptr;  ///< set by a signal: ffmpeg is terminated; nullptr:
                                            ///< never
};

/// Decodes the first frames of a video or picture. Only this file is read: its contents select
/// among the formats that consist of a single file. Playlists, lists of files and numbered series,
/// which name other files of the host, are refused, and so are text files (ffmpeg would draw the
/// text) and all protocols. @throws UserError that names the file: ffmpeg not found, file missing,
/// not decodable, truncated, no frames @throws Stopped
std::vector<RgbImage> decode_frames(const std::filesystem::path& file,
                                    const DecodeOptions& options);

/// What a video file says about itself.
struct FilmInfo {
  Frequency rate;           ///< frames per second; stopped: unknown
  double pixel_aspect = 1;  ///< width / height of a displayed pixel
  unsigned width = 0, height = 0;  ///< size in the file, before it is turned and scaled; 0: unknown
  enum class Fields { kNone, kTopFirst, kBottomFirst };
  Fields fields = Fields::kNone;  ///< of interlaced material the field that is earlier
  std::string transfer = {};      ///< ffmpeg's name of the transfer function; empty or "unknown": unknown
};
/// Asks `ffprobe`, which is part of ffmpeg. What it does not report stays unknown. @throws UserError if it does not
/// answer in time @throws Stopped
FilmInfo film_info(const std::filesystem::path& file, const Patience& patience = {},
                   const std::string& program = "ffprobe");

/// Loads a still: a PNG (recognised by its signature) directly, anything else with ffmpeg.
/// @throws UserError that names the file
/// @throws Stopped
RgbImage load_still(const std::filesystem::path& file, const std::atomic<bool>* stop = nullptr);

/// Encodes frames into an MP4 file (H.264, 4:2:0) with ffmpeg.
class Mp4Writer {
 public:
  /// @throws UserError if ffmpeg is not installed
  Mp4Writer(std::filesystem::path file, unsigned width, unsigned height, Frequency rate, PixelShape pixel = {},
            const Patience& patience = {}, const std::string& program = "ffmpeg");
  /// @throws UserError with ffmpeg's message if it stopped reading @throws Stopped
  void write(const RgbImage& image);
  /// @throws UserError if the file could not be completed @throws Stopped
  void close();

 private:
  [[noreturn]] void fail(int status);
  std::filesystem::path file_;
  unsigned width_, height_;
  ChildProcess child_;
};

}  // namespace fovea::app
