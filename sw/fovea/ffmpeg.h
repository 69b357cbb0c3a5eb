// Decodes stills and videos other than PNG with the `ffmpeg` program in a child process.
#pragma once
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/common/units.h"
#include "sw/fovea/rgb_image.h"

namespace fovea::app {

/// Thrown if a signal requests a stop while footage is decoded.
struct Stopped : std::runtime_error {
  explicit Stopped(const std::string& what = "stopped before the simulation began") : std::runtime_error(what) {}
};

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
/// Asks `ffprobe`, which is part of ffmpeg. What it does not report stays unknown.
FilmInfo film_info(const std::filesystem::path& file, const std::string& program = "ffprobe");

/// Loads a still: a PNG (recognised by its signature) directly, anything else with ffmpeg.
/// @throws UserError that names the file
/// @throws Stopped
RgbImage load_still(const std::filesystem::path& file, const std::atomic<bool>* stop = nullptr);

/// A child process whose standard streams are sockets or pipes. It is started without a shell, in
/// its own process group, so that Ctrl-C in the terminal does not truncate its output.
class ChildProcess {
 public:
  enum class Stream { kInput, kOutput };  ///< the stream that `data` is connected to
  /// @param purpose for the message of the error @param stdin_fd with Stream::kOutput, a descriptor
  /// that becomes the standard input; -1: none
  /// @throws UserError if the program cannot be started
  ChildProcess(const std::vector<std::string>& command, Stream data, const std::string& purpose,
               int stdin_fd = -1);
  /// Kills the child if it is still running.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Reads more of the child's output, and collects its messages. Returns false at the end of the
  /// output. @throws Stopped if `stop` is set meanwhile
  bool read_some(std::string& buffer, const std::atomic<bool>* stop);
  /// Sends all of `bytes`. Returns false if the child has closed its input.
  bool write_all(const std::uint8_t* bytes, std::size_t size);
  /// Closes the data stream, waits, and returns the exit status (128 + signal if killed). @throws
  /// Stopped if `stop` is set meanwhile
  int finish(const std::atomic<bool>* stop = nullptr);
  void kill();
  /// The first kilobytes of the child's standard error.
  const std::string& messages() const { return messages_; }

 private:
  void read_messages();
  pid_t pid_ = -1;
  int data_ = -1, error_ = -1;
  std::string messages_;
};

/// Encodes frames into an MP4 file (H.264, 4:2:0) with ffmpeg.
class Mp4Writer {
 public:
  /// @throws UserError if ffmpeg is not installed
  Mp4Writer(std::filesystem::path file, unsigned width, unsigned height, Frequency rate, PixelShape pixel = {},
            const std::string& program = "ffmpeg");
  /// @throws UserError with ffmpeg's message if it stopped reading
  void write(const RgbImage& image);
  /// @throws UserError if the file could not be completed
  void close();

 private:
  [[noreturn]] void fail(int status);
  std::filesystem::path file_;
  unsigned width_, height_;
  ChildProcess child_;
};

}  // namespace fovea::app
