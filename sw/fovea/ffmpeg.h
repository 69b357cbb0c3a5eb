// Stills and films that are no PNG, through the `ffmpeg` program as a child process.
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

/// A signal asked to stop while footage was being decoded.
struct Stopped : std::runtime_error {
  Stopped() : std::runtime_error("stopped before the simulation began") {}
};

struct DecodeOptions {
  unsigned width = 0, height = 0;  ///< scaled to this size; 0: as the file has it
  unsigned most_width = 0, most_height = 0;  ///< larger ones are scaled down to fit; 0: none are
  std::size_t max_frames = 1;      ///< the rest of the file is not read
  std::string program = "ffmpeg";  ///< looked up in PATH
  const std::atomic<bool>* stop = nullptr;  ///< set by a signal: ffmpeg is ended; nullptr: never
};

/// Decodes the first frames of a film or picture that ffmpeg reads. Nothing but this file is read:
/// its contents choose among the formats of one picture or film. Playlists, lists of files and
/// numbered series name other files of this machine, and text becomes a picture of itself; these
/// are refused, as is every protocol.
/// @throws UserError naming the file: ffmpeg not found, missing, not decodable, cut short, no
/// frames
/// @throws Stopped
std::vector<RgbImage> decode_frames(const std::filesystem::path& file,
                                    const DecodeOptions& options);

/// What a film says about itself.
struct FilmInfo {
  Frequency rate;           ///< frames per second; stopped: not known
  double pixel_aspect = 1;  ///< width / height of a pixel as it is to be shown
  unsigned width = 0, height = 0;  ///< of the file, before any scaling; 0: not known
};
/// Asks `ffprobe`, which comes with ffmpeg; what it cannot tell stays unknown.
FilmInfo film_info(const std::filesystem::path& file, const std::string& program = "ffprobe");

/// A still: PNG natively (by its signature, whatever its name), anything else through ffmpeg.
/// @throws UserError naming the file
/// @throws Stopped
RgbImage load_still(const std::filesystem::path& file, const std::atomic<bool>* stop = nullptr);

/// A child process with its standard streams on sockets or pipes; started without a shell, in a
/// process group of its own so that the terminal's Ctrl-C does not cut its output short.
class ChildProcess {
 public:
  enum class Stream { kInput, kOutput };  ///< which of the child's streams `data` is
  /// `stdin_fd`: a descriptor that becomes the child's standard input, with Stream::kOutput; -1: none
  /// @throws UserError if the program cannot be started (`purpose` says what for)
  ChildProcess(const std::vector<std::string>& command, Stream data, const std::string& purpose,
               int stdin_fd = -1);
  /// Kills the child if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Reads more of the child's output; false at its end. Collects its messages on the way.
  /// @throws Stopped when `stop` is set meanwhile
  bool read_some(std::string& buffer, const std::atomic<bool>* stop);
  /// Sends all of `bytes`; false if the child has closed its input.
  bool write_all(const std::uint8_t* bytes, std::size_t size);
  /// Closes the data stream, waits, and returns the exit status (128 + signal if killed).
  /// @throws Stopped when `stop` is set meanwhile
  int finish(const std::atomic<bool>* stop = nullptr);
  void kill();
  /// The first kilobytes that the child wrote to its standard error.
  const std::string& messages() const { return messages_; }

 private:
  void read_messages();
  pid_t pid_ = -1;
  int data_ = -1, error_ = -1;
  std::string messages_;
};

/// Encodes frames to an MP4 file (H.264, 4:2:0) through ffmpeg.
class Mp4Writer {
 public:
  /// @throws UserError if ffmpeg is missing
  Mp4Writer(std::filesystem::path file, unsigned width, unsigned height, Frequency rate,
            const std::string& program = "ffmpeg");
  /// @throws UserError with ffmpeg's words if it stopped reading
  void write(const RgbImage& image);
  /// @throws UserError if the file is not complete
  void close();

 private:
  [[noreturn]] void fail(int status);
  std::filesystem::path file_;
  unsigned width_, height_;
  ChildProcess child_;
};

}  // namespace fovea::app
